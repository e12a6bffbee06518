/// `mixbeam batch`: many cases at once against single runs and closed forms, cases that fail, tables that are wrong.
#include "mixbeam_files.hpp"

#include <regex>

namespace mixbeam::batch_test {
namespace {

std::string sweep() { return text_in_repository("apps/batch/elastica_sweep.xml"); }
std::string sweep_table() { return text_in_repository("apps/batch/elastica_sweep.csv"); }

/// The sweep's scene with another list "Batch".
std::string with_batch(const std::string& entries) { return with(sweep(), "Batch: {" + entries + "}", {"Batch"}); }

class Batch : public MixbeamTest {
 protected:
  Ended solve(const std::string& scene, const std::string& table = "", const std::vector<std::string>& options = {}) {
    write_text(folder_ / "scene.xml", scene);
    if (!table.empty()) write_text(folder_ / "elastica_sweep.csv", table);
    return mixbeam({"batch", "scene.xml", "--output", "results"}, options);
  }
  std::vector<Row> rows() const { return rows_of(folder_ / "results/scene-batch.csv"); }

  /// Last row of what a single run follows.
  Row single(const std::string& scene) {
    write_text(folder_ / "single.xml", scene);
    mixbeam({"run", "single.xml", "--output", "single"});
    return rows_of(folder_ / "single/single-monitor.csv").back();
  }

  /// Everything that both follow agrees to 1e-9 of the largest number of its kind, here at most about 10.
  static void expect_same(const Row& in_batch, const Row& alone) {
    int compared = 0;
    for (const auto& [name, value] : alone) {
      const auto found = in_batch.find(name);
      if (name.find('.') == std::string::npos || found == in_batch.end()) continue;
      ++compared;
      EXPECT_NEAR(std::stod(found->second), std::stod(value), 1e-9) << name;
    }
    EXPECT_EQ(compared, 18);  // displacement and rotation of two points, force and moment of one support
  }
};

/// The sweep with an accuracy, its members with what `division` says in place of order and elements.
std::string sweep_with_accuracy(const std::string& accuracy, const std::string& division) {
  const std::string free = std::regex_replace(sweep(), std::regex("<Parameter name=\"(Elements|Order)\"[^>]*>"), "");
  return with(free, "Scene: {Accuracy: " + accuracy + ", Members: {strip: {" + division + "}}}");
}

TEST_F(Batch, EachCaseChoosesItsMeshForAnAccuracy) {
  expect_in(expect_code(kOk, solve(sweep_with_accuracy("1e-9", ""), sweep_table())).out,
            {"15 of 15 checks passed", "40 cases, 0 failed"});
}

// The twin: two elements of order 2 are not enough for the larger loads.
TEST_F(Batch, CasesThatMissTheAccuracyFail) {
  const std::string division = "Order: 2, Elements: 2";
  const Ended ended = solve(sweep_with_accuracy("1e-2", division), sweep_table());
  EXPECT_NE(ended.exit_code, kOk) << ended.out;
  const std::vector<Row> found = rows();
  ASSERT_EQ(found.size(), 40u);
  EXPECT_EQ(found.front().at("converged"), "yes");
  EXPECT_EQ(found.back().at("converged"), "no");
  expect_in(found.back().at("cause"), {"accuracy of 1.0e-02"});
}

TEST_F(Batch, ATableOfLoadsGivesTheElastica) {
  expect_in(expect_code(kOk, solve(sweep(), sweep_table())).out,
            {"15 of 15 checks passed", "40 cases, 0 failed", "group   1 of"});
  const std::vector<Row> found = rows();
  ASSERT_EQ(found.size(), 40u);
  EXPECT_EQ(found[7].at("Point Loads/weight/Force[1]"), "-2");
  EXPECT_EQ(found[7].at("converged"), "yes");
  const auto contents = contents_of(folder_ / "results/scene-batch.h5");
  for (const char* path : {"columns/Point Loads/weight/Force[1]", "columns/tip turns", "columns/converged", "scene"})
    EXPECT_EQ(contents.count(path), 1u) << path;
}

/// Whatever a formula makes of a variable follows it, in each case of its own.
TEST_F(Batch, VariablesVaryWithAllThatComesOfThem) {
  const std::string scene =
      with(sweep(), "Scene: {Variables: {F: 1, twice: \"=2*F\"}, Point Loads: {weight: {Force: [0, \"=-twice\", 0]}}}");
  expect_code(kOk, solve(scene, "Variables/F,Expected/tip turns/Value\n1,\n=8/2,\n"));
  const std::vector<Row> by_variable = rows();
  ASSERT_EQ(by_variable.size(), 2u);
  ASSERT_EQ(solve(sweep(), "Point Loads/weight/Force[1]\n-2\n-8\n").exit_code, kOk);
  const std::vector<Row> by_force = rows();
  for (std::size_t i = 0; i < 2; ++i) EXPECT_EQ(by_variable[i].at("tip moves down"), by_force[i].at("tip moves down"));
  EXPECT_NE(by_variable[0].at("tip moves down"), by_variable[1].at("tip moves down"));
  // cells know the variables of their row, in any order
  ASSERT_EQ(solve(scene, "Variables/twice,Variables/F\n=F+1,1\n=2*F,=1+3\n").exit_code, kOk);
  const std::vector<Row> by_cell = rows();
  for (std::size_t i = 0; i < 2; ++i) EXPECT_EQ(by_cell[i].at("tip moves down"), by_force[i].at("tip moves down"));
  expect_refused(solve(scene, "Variables/F\n=8*G\n"),
                 {"elastica_sweep.csv:2", "=8*G", "no formula", "\n    =8*G\n    ^"});
  expect_refused(solve(scene, "Variables/F\n=8*F\n"), {"elastica_sweep.csv:2", "needs itself"});
  expect_refused(solve(scene, "Variables/G\n1\n"),
                 {"elastica_sweep.csv:1:1: \"Variables/G\": no Parameter", "\n    ^"});
  expect_refused(solve(with(scene, "Solver: {Load Path: {Maximum Step: \"=F/4\"}}"), "Variables/F\n1\n2\n"),
                 {"case 2", "Solver / Load Path / Maximum Step", "0.5 in this case and 0.25", "limits and expected"});
  EXPECT_EQ(solve(with(scene, "Solver: {Load Path: {Maximum Step: \"=1/4\"}}"), "Variables/F\n1\n2\n").exit_code, kOk);
}

/// By elliptic integrals, under forces of 0.5 and 2.
TEST_F(Batch, ExpectedValuesMayFollowFromVariables) {
  const auto ended = [&](const std::string& value) {
    const std::string scene =
        with(sweep(), "Scene: {Variables: {F: 1}, Point Loads: {weight: {Force: [0, \"=-F\", 0]}}}");
    return solve(with(scene, "Expected: {tip turns: {Value: \"=F > 1 ? -0.7817498315565 : " + value + "\"}}"),
                 "Variables/F\n0.5\n2\n");
  };
  const Ended right = ended("-0.2445336471332"), wrong = ended("-0.2445336");
  EXPECT_EQ(right.exit_code, kOk) << right.err;
  expect_in(right.out, {"2 of 2 checks passed"});
  EXPECT_EQ(wrong.exit_code, kCheckFailed);
  expect_in(wrong.out, {"1 of 2 checks passed"});
}

TEST_F(Batch, AWrongClosedFormIsFound) {
  expect_in(expect_code(kCheckFailed, solve(sweep(), changed(sweep_table(), "-0.8106090", "-0.8106091"))).out,
            {"14 of 15 checks passed"});
}

TEST_F(Batch, AGridAgreesWithSingleRuns) {
  expect_code(
      kOk, solve(with_batch("Vary: {load: {Parameter: 'Point Loads/weight/Force[1]', First: -0.5, Last: -8, Count: 5, "
                            "Spacing: logarithmic}, stiffness: {Parameter: Sections/strip/EI3, First: 1, Last: 1.5, "
                            "Count: 2}}")));
  const std::vector<Row> found = rows();
  ASSERT_EQ(found.size(), 10u);
  for (std::size_t i : {0u, 3u, 9u}) {
    const std::string load = found[i].at("Point Loads/weight/Force[1]"), stiffness = found[i].at("Sections/strip/EI3");
    SCOPED_TRACE(load + " " + stiffness);
    EXPECT_DOUBLE_EQ(std::stod(load), -0.5 * std::pow(2.0, i / 2));
    EXPECT_DOUBLE_EQ(std::stod(stiffness), i % 2 == 0 ? 1.0 : 1.5);
    const std::string scene = changed(sweep(), "{0, -10, 0}", "{0, " + load + ", 0}");
    expect_same(found[i], single(changed(scene, "value=\"1\"", "value=\"" + stiffness + "\"", "\"EI3\"")));
  }
}

TEST_F(Batch, ResultsAreTheSameBitsForAnyNumberOfThreads) {
  solve(sweep(), sweep_table(), {"--threads", "1"});
  const std::string one = text("results/scene-batch.csv");
  solve(sweep(), sweep_table(), {"--threads", "2"});
  EXPECT_EQ(text("results/scene-batch.csv"), one);
  EXPECT_FALSE(one.empty());
}

/// The strip as one element of order 1, rolled up by a moment: at 2 pi its ends stand at pi, where rotations end.
std::string rolled_up() {
  const std::string scene =
      with(with_batch("Table: elastica_sweep.csv"),
           "Scene: {Members: {strip: {Order: 1, Elements: 1}}, Point Loads: {weight: {Force: [0, 0, 1]}}}");
  return changed(scene, "\"Force\"", "\"Moment\"");
}

/// The first frequency of a cantilever falls with the root of its mass.
TEST_F(Batch, FrequenciesOfEachCase) {
  write_text(folder_ / "mass.yaml", R"(Scene:
  Sections: {rod: {Inextensible: true, Shear Rigid: true, GIt: 1, EI2: 1, EI3: 1, Mass: 1}}
  Points: {wall: [0, 0, 0], tip: [1, 0, 0]}
  Members: {beam: {Start: wall, End: tip, Section: rod, Order: 4, Elements: 8}}
  Supports: {clamp: {Point: wall}}
Analysis: {Modes: {Number: 1, In Plane: true}}
Quantities: {f: {Quantity: natural frequency, Mode: 1}}
Batch: {Output: quantities, Vary: {mass: {Parameter: Sections/rod/Mass, First: 1, Last: 4, Count: 2}}}
)");
  expect_code(kOk, mixbeam({"batch", "mass.yaml", "--output", "results"}));
  const std::vector<Row> found = rows_of(folder_ / "results/mass-batch.csv");
  ASSERT_EQ(found.size(), 2u);
  constexpr double kFirst = 0.55959, kDigits = 1e-5;  // 3.51602 / (2 pi)
  EXPECT_NEAR(std::stod(found[0].at("f")), kFirst, kDigits);
  EXPECT_NEAR(std::stod(found[1].at("f")), 0.5 * kFirst, kDigits);
}

TEST_F(Batch, RanksShareTheCasesBitForBit) {
  ASSERT_EQ(solve(sweep(), sweep_table(), {"--quiet"}).exit_code, kOk);
  const std::string alone = text("results/scene-batch.csv");
  for (const std::string ranks : {"2", "3"}) {
    const Ended ended =
        expect_code(kOk, run_process("/usr/bin/env",
                                     {"mpirun", "--allow-run-as-root", "--oversubscribe", "--bind-to", "none", "-np",
                                      ranks, program("mixbeam"), "batch", "scene.xml", "--output", "ranks", "--force"},
                                     folder_));
    EXPECT_EQ(text("ranks/scene-batch.csv"), alone) << ranks;
    expect_in(ended.out, {"15 of 15 checks passed", "40 cases, 0 failed"});
  }
}

TEST_F(Batch, RowsOfATableKeepTheirNumbers) {
  ASSERT_EQ(solve(sweep(), sweep_table(), {"--quiet"}).exit_code, kOk);
  const std::vector<Row> all = rows();
  ASSERT_EQ(solve(sweep(), sweep_table(), {"--quiet", "--rows", "3:7"}).exit_code, kOk);
  const std::vector<Row> some = rows_of(folder_ / "results/scene-batch-3-7.csv");
  ASSERT_EQ(some.size(), 5u);
  constexpr double kCheckFailedGroups = 1e-11;  // residuals are as small, not the same
  for (std::size_t i = 0; i < some.size(); ++i) {
    EXPECT_EQ(some[i].at("case"), std::to_string(i + 3));
    EXPECT_NEAR(std::stod(some[i].at("tip turns")), std::stod(all[i + 2].at("tip turns")), kCheckFailedGroups);
    EXPECT_GT(std::abs(std::stod(some[i].at("tip turns")) - std::stod(all[i].at("tip turns"))),
              1e3 * kCheckFailedGroups);
  }
  EXPECT_EQ(solve(sweep(), sweep_table(), {"--rows", "39:40"}).exit_code, kOk);
  EXPECT_EQ(rows_of(folder_ / "results/scene-batch-39-40.csv").size(), 2u);
  for (const std::string rows : {"41:50", "39:41", "7:3", "0:3", "3", "a:b"}) {
    expect_refused(solve(sweep(), sweep_table(), {"--rows", rows}), {"option --rows", "allowed: "});
  }
}

TEST_F(Batch, AFolderGivesARowForEachStructureAndLoadCase) {
  const fs::path gallery = fs::path(MIXBEAM_SOURCE_DIR) / "apps/gallery", folder = folder_ / "designs";
  fs::create_directories(folder);
  for (const std::string scene : {"elastica.xml", "portal_frame.xml", "follower_cantilever.xml"})
    fs::copy(gallery / scene, folder / scene);
  const auto batch = [&](const std::vector<std::string>& options) {
    std::vector<std::string> arguments = {"batch", "designs/", "--quiet"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    return mixbeam(arguments);
  };
  expect_code(kOk, batch({}));
  const fs::path table = folder_ / "results/designs/designs-batch.csv";
  const std::vector<Row> all = rows_of(table);
  ASSERT_EQ(all.size(), 6u);  // the portal has four load cases
  EXPECT_EQ(all[0].at("structure"), "elastica.xml");
  EXPECT_EQ(all[3].at("load case"), "wind");
  EXPECT_EQ(all[0].at("sway of the eaves"), "nan");  // the portal alone asks for it
  expect_code(kOk, mixbeam({"run", "designs/portal_frame.xml", "--case", "wind"}));
  const Row last = rows_of(folder_ / "results/portal_frame/portal_frame-wind-monitor.csv").back();
  EXPECT_EQ(all[3].at("sway of the eaves"), last.at("sway of the eaves"));
  EXPECT_NE(all[2].at("sway of the eaves"), last.at("sway of the eaves"));  // under snow
  expect_code(kOk, mixbeam({"plot", "results/designs/designs-batch.h5"}));
  EXPECT_TRUE(fs::exists(folder_ / "results/designs/designs-batch.png"));
  ASSERT_EQ(batch({"--rows", "4:5"}).exit_code, kOk);
  EXPECT_EQ(rows_of(folder_ / "results/designs/designs-batch-4-5.csv").front(), all[3]);
  expect_code(kOk, run_process("/usr/bin/env",
                               {"mpirun", "--allow-run-as-root", "--oversubscribe", "--bind-to", "none", "-np", "2",
                                program("mixbeam"), "batch", "designs", "--output", "ranks"},
                               folder_));
  EXPECT_EQ(text("ranks/designs-batch.csv"), text_of(table));
  write_text(folder / "slip.xml", with(text_of(gallery / "elastica.xml"), "Scene: {Members: {strip: {Order: 99}}}"));
  expect_refused(batch({}), {"slip.xml", "99"});
  fs::create_directories(folder_ / "empty");
  expect_refused(mixbeam({"batch", "empty"}), {"holds no scene (*.xml, *.yaml, *.yml)"});
}

TEST_F(Batch, RanksThatShareAStructureTellItsMeshOnce) {
  fs::create_directories(folder_ / "designs");
  write_text(folder_ / "designs/rod.yaml", R"yaml(Scene:
  Load Cases: [down, side]
  Sections: {rod: {EA: 1000, GA2: 300, GA3: 300, GIt: 1, EI2: 1, EI3: 1}}
  Points: {wall: [0, 0, 0], tip: [1, 0, 0]}
  Members: {rod: {Start: wall, End: tip, Section: rod}}
  Supports: {clamp: {Point: wall}}
  Point Loads:
    down: {Point: tip, Force: [0, 0, -1], Case: down}
    side: {Point: tip, Force: [0, 1, 0], Case: side}
)yaml");
  expect_code(kOk, run_process("/usr/bin/env",
                               {"mpirun", "--allow-run-as-root", "--oversubscribe", "--bind-to", "none", "-np", "2",
                                program("mixbeam"), "batch", "designs", "--output", "ranks", "--summary", "ranks.json"},
                               folder_));
  const std::string summary = text("ranks.json"), mesh = "\"wanted\"";
  ASSERT_NE(summary.find(mesh), std::string::npos) << summary;
  EXPECT_EQ(summary.find(mesh), summary.rfind(mesh)) << summary;
}

TEST_F(Batch, ACaseThatCannotBeSolvedSpoilsNoOther) {
  const Ended ended =
      solve(rolled_up(), "Point Loads/weight/Moment[2]\n5\n5.5\n6.2831853071795\n6\n5.25\n4.5\n");  // 2 pi (1 - 1e-14)
  EXPECT_EQ(ended.exit_code, kNoConvergence) << ended.out;
  expect_in(ended.out, {"elastica_sweep.csv:4: case 3 FAILED", "6 cases, 1 failed"});
  expect_in(ended.err, {"1 of 6 cases did not converge"});
  const std::vector<Row> found = rows();
  ASSERT_EQ(found.size(), 6u);
  EXPECT_EQ(found[2].at("converged"), "no");
  EXPECT_FALSE(found[2].at("cause").empty());
  EXPECT_EQ(found[2].at("tip.displacement.x"), "nan");
  for (std::size_t i : {0u, 1u, 3u, 4u, 5u}) {
    const double moment = std::stod(found[i].at("Point Loads/weight/Moment[2]"));
    EXPECT_EQ(found[i].at("converged"), "yes");
    // one element of order 1: an arc whose ends turn by half the angle against it; its chord is the element itself
    EXPECT_NEAR(std::stod(found[i].at("tip.displacement.x")), std::cos(0.5 * moment) - 1.0, 1e-9) << moment;
    EXPECT_NEAR(std::stod(found[i].at("tip.displacement.y")), std::sin(0.5 * moment), 1e-9) << moment;
  }
}

/// Euler: a cantilever of length one under an axial load stands up to pi^2 EI / 4 = 2.467 EI.
TEST_F(Batch, EachCaseTellsWhetherItsEndIsStable) {
  const std::string scene =
      with(with_batch("Table: elastica_sweep.csv"), "Scene: {Point Loads: {weight: {Force: [-1, 0, 0]}}}");
  const Ended ended = expect_code(kOk, solve(scene, "Point Loads/weight/Force[0]\n-2.4\n-2.5\n-1\n2.5\n-2.46\n",
                                             {"--summary", file("summary.json")}));
  const std::vector<Row> found = rows();
  ASSERT_EQ(found.size(), 5u);
  const std::vector<std::string> stable = {"true", "false", "true", "true", "true"};
  for (std::size_t i = 0; i < found.size(); ++i) EXPECT_EQ(found[i].at("stable"), stable[i]) << i;
  expect_in(ended.out,
            {"case 2: stable: false: a real structure does not stay there",
             "cases by stable: true 4, false 1, neutral 0, unknown 0", "1 warning", "\"Expected/<name>/Value\""});
  EXPECT_EQ(ended.out.find("the scene gives no expected values"), std::string::npos) << "it does give some";
  expect_in(text("summary.json"),
            {"\"stable\": \"false\"", "1 of 5 cases end unstable: a real structure does not stay there"});
  EXPECT_EQ(contents_of(folder_ / "results/scene-batch.h5").count("columns/stable"), 1u);
}

/// Beck's column flutters at 20.05 EI / L^2; the tangent does not tell.
TEST_F(Batch, EachCaseIsJudgedByModes) {
  write_text(folder_ / "beck.yaml", R"(Scene:
  Variables: {P: 20}
  Sections: {rod: {Inextensible: true, Shear Rigid: true, GIt: 1, EI2: 1, EI3: 1, Mass: 1}}
  Points: {foot: [0, 0, 0], head: [0, 0, 1]}
  Members: {rod: {Start: foot, End: head, Section: rod, Order: 4, Elements: 4, Second Axis: [0, 1, 0]}}
  Supports: {foot: {Point: foot}}
  Point Loads: {thrust: {Point: head, Force: ["=-P", 0, 0], Frame: follower, Member: rod}}
Analysis: {Modes: {Number: 2, In Plane: true}}
Batch: {Vary: {thrust: {Parameter: Variables/P, First: 20, Last: 20.1, Count: 2}}}
)");
  expect_code(kOk, mixbeam({"batch", "beck.yaml", "--output", "results"}));
  const std::vector<Row> found = rows_of(folder_ / "results/beck-batch.csv");
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].at("stable"), "true");
  EXPECT_EQ(found[1].at("stable"), "false");
}

TEST_F(Batch, WhatIsWrongIsNamed) {
  const auto refused = [this](const std::string& table, const std::vector<std::string>& parts) {
    expect_refused(solve(sweep(), table), parts);
  };
  refused("Point Loads/weight/Force[1],Sections/strip/EI4\n1,1\n",
          {"elastica_sweep.csv:1:29: ", "EI4", "did you mean \"EI2\"?"});
  refused("Point Load/weight/Force[1]\n1\n", {"elastica_sweep.csv:1:1: ", "did you mean \"Point Loads\"?"});
  refused("Point Loads/weight/Force\n1\n", {"an array of 3 numbers"});
  refused("Point Loads/weight/Force[3]\n1\n", {"[0] to [2]"});
  refused("Sections/strip/EI2[-1]\n1\n", {"a single number"});
  refused("Point Loads/weight/Point\n1\n", {"not a number"});
  refused("Members/strip/Elements\n2.5\n", {"elastica_sweep.csv:2: case 1", "a whole number"});
  refused("Sections/strip/EI2\n1\n-1\n", {"elastica_sweep.csv:3: case 2", "value -1"});
  refused("Sections/strip/EI2\nsoft\n", {"elastica_sweep.csv:2:1: ", "soft"});
  refused("Sections/strip/EI2,Sections/strip/EI3\n1\n", {"elastica_sweep.csv:2", "1 cells; allowed: 2"});
  refused("Expected/tip turn/Value\n1\n", {"did you mean \"tip turns\"?"});
  refused("Sections/strip/EI2\n", {"no case"});
  expect_refused(solve(with_batch("")), {"neither of \"Table\" and \"Vary\""});
  const Ended misspelt = solve(with_batch("Tabel: x.csv"));
  expect_in(misspelt.err, {"did you mean \"Table\"?"});
}

}  // namespace
}  // namespace mixbeam::batch_test
