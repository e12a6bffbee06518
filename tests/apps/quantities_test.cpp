/// The list "Quantities" as a user meets it: monitor, result file, summary, limits, checks, batch, resuming.
#include "mixbeam_files.hpp"

namespace mixbeam::quantities_test {
namespace {

/// The gallery's elastica (EI = 1, force 10 across the tip, 1 long) with more lists.
std::string elastica_with(const std::string& lists, const std::vector<std::string>& removed = {}) {
  return with(text_in_repository("apps/gallery/elastica.xml"), lists, removed);
}
std::string asking(const std::string& quantities) { return elastica_with("Quantities: {" + quantities + "}"); }

const std::string kTip = "sag: {Quantity: displacement, Point: tip}";
const std::string kMoment = "M: {Quantity: material moment, Member: '*', Component: 3, Take: largest size}";
const std::string kBoth = kTip + ", " + kMoment;

Row last_row(const fs::path& file) { return rows_of(file).back(); }

class Quantities : public MixbeamTest {
 protected:
  Ended run(const std::string& text, std::vector<std::string> more = {}) {
    more.push_back("--quiet");
    return run_scene(text, more);
  }
};

TEST_F(Quantities, StandInMonitorFileAndSummary) {
  const Ended ended = expect_code(kOk, run(asking(kBoth)));
  auto row = last_row(folder_ / "results/scene-monitor.csv");
  EXPECT_EQ(row["sag.y"], row["tip.displacement.y"]);
  EXPECT_EQ(row["sag.x"], row["tip.displacement.x"]);
  // elliptic integrals: M = EI sqrt(2 F / EI) sqrt(sin theta) = sqrt(20 sin 1.4302855388039) at the clamp
  EXPECT_NEAR(std::abs(std::stod(row["M"])), std::sqrt(20.0 * std::sin(1.4302855388039)), 1e-9);
  EXPECT_EQ(std::stod(row["M.arc_length"]), 0.0);
  EXPECT_NE(row["M.member"].find_first_not_of("0123456789"), std::string::npos) << row["M.member"];
  const auto contents = contents_of(folder_ / "results/scene.h5");
  EXPECT_EQ(contents.count("monitor/quantities"), 1U);
  expect_in(contents.at("quantities"), {"sag.y\n", "M.arc_length\n"});
  expect_in(text("summary.json"), {"\"quantities\"", "\"sag.y\"", "\"at_largest_size\"", "\"arc_length\""});
  expect_in(ended.out, {"sag.y", "largest size"});
}

TEST_F(Quantities, HaveTheUnitsOfTheScene) {
  const std::string without = asking(kBoth + R"yaml(,
    turn: {Quantity: rotation, Point: tip, Component: z},
    wall: {Quantity: reaction force, Point: wall, Component: norm},
    kappa: {Quantity: spatial curvature, Point: tip, Component: z},
    strain: {Quantity: material strain, Point: tip, Component: 1},
    work: {Quantity: strain energy}, factor: {Quantity: load factor},
    long: {Quantity: length, Member: '*', Take: sum}, twice: {Quantity: formula, Formula: 2*long})yaml");
  ASSERT_EQ(run(with(without, "Scene: {Units: 'mm , kN'}")).exit_code, kOk);
  const auto contents = contents_of(folder_ / "results/scene.h5");
  expect_in(contents.at("quantities"), {"sag.x\nsag.y\nsag.z\nM\nM.member\nM.arc_length\nM."
                                        "side\nturn\nwall\nkappa\nstrain\nwork\nfactor\nlong\ntwice\n"});
  expect_in(contents.at("quantity_units"), {":mm\nmm\nmm\nkN mm\n\nmm\n\nrad\nkN\n1/mm\n\nkN mm\n\nmm\n\n"});
  ASSERT_EQ(mixbeam({"resume", "results/scene.h5", "--from", "1"}).exit_code, kOk);
  EXPECT_EQ(contents_of(folder_ / "results/scene.h5").at("quantity_units"), contents.at("quantity_units"));
  ASSERT_EQ(run(without).exit_code, kOk);
  EXPECT_EQ(contents_of(folder_ / "results/scene.h5").count("quantity_units"), 0U) << "the twin: nothing is said";
}

TEST_F(Quantities, LimitsFailTheRunWhereTheyAreExceeded) {
  const auto limited = [](const std::string& limit) {
    return asking("sag: {Quantity: displacement, Point: tip, Component: norm, Limit: " + limit + "}");
  };
  expect_code(kOk, run(limited("1.0")));
  expect_in(expect_code(kCheckFailed, run(limited("0.9"))).out, {"FAIL", "size of sag", "at most 0.9"});
}

/// Bars of EA = 100 and length 1, 2, 3 pulled by 1 in stage 1 and by 0.5 more in stage 2, where a case adds 0.25: an
/// end moves by N L / EA, which is exact however large it is.
const std::string kBars = R"(Scene:
  Sections: {bar: {EA: 100, Shear Rigid: true, GIt: 1, EI2: 1, EI3: 1}}
  Points: {A: [0, 0, 0], end 1: [1, 0, 0], end 2: [0, 2, 0], end 3: [-3, 0, 0]}
  Members: {bar 1: {Start: A, End: end 1}, bar 2: {Start: A, End: end 2}, bar 3: {Start: A, End: end 3}}
  Load Cases: [calm, storm]
  Supports: {clamp: {Point: A}}
  Point Loads:
    dead: {Point: end 1, Force: [1, 0, 0]}
    live: {Point: end 1, Force: [0.5, 0, 0], Stage: 2}
    gust: {Point: end 1, Force: [0.25, 0, 0], Stage: 2, Case: storm}
    across: {Point: end 2, Force: [0, 1, 0]}
    back: {Point: end 3, Force: [-1, 0, 0]}
Quantities:
  u: {Quantity: displacement, Point: end 1, Component: x, )";

TEST_F(Quantities, LimitsOfCasesAndStagesAndOfChanges) {
  const auto ended = [&](const std::string& limit) { return run_scene(kBars + limit + "}\n", {"--quiet"}); };
  const auto expect_limit = [&](const std::string& within, const std::string& beyond) {
    const Ended kept = ended(within), exceeded = ended(beyond);
    EXPECT_EQ(kept.exit_code, kOk) << within << kept.out << kept.err;
    EXPECT_EQ(exceeded.exit_code, kCheckFailed) << beyond << exceeded.err;
  };
  expect_limit("Limit: 0.0176", "Limit: 0.0174");
  expect_limit("Limit: 0.0151, Case: calm", "Limit: 0.0149, Case: calm");
  expect_limit("Limit: 0.0151, Case: 'c*'", "Limit: 0.0151, Case: '[cs]*'");
  expect_limit("Limit: 0.0101, Stage: 1", "Limit: 0.0101, Stage: 2");
  expect_limit("Limit: 0.0076, Relative To: 1", "Limit: 0.0074, Relative To: 1");
  expect_limit("Limit: 0.0051, Relative To: 1, Case: calm", "Limit: 0.0149, Relative To: 0, Case: calm");
  expect_limit("Span: \"=x('end 1')*3.5\", Span Ratio: 198, Relative To: 0", "Span: 3.5, Span Ratio: 202");
  expect_in(ended("Limit: 0.0074, Relative To: 1").out,
            {"FAIL", "size of u since the end of stage 1", "storm", "at most 0.0074"});
  EXPECT_EQ(mixbeam({"resume", "results/scene-storm.h5", "--from", "1"}).exit_code, kCheckFailed);
  expect_refused(ended("Limit: 1, Case: strom"), {"scene.yaml:", "Quantities / u / Case", "did you mean \"storm\"?"});
  expect_refused(ended("Limit: 1, Stage: 3"), {"u / Stage", "value 3", "up to 2"});
  expect_refused(ended("Limit: 1, Relative To: 2"), {"u / Relative To", "up to 1"});
  expect_refused(ended("Limit: 1, Relative To: 1, Stage: 1"), {"u / Relative To", "a stage before"});
  expect_refused(ended("Relative To: 1"), {"u / Relative To", "without a limit"});
  expect_refused(ended("Span Ratio: 300"), {"u / Span", "missing"});
  expect_refused(ended("Span: 3, Span Ratio: 300, Limit: 1"), {"u / Span Ratio", "one of the two"});
}

/// Since stage 1 the bar is longer by 0.01 times the live load, and by 0.0025: 0.0075 and 0.0125.
TEST_F(Quantities, LimitsOfABatchMayBeOfChangesAndFollowVariables) {
  const std::string bars = changed(changed(kBars, "Scene:\n", "Scene:\n  Variables: {live: 0.5}\n"),
                                   "Force: [0.5, 0, 0]", "Force: [\"=live\", 0, 0]");
  for (const std::string way : {"Trace: false", "Trace: true"}) {  // side by side, and each alone
    const auto failed = [&](const std::string& limit) {
      write_text(folder_ / "scene.yaml", bars + limit + "}\nAnalysis: {" + way +
                                             "}\nBatch: {Output: quantities, Vary: {live: {Parameter: Variables/live, "
                                             "First: 0.5, Last: 1, Count: 2}}}\n");
      const Ended ended = mixbeam({"batch", "scene.yaml", "--case", "storm", "--output", "many"});
      EXPECT_EQ(ended.err, "");
      if (ended.exit_code == kOk) return std::string();
      EXPECT_EQ(ended.exit_code, kCheckFailed) << ended.out;
      std::string cases;
      for (const std::string one : {"case 1", "case 2"})
        if (ended.out.find(one + ": size of u") != std::string::npos) cases += one;
      return cases;
    };
    EXPECT_EQ(failed("Limit: 0.0126, Relative To: 1"), "");
    EXPECT_EQ(failed("Limit: 0.0124, Relative To: 1"), "case 2");
    if (way == "Trace: true") continue;
    EXPECT_EQ(failed("Limit: \"=0.0026+0.01*live\", Relative To: 1"), "");
    EXPECT_EQ(failed("Limit: \"=0.0074+0.0001*(live > 0.7)\", Relative To: 1"), "case 1case 2");
    EXPECT_EQ(failed("Span: \"=live\", Span Ratio: 70, Relative To: 1"), "case 1");
  }
}

/// 0.0175, 0.02 and 0.03 at the ends of the bars, in the storm.
TEST_F(Quantities, TheLargestOfSeveralPlacesHasAPlace) {
  write_text(folder_ / "scene.yaml",
             kBars + "}\n  far: {Quantity: displacement, Point: 'end *', Component: norm, Take: largest, Limit: 1}\n" +
                 "  half: {Quantity: displacement, Point: 'bar [12]@50%', Component: norm, Take: smallest}\n");
  expect_in(expect_code(kOk, mixbeam({"run", "scene.yaml", "--case", "storm", "--output", "results", "--summary",
                                      "summary.json"}))
                .out,
            {"at the end: end 3\n", "at the end: bar 1@50%\n"});
  expect_in(text("summary.json"), {"\"place\": \"end 3\"", "\"place\": \"bar 1@50%\""});
  const Ended report = expect_code(kOk, mixbeam({"report", "results/scene-storm.h5"}));
  const std::string page = text("results/scene-storm-report.html"), place = "<td class=words>end 3</td>";
  const std::size_t limits = page.find("size of far"), first = page.find(place, limits);
  EXPECT_LT(first, page.find("</table>", limits));            // beside the limit,
  EXPECT_NE(page.find(place, first + 1), std::string::npos);  // and the quantity
  expect_in(page, {"<td class=words>bar 1@50%</td>"});
}

TEST_F(Quantities, MayBeExpected) {
  const auto expecting = [](const std::string& name, double value) {
    return with(asking(kTip), "Expected: {check: {Quantity: " + name + ", Value: " + std::to_string(value) +
                                  ", Absolute Tolerance: 1e-6, Source: elliptic integrals}}");
  };
  EXPECT_EQ(run(expecting("sag.x", -0.555500)).exit_code, kCheckFailed);
  expect_code(kOk, run(expecting("sag.x", -0.554996)));
  expect_refused(run(expecting("sgg.x", 0.0)), {"Expected / check / Quantity", "\"sgg.x\"", "did you mean \"sag.x\"?"});
}

TEST_F(Quantities, AreTheSameWhenARunIsResumed) {
  ASSERT_EQ(run(asking(kBoth)).exit_code, kOk);
  const std::string before = text("results/scene-monitor.csv");
  expect_code(kOk, mixbeam({"resume", "results/scene.h5", "--quiet"}));
  EXPECT_EQ(text("results/scene-monitor.csv"), before);
}

/// The elastica under a force of 10 and of `other` across the tip; its moment at the clamp is not linear in them.
std::string two_cases(const std::string& other) {
  return elastica_with("Quantities: {" + kBoth +
                           "}\nScene: {Load Cases: [down, other], Point Loads: {more: {Point: tip, " +
                           "Force: [0, 0, " + other + "], Case: other}}}",
                       {"Expected"});
}

/// A run of one case alone renews the envelope from the files of the others, and says so where it cannot.
TEST_F(Quantities, EnvelopesAreRenewedByRunsOfOneCase) {
  const auto envelope = [this] { return text("results/scene-envelope.csv"); };
  const auto resume = [this](const std::string& file) { return mixbeam({"resume", file, "--quiet"}); };
  ASSERT_EQ(run(two_cases("3"), {"--case", "down"}).exit_code, kOk);
  EXPECT_FALSE(fs::exists(folder_ / "results/scene.h5"));
  ASSERT_EQ(run(two_cases("3"), {"--case", "other"}).exit_code, kOk);
  const std::string one_by_one = envelope();
  ASSERT_EQ(run(two_cases("3")).exit_code, kOk);
  EXPECT_EQ(envelope(), one_by_one);
  fs::remove(folder_ / "results/scene-envelope.csv");
  ASSERT_EQ(resume("results/scene-other.h5").exit_code, kOk);
  EXPECT_EQ(envelope(), one_by_one);
  const Ended changed_scene = expect_code(kOk, run(two_cases("4"), {"--case", "other"}));
  expect_in(changed_scene.out,
            {"results/scene.h5: the envelope is that of an earlier run", "scene-down.h5 is of another scene"});
  EXPECT_EQ(envelope(), one_by_one);
  ASSERT_EQ(run(two_cases("4"), {"--case", "down"}).exit_code, kOk);
  EXPECT_NE(envelope(), one_by_one);
  expect_refused(resume("results/scene.h5"),
                 {"the envelope of 2 runs", "\"results/scene-down.h5\", \"results/scene-other.h5\""});
}

/// Cases under 5 to 10.
std::string batch_of(const std::string& output, int count) {
  return "Batch: {Output: " + output +
         ", Vary: {force: {Parameter: 'Point Loads/weight/Force[1]', First: -5, Last: -10, " +
         "Count: " + std::to_string(count) + "}}}";
}

TEST_F(Quantities, AreColumnsOfABatch) {
  write_text(folder_ / "scene.xml", with(asking(kBoth), batch_of("quantities", 6)));
  expect_code(kOk, mixbeam({"batch", "scene.xml", "--output", "many"}));
  auto row = last_row(folder_ / "many/scene-batch.csv");
  EXPECT_NEAR(std::abs(std::stod(row["M"])), std::sqrt(20.0 * std::sin(1.4302855388039)), 1e-8);
  EXPECT_NEAR(std::stod(row["sag.x"]), -0.5549955977538, 1e-8);
  EXPECT_EQ(row["M.member"], "strip");
}

/// The elastica under 5 and 10: its tip goes down by 0.7137 and 0.8106 (elliptic integrals).
class QuantitiesOfABatch : public Quantities {
 protected:
  Ended batch(const std::string& output, const std::string& text) {
    write_text(folder_ / "scene.xml", with(text, batch_of(output, 2)));
    return mixbeam({"batch", "scene.xml", "--output", "many", "--summary", "summary.json"});
  }
};

TEST_F(QuantitiesOfABatch, LimitsAreChecksOfEachCase) {
  const auto limited = [](const std::string& limit) {
    return asking("sag: {Quantity: displacement, Point: tip, Component: y, Limit: " + limit + "}");
  };
  for (const std::string output : {"quantities", "followed", "expected"}) {
    expect_in(expect_code(kCheckFailed, batch(output, limited("0.8"))).out,
              {"case 2: size of sag", "1 of 2 checks passed, 1 FAILED"});
    EXPECT_EQ(last_row(folder_ / "many/scene-batch.csv")["beyond limits"], "sag") << output;
    EXPECT_EQ(batch(output, limited("0.9")).exit_code, kOk);
    EXPECT_EQ(last_row(folder_ / "many/scene-batch.csv")["beyond limits"], "");
  }
}

TEST_F(QuantitiesOfABatch, ExpectedValuesMayNameThem) {
  const Ended ended =
      expect_code(kOk, batch("expected", with(asking(kTip),
                                              "Expected: {sag of each: {Quantity: sag.y, Value: -0.8106090249, "
                                              "Absolute Tolerance: 1e-6, Source: x}}")));
  auto row = last_row(folder_ / "many/scene-batch.csv");
  EXPECT_NEAR(std::stod(row["sag of each"]), -0.8106090249, 1e-9);
  EXPECT_EQ(row["sag of each"], row["tip moves down"]);  // the scene's own, of common quantities
}

TEST_F(Quantities, StressPointsOfSectionsGivenByStiffnesses) {  // E = 1 / I: M c / I at c = 0.02, as M above
  const Ended ended = expect_code(
      kOk, run(with(asking("stress: {Quantity: normal stress, Member: '*', Take: largest size}, " + kMoment),
                    "Scene: {Sections: {strip: {Stress Points: {E: 50, Area: 1e12, Points: {outer: [0.02, "
                    "0], inner: [-0.01, 0]}}}}}")));
  auto row = last_row(folder_ / "results/scene-monitor.csv");
  EXPECT_NEAR(std::abs(std::stod(row["stress"])), std::abs(std::stod(row["M"])) * 0.02 * 50.0, 1e-9);
  expect_in(ended.out, {"largest stress in"});
}

TEST_F(Quantities, FormulasWithoutAFiniteValueAreWarnedOf) {
  const std::string none = "none: {Quantity: formula, Formula: 0 / (sag_y - sag_y)}";
  expect_code(kOk, run(asking(kTip + ", " + none)));
  expect_in(text("summary.json"), {"formulas without a finite value at the end", "\\\"none\\\""});
  run(asking("none: {Quantity: angle, Point: tip, Corner: tip, Other Point: wall}"));
  expect_in(text("summary.json"), {"angles with a side of no length: \\\"none\\\""});
  run(asking(kTip + ", twice: {Quantity: formula, Formula: 2 * sag_y}"));
  EXPECT_EQ(text("summary.json").find("without a finite value"), std::string::npos);
}

TEST_F(Quantities, FormulasReferToWhatStandsAboveThem) {
  const std::string twice = "twice: {Quantity: formula, Formula: 2 * sag_y}";
  EXPECT_EQ(run(asking(kTip + ", " + twice)).exit_code, kOk);
  expect_refused(run(asking(twice + ", " + kTip)),
                 {"Quantities / twice / Formula", "\"sag_y\"", "allowed: a formula of numbers with"});
}

/// As numbers; a name that is that of a quantity too would be one of the two.
TEST_F(Quantities, FormulasKnowVariables) {
  const auto asked = [](const std::string& variable) {
    return with(asking(kTip + ", share: {Quantity: formula, Formula: \"sag_y / (" + variable + "/8)\"}"),
                "Scene: {Variables: {" + variable + ": 4}}");
  };
  ASSERT_EQ(run(asked("span")).exit_code, kOk);
  auto row = last_row(folder_ / "results/scene-monitor.csv");
  EXPECT_NEAR(std::stod(row["share"]), std::stod(row["sag.y"]) * 2.0, 1e-12);
  expect_refused(run(asked("sag_y")), {"share / Formula", "\"sag_y\" names a variable and a quantity"});
}

TEST_F(Quantities, LargestOfAVectorNeedsAComponent) {
  const auto asked = [&](const std::string& more) {
    return run(asking("M: {Quantity: material moment, Member: '*'" + more + "}"));
  };
  expect_refused(asked(", Take: largest"), {"\"Quantities / M / Component\": missing"});
  const Ended bare = asked("");  // neither an extreme nor a place
  EXPECT_EQ(bare.exit_code, kBadInput);
  expect_in(bare.err, {"\"Quantities / M / Position\": missing"});
  EXPECT_EQ(asked(", Take: largest, Component: norm").exit_code, kOk);
}

TEST_F(Quantities, NamesOfOtherSeriesAreRefused) {
  expect_refused(run(asking("tip.displacement: {Quantity: displacement, Point: tip, Component: x}")),
                 {"scene.xml:", "tip.displacement", "something else"});
}

}  // namespace
}  // namespace mixbeam::quantities_test
