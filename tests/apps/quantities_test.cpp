/// The list "Quantities" as a user meets it: monitor, result file, summary, limits, checks, batch, resuming.
#include "mixbeam_files.hpp"

#include <cmath>

namespace mixbeam::quantities_test {
namespace {

constexpr int kOk = 0, kCheckFailed = 1, kBadInput = 2;

std::string entry(const std::string& name, const std::string& parameters) {
  std::string text = "<ParameterList name=\"" + name + "\">";
  std::istringstream lines(parameters);
  for (std::string line; std::getline(lines, line, ';');) {
    const std::size_t sign = line.find('=');
    const std::string value = line.substr(sign + 1);
    const bool is_number =
        line.rfind("Component", 0) != 0 && value.find_first_not_of("0123456789.e-") == std::string::npos;
    text += "<Parameter name=\"" + line.substr(0, sign) + "\" type=\"" + (is_number ? "double" : "string") +
            "\" value=\"" + value + "\"/>";
  }
  return text + "</ParameterList>";
}

std::string in_list(const std::string& name, const std::string& entries) {
  return "<ParameterList name=\"" + name + "\">" + entries + "</ParameterList>";
}

/// The gallery's elastica (EI = 1, force 10 across the tip, 1 long) with more lists.
std::string elastica_with(const std::string& lists) {
  const std::string text = text_of(fs::path(MIXBEAM_SOURCE_DIR) / "apps/gallery/elastica.xml");
  const std::string scene = "<ParameterList name=\"Scene\">";
  return changed(text, scene, lists + scene);
}

const std::string kTip = entry("sag", "Quantity=displacement;Point=tip");
const std::string kMoment = entry("M", "Quantity=material moment;Member=*;Component=3;Take=largest size");

std::map<std::string, std::string> last_row(const fs::path& file) {
  std::istringstream lines(text_of(file));
  std::string head, line, last;
  std::getline(lines, head);
  while (std::getline(lines, line)) last = line;
  std::map<std::string, std::string> row;
  std::istringstream names(head), cells(last);
  for (std::string name, cell; std::getline(names, name, ',') && std::getline(cells, cell, ',');) row[name] = cell;
  return row;
}

class Quantities : public ::testing::Test {
 protected:
  Ended run(const std::string& text, const std::vector<std::string>& more = {}) {
    write_text(folder_ / "scene.xml", text);
    std::vector<std::string> words = {"run", "scene.xml", "--output", "out", "--quiet", "--summary", "sum.json"};
    words.insert(words.end(), more.begin(), more.end());
    return run_process(program("mixbeam"), words, folder_.path());
  }
  TemporaryFolder folder_;
};

TEST_F(Quantities, StandInMonitorFileAndSummary) {
  const Ended ended = run(elastica_with(in_list("Quantities", kTip + kMoment)));
  ASSERT_EQ(ended.exit_code, kOk) << ended.err;
  auto row = last_row(folder_ / "out/scene-monitor.csv");
  EXPECT_EQ(row["sag.y"], row["tip.displacement.y"]);
  EXPECT_EQ(row["sag.x"], row["tip.displacement.x"]);
  // elliptic integrals: M = EI sqrt(2 F / EI) sqrt(sin theta) = sqrt(20 sin 1.4302855388039) at the clamp
  EXPECT_NEAR(std::abs(std::stod(row["M"])), std::sqrt(20.0 * std::sin(1.4302855388039)), 1e-9);
  EXPECT_EQ(std::stod(row["M.arc_length"]), 0.0);
  EXPECT_NE(row["M.member"].find_first_not_of("0123456789"), std::string::npos) << row["M.member"];
  const auto contents = contents_of(folder_ / "out/scene.h5");
  ASSERT_TRUE(contents);
  EXPECT_EQ(contents->count("monitor/quantities"), 1U);
  expect_in(contents->at("quantities"), {"sag.y\n", "M.arc_length\n"});
  expect_in(text_of(folder_ / "sum.json"), {"\"quantities\"", "\"sag.y\"", "\"at_largest_size\"", "\"arc_length\""});
  expect_in(ended.out, {"sag.y", "largest size"});
}

TEST_F(Quantities, LimitsFailTheRunWhereTheyAreExceeded) {
  const auto limited = [](const std::string& limit) {
    return elastica_with(
        in_list("Quantities", entry("sag", "Quantity=displacement;Point=tip;Component=norm;Limit=" + limit)));
  };
  const Ended within = run(limited("1.0"));
  EXPECT_EQ(within.exit_code, kOk) << within.out;
  const Ended beyond = run(limited("0.9"));
  EXPECT_EQ(beyond.exit_code, kCheckFailed);
  expect_in(beyond.out, {"FAIL", "size of sag", "at most 0.9"});
}

TEST_F(Quantities, MayBeExpected) {
  const auto expecting = [](const std::string& name, double value) {
    const std::string check = entry("check", "Quantity=" + name + ";Value=" + std::to_string(value) +
                                                 ";Absolute Tolerance=1e-6;Source=elliptic integrals");
    return changed(elastica_with(in_list("Quantities", kTip)), "<ParameterList name=\"Expected\">",
                   "<ParameterList name=\"Expected\">" + check);
  };
  EXPECT_EQ(run(expecting("sag.x", -0.555500)).exit_code, kCheckFailed);
  const Ended right = run(expecting("sag.x", -0.554996));
  EXPECT_EQ(right.exit_code, kOk) << right.out;
  const Ended unknown = run(expecting("sgg.x", 0.0));
  EXPECT_EQ(unknown.exit_code, kBadInput);
  expect_in(unknown.err, {"Expected / check / Quantity", "\"sgg.x\"", "did you mean \"sag.x\"?"});
}

TEST_F(Quantities, AreTheSameWhenARunIsResumed) {
  ASSERT_EQ(run(elastica_with(in_list("Quantities", kTip + kMoment))).exit_code, kOk);
  const std::string before = text_of(folder_ / "out/scene-monitor.csv");
  const Ended again = run_process(program("mixbeam"), {"resume", "out/scene.h5", "--quiet"}, folder_.path());
  ASSERT_EQ(again.exit_code, kOk) << again.err;
  EXPECT_EQ(text_of(folder_ / "out/scene-monitor.csv"), before);
}

TEST_F(Quantities, AreColumnsOfABatch) {
  const std::string forces = entry("force", "Parameter=Point Loads/weight/Force[1];First=-5;Last=-10");
  const std::string count = "<Parameter name=\"Count\" type=\"int\" value=\"6\"/></ParameterList>";
  const std::string output = "<Parameter name=\"Output\" type=\"string\" value=\"quantities\"/>";
  const std::string batch = in_list("Batch", output + in_list("Vary", changed(forces, "</ParameterList>", count)));
  const std::string text = elastica_with(in_list("Quantities", kTip + kMoment));
  const std::string scene = "<ParameterList name=\"Scene\">";
  write_text(folder_ / "scene.xml", changed(text, scene, batch + scene));
  const Ended ended = run_process(program("mixbeam"), {"batch", "scene.xml", "--output", "many"}, folder_.path());
  ASSERT_EQ(ended.exit_code, kOk) << ended.err << ended.out;
  auto row = last_row(folder_ / "many/scene-batch.csv");
  EXPECT_NEAR(std::abs(std::stod(row["M"])), std::sqrt(20.0 * std::sin(1.4302855388039)), 1e-8);
  EXPECT_NEAR(std::stod(row["sag.x"]), -0.5549955977538, 1e-8);
  EXPECT_EQ(std::stod(row["M.member"]), 0.0);
}

TEST_F(Quantities, NamesOfOtherSeriesAreRefused) {
  const Ended ended = run(
      elastica_with(in_list("Quantities", entry("tip.displacement", "Quantity=displacement;Point=tip;Component=x"))));
  EXPECT_EQ(ended.exit_code, kBadInput);
  expect_in(ended.err, {"scene.xml:", "tip.displacement", "something else"});
}

}  // namespace
}  // namespace mixbeam::quantities_test
