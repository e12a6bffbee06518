/// Every kind of check passes when it should and, in a twin beside it, fails when it should.
#include "apps/common/run/application.hpp"
#include "tests/support/files.hpp"
#include "tests/support/ranks.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/text.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

namespace mixbeam {
namespace {

const std::string kSource = "invented for this test";
const double kInfinity = std::numeric_limits<double>::infinity();

std::string printed(const Summary& summary, bool all = false) {
  std::stringstream stream;
  summary.print_checks(stream, all);
  return stream.str();
}

TEST(Summary, AbsoluteAndItsTwin) {
  Summary summary;
  EXPECT_TRUE(summary.check_absolute("x", 1.0 + 0.9e-6, 1.0, 1e-6, kSource));
  EXPECT_TRUE(summary.check_absolute("x", 0.0, 0.0, 0.0, kSource));
  EXPECT_TRUE(summary.all_passed());
  EXPECT_FALSE(summary.check_absolute("x", 1.0 - 1.1e-6, 1.0, 1e-6, kSource));
  EXPECT_FALSE(summary.all_passed());
}

TEST(Summary, RelativeAndItsTwin) {
  Summary summary;
  EXPECT_TRUE(summary.check_relative("x", -1000.0009, -1000.0, 1e-6, kSource));
  EXPECT_FALSE(summary.check_relative("x", -1000.0011, -1000.0, 1e-6, kSource));
  EXPECT_FALSE(summary.check_relative("x", 1e-300, 0.0, 1e-6, kSource));  // nothing is relative to zero
}

TEST(Summary, UpperBoundAndItsTwin) {
  Summary summary;
  EXPECT_TRUE(summary.check_upper_bound("iterations", 11, 11, kSource));
  EXPECT_FALSE(summary.check_upper_bound("iterations", 12, 11, kSource));
  EXPECT_FALSE(summary.check_upper_bound("error", -kInfinity, 11, kSource));
}

TEST(Summary, PrintedDigitsAndTheirTwin) {
  Summary summary;
  EXPECT_TRUE(summary.check_printed_digits("u", -23.64511, "-23.6450", kSource));
  EXPECT_FALSE(summary.check_printed_digits("u", -23.64516, "-23.6450", kSource));
}

TEST(Summary, NothingThatIsNotFinitePasses) {
  Summary summary;
  for (const double value : {std::nan(""), kInfinity, -kInfinity}) {
    EXPECT_FALSE(summary.check_absolute("x", value, 1.0, 1e300, kSource));
    EXPECT_FALSE(summary.check_relative("x", value, 1.0, 1e300, kSource));
    EXPECT_FALSE(summary.check_upper_bound("x", value, 1.0, kSource));
    EXPECT_FALSE(summary.check_printed_digits("x", value, "1.0", kSource));
  }
}

TEST(Summary, ChecksThatCheckNothingAreRefused) {
  Summary summary;
  EXPECT_THROW(summary.check_absolute("x", 1.0, 1.0, 1e-6, ""), std::invalid_argument);
  EXPECT_THROW(summary.check_absolute("x", 1.0, kInfinity, 1e-6, kSource), std::invalid_argument);
  EXPECT_THROW(summary.check_absolute("x", 1.0, 1.0, kInfinity, kSource), std::invalid_argument);
  EXPECT_THROW(summary.check_absolute("x", 1.0, 1.0, -1.0, kSource), std::invalid_argument);
  EXPECT_THROW(summary.check_printed_digits("x", 1.0, "one", kSource), std::invalid_argument);
  EXPECT_TRUE(summary.checks().empty());
}

TEST(Summary, ComparisonsHaveNames) {
  EXPECT_EQ(name_of(Comparison::upper_bound), "upper bound");
  EXPECT_EQ(name_of(Comparison::printed_digits), "printed digits");
  EXPECT_EQ(name_of(Comparison::word), "word");
}

TEST(Summary, PrintsFailuresAndCounts) {
  Summary summary;
  expect_in(printed(summary, true), {"Nothing was checked"});
  summary.check_printed_digits("u3", 54.09503, "54.0950", "Table 1");
  summary.check_upper_bound("iterations", 12, 11, "issue");
  EXPECT_EQ(printed(summary, true),
            "  pass  u3 = 54.0950, reference 54.0950 (printed digits, 1 in the last), from Table 1\n"
            "  FAIL  iterations = 12, at most 11, from issue\n"
            "1 of 2 checks passed, 1 FAILED.\n");
  EXPECT_EQ(printed(summary).find("u3"), std::string::npos);
}

TEST(Summary, ManyFailuresDoNotScrollTheTerminal) {
  Summary summary;
  for (int i = 0; i < 1000; ++i) summary.check_upper_bound("case " + std::to_string(i), 12, 11, "limit");
  const std::string text = printed(summary);
  EXPECT_LT(std::count(text.begin(), text.end(), '\n'), 30);
  expect_in(text, {"... and 976 more that FAIL", "0 of 1000 checks passed, 1000 FAILED"});
  expect_in(printed(summary, true), {"case 999"});
}

TEST(Summary, WordsAreComparedAsTheyStand) {
  Summary summary;
  EXPECT_TRUE(summary.check_word("end", "false", "false", kSource));
  EXPECT_FALSE(summary.check_word("end", "neutral", "true", kSource));
  EXPECT_EQ(printed(summary).find("  FAIL  end = neutral, reference true, from "), 0u) << printed(summary);
}

TEST(Summary, WhatNeverGotAValueFails) {
  Summary summary;
  summary.fail("limit point", "0.3386", kSource, "critical point 1 did not come");
  EXPECT_FALSE(summary.all_passed());
  expect_in(printed(summary),
            {"limit point: critical point 1 did not come, reference 0.3386", "0 of 1 checks passed, 1 FAILED.\n"});
}

TEST(Summary, TheLeastCertainEndSpeaksForAll) {
  Summary summary;
  EXPECT_EQ(summary.stable(), "");
  summary.ends = {{{"true"}, "a", 1.0}, {{"neutral"}, "b", 1.0}};
  EXPECT_EQ(summary.stable(), "neutral");
  summary.ends.push_back({{"unknown"}, "c", 1.0});
  EXPECT_EQ(summary.stable(), "unknown");
  summary.stable_cases["false"] = 0;
  EXPECT_EQ(summary.stable(), "unknown");
  summary.stable_cases["false"] = 1;
  EXPECT_EQ(summary.stable(), "false");
}

TEST(Summary, WarningsAreCounted) {
  Summary summary;
  summary.check_upper_bound("iterations", 10, 11, "issue");
  summary.warnings = {"the last state is unstable"};
  EXPECT_EQ(printed(summary), "1 of 1 checks passed, 1 warning.\n");
}

TEST(Summary, JsonHoldsEverything) {
  const TemporaryFolder folder;
  const fs::path path = folder / "summary.json";
  Summary summary;
  summary.program = "rollup";
  summary.load_steps = 2;
  summary.newton_iterations = 6;
  summary.seconds = {{"solve", 0.25}, {"read", std::nan("")}};
  summary.estimated_errors = {{"first", "", {{"strain energy", -2e-6, 1e-6}}}, {"second", "too coarse", {}}};
  summary.ends = {{{"false", "true", 2}, "first", 0.5}};
  summary.check_relative("x", 1.0 / 3.0, 0.3333, 1e-3, kSource);
  summary.check_absolute("broken \xff name", std::nan(""), 1.0, 1e-3, kSource);
  summary.write_json(path);

  const auto json = nlohmann::json::parse(std::ifstream(path));
  EXPECT_EQ(json["program"], "rollup");
  EXPECT_EQ(json["newton_iterations"], 6);
  EXPECT_EQ(json["seconds"]["solve"], 0.25);
  EXPECT_EQ(json["seconds"]["read"], "nan");
  EXPECT_EQ(json["estimated_errors"][0]["quantities"][0]["error"], -2e-6);
  EXPECT_EQ(json["estimated_errors"][0].count("not_estimated"), 0u);
  EXPECT_EQ(json["estimated_errors"][1]["not_estimated"], "too coarse");
  EXPECT_EQ(json["checks"][0]["value"].get<double>(), 1.0 / 3.0);
  EXPECT_EQ(json["checks"][0]["comparison"], "relative");
  EXPECT_EQ(json["checks"][0]["pass"], true);
  EXPECT_EQ(json["checks"][1]["value"], "nan");
  EXPECT_EQ(json["checks"][1]["comparison"], "absolute");
  EXPECT_EQ(json["checks"][1]["pass"], false);
  EXPECT_EQ(json["all_passed"], false);
  EXPECT_EQ(json["stable"], "false");
  EXPECT_EQ(json["ends"][0]["run"], "first");
  EXPECT_EQ(json["ends"][0]["stable_held"], "true");
  EXPECT_EQ(json["ends"][0]["negative_eigenvalues"], 2);

  EXPECT_THROW(summary.write_json(folder.path() / "no" / "summary.json"), std::runtime_error);
  EXPECT_THROW(summary.write_json(folder.path()), std::runtime_error);
}

std::string json_of(const Summary& summary) {
  const TemporaryFolder folder;
  summary.write_json(folder / "summary.json");
  return text_of(folder / "summary.json");
}

TEST(Summary, WhatIsPackedComesBackToTheBit) {
  Summary summary;
  summary.load_steps = 2;
  summary.newton_iterations = 6;
  summary.seconds = {{"solve", 0.1}, {"read", std::nan("")}};
  summary.warnings = {"broken \xff name"};
  summary.ends = {{{"false", "true", 2, false}, "first", 1.0 / 3.0, {{0.1, 0.2, 0.3, 0.4, 0.5, "tip", 7}}}};
  summary.quantities = {{"first", "sag", -0.0, kInfinity, 0.7, 3, "rod", 0.1, -1}, {"first", "M", std::nan("")}};
  summary.estimated_errors = {{"first", "", {{"strain energy", -2e-6, 1e-6}}}, {"second", "too coarse", {}}};
  summary.chosen_meshes = {{"first", 1e-6, 1e-7, "reached", {{"rod", 1, 3, 8}}, {{8, true, 2, 6, 0.1, 1e-7, "no"}}}};
  summary.check_relative("x", 1.0 / 3.0, 0.3333, 1e-3, kSource);
  summary.check_word("end", "false", "true", kSource);
  summary.fail("limit point", "0.3386", kSource, "did not come");
  Summary other;
  other.append(summary.packed());
  EXPECT_EQ(json_of(other), json_of(summary));
  EXPECT_TRUE(std::signbit(other.quantities[0].value));
  EXPECT_FALSE(other.ends[0].has_potential);
  other.append(summary.packed());
  EXPECT_EQ(other.load_steps, 4);
  EXPECT_EQ(other.checks().size(), 6u);
  EXPECT_NE(json_of(other), json_of(summary)) << "the twin";
}

/// An application's own quantity, and a path that begins again.
TEST(Summary, ComparesAnOwnQuantityAtACriticalPoint) {
  const Simulation simulation(
      test::structure({{"foot", {0, 0, 0}}, {"tip", {0, 2, 0}}}, {test::line("rod", "foot", "tip", 4, 4)},
                      {test::clamp("foot")}, {}, test::section(1000.0, 500.0, 1.0, 1.0)),
      {}, test::this_rank());
  Application app;
  app.communicator = test::this_rank();
  ExpectedValue wanted;
  wanted.name = wanted.quantity = "twice the load factor";
  wanted.critical_point = 1;
  wanted.value = 0.5;
  wanted.source = "closed form";
  app.expected = {wanted};
  StepReport report;
  report.point.critical_points = 1;
  report.critical_points.push_back(
      {CriticalKind::limit_point, 0.25, 0, 1, simulation.state(), simulation.model().create_vector()});
  app.check_expected(simulation, report,
                     [](const Simulation& at, const ExpectedValue&) { return 2.0 * at.load_factor(); });
  EXPECT_TRUE(app.not_compared().empty());
  EXPECT_EQ(app.summary.checks().size(), 1U);
  EXPECT_TRUE(app.summary.all_passed());
  app.forget_path(0);
  EXPECT_EQ(app.not_compared().size(), 1U);
  EXPECT_EQ(app.critical_points(""), 0);
  EXPECT_TRUE(app.summary.checks().empty());
}

}  // namespace
}  // namespace mixbeam
