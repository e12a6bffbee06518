/// What a user can get wrong, tried on a real application: exit code 2 and a message with file, line, place in the
/// file, what was seen, what is allowed and the nearest name; 3 and the last converged state when there is no
/// equilibrium; 1 for a missed expectation. A crash fails the test.
#include "mixbeam_files.hpp"

#include <nlohmann/json.hpp>

namespace mixbeam {
namespace {

const std::string kApplication = "slope_discontinuity";

/// The application's scene with one change.
std::string scene_with(const std::string& from, const std::string& to, const std::string& after = "") {
  return changed(scene_of(kApplication), from, to, after);
}

std::string scene_with_solver(const std::string& inside) {
  return with(scene_of(kApplication), "Solver: {" + inside + "}");
}

class BadInput : public MixbeamTest {
 protected:
  Ended run(const std::vector<std::string>& arguments) {
    return run_process(program(kApplication), arguments, folder_);
  }

  Ended run_scene(const std::string& scene, std::vector<std::string> more = {}) {
    std::vector<std::string> arguments = {write_scene(scene), "--single", "--output", file("results")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run(arguments);
  }

  void expect_refused(const Ended& ended, const std::vector<std::string>& parts) {
    mixbeam::expect_refused(ended, {kApplication + ": bad input: "});
    expect_in(ended.err, parts);
  }

  void expect_scene_refused(const std::string& scene, const std::vector<std::string>& parts) {
    SCOPED_TRACE(parts.front());
    const Ended ended = run_scene(scene);
    expect_refused(ended, parts);
    expect_in(ended.err, {"scene.xml:", "XML path \""});
  }
};

TEST_F(BadInput, MisspeltNames) {
  expect_scene_refused(
      scene_with("name=\"Elements\"", "name=\"Elments\""),
      {"\"Scene / Members / first / Elments\"", "unknown name", "\"Force Integration\"", "did you mean \"Elements\"?"});
  expect_scene_refused(scene_with("name=\"Orders\"", "name=\"Odrers\""),
                       {"\"Study / Odrers\"", "did you mean \"Orders\"?"});
}

TEST_F(BadInput, StructuresThatCannotBeSolved) {
  expect_scene_refused(scene_with("{1, 0, 0}", "{0, 0, 0}"),
                       {"\"Scene / Members / first\"", "no length", "\"clamp\" (0, 0, 0)", "\"first kink\" (0, 0, 0)"});
  const std::string with_hinge = with(scene_of(kApplication), "Scene: {Supports: {clamp: {Fixed Rotation: [x, y]}}}");
  expect_scene_refused(with_hinge, {"\"Scene / Supports\"", "can move without strain in 1 way",
                                    "rotation about (0, 0, 1)", "allowed: supports that block"});
}

TEST_F(BadInput, Files) {
  const std::string missing = file("missing.xml");
  expect_refused(run({missing}), {missing + ": no such file"});
  expect_refused(run({folder_.path().string()}), {folder_.path().string() + ": is a directory"});
  write_text(folder_ / "empty.xml", "");
  expect_refused(run({file("empty.xml")}), {"empty.xml:1", "empty"});
  const std::string whole = scene_of(kApplication);
  expect_refused(run_scene(whole.substr(0, whole.size() / 2)), {"scene.xml:", "not well-formed"});
  expect_refused(run({"a.xml", "b.xml"}), {"two scene files", "\"a.xml\"", "\"b.xml\"", "allowed: one"});
}

TEST_F(BadInput, Options) {
  expect_refused(run({"--singel"}), {"\"--singel\"", "did you mean \"--single\"?", "\"--print-parameters\""});
  expect_refused(run({"-x"}), {"\"-x\"", "allowed: \"--help\""});
  expect_refused(run({"--output"}), {"--output needs a value"});
  expect_refused(run({"--output", "--single"}), {"--output needs a value", "\"--single\" follows"});
  for (const std::string threads : {"0", "-1", "two", "2x", "100000"})
    expect_refused(run({"--threads", threads}), {"--threads: value \"" + threads + "\"", "from 1 to"});
}

TEST_F(BadInput, PlacesThatCannotBeWrittenTo) {
  write_text(folder_ / "file", "");
  const std::string below_a_file = (folder_ / "file" / "below").string();
  expect_refused(run({"--output", below_a_file}), {below_a_file, "cannot be created", "Not a directory"});
  expect_refused(run({"--output", file("file")}), {file("file")});
  expect_refused(run({"--summary", folder_.path().string()}), {folder_.path().string(), "is a folder"});
  expect_refused(run({"--summary", below_a_file + "/summary.json"}), {below_a_file, "cannot be created"});
}

TEST_F(BadInput, ASummaryNeverReplacesTheScene) {
  const std::string scene = scene_of(kApplication), file = write_scene(scene);
  fs::create_hard_link(file, folder_ / "same");
  fs::create_symlink(file, folder_ / "link");
  for (const char* name : {"scene.xml", "same", "link"}) {
    expect_refused(run({file, "--single", "--summary", (folder_ / name).string(), "--output", folder_ / "results"}),
                   {name, "cannot be written: it is the input " + file});
    EXPECT_EQ(text_of(file), scene) << name;
  }
}

TEST_F(BadInput, ExpectationsThatAreNeverCompared) {
  const auto at = [](const std::string& entry) {
    return with(scene_of(kApplication), "Expected: {u1 of the tip: {" + entry + "}}");
  };
  expect_scene_refused(at("Point: tpi"),
                       {"\"Expected / u1 of the tip / Point\"", "\"tpi\" is not a point", "did you mean \"tip\"?"});
  expect_scene_refused(at("Load Factor: 1.5"),
                       {"\"Expected / u1 of the tip / Load Factor\"", "value 1.5", "allowed: at most 1"});
  expect_scene_refused(at("Load Factor: 0.3"), {"\"Expected / u1 of the tip / Load Factor\"", "value 0.3",
                                                "no load step ended there", "\"Steps\""});
  expect_scene_refused(scene_with("value=\"displacement\"", "value=\"dispalcement\""),
                       {"did you mean \"displacement\"?"});
}

TEST_F(BadInput, PathsThatStepsOfTheLoadFactorDoNotFollow) {
  for (const std::string method : {"fixed", "adaptive"})
    for (const std::string asked :
         {"Trace: true", "Branch: positive", "Control: {Point: tip, Component: z, Target: 1}"}) {
      const std::string scene =
          with(scene_with_solver("Load Path: {Method: " + method + "}"), "Analysis: {" + asked + "}");
      expect_scene_refused(scene, {"\"Analysis / " + asked.substr(0, asked.find(':')) + "\"", "\"automatic\""});
    }
}

TEST_F(BadInput, WhatNoxRefuses) {
  expect_scene_refused(scene_with_solver("Status Tests: {Test Type: NormG}"), {"\"Solver / Status Tests\"", "NormG"});
  expect_scene_refused(scene_with_solver("NOX: {Line Search: {Method: Bactrack}}"),
                       {"\"Solver / NOX / Line Search / Method\"", "did you mean \"Backtrack\"?"});
  expect_scene_refused(
      scene_with_solver("NOX: {Line Search: {Method: Polynomial}}"),
      {"\"Solver / NOX / Line Search / Method\"", "\"Rotation Limited\", \"Full Step\", \"Backtrack\""});
}

/// What is offered runs; what NOX has and this program's groups cannot serve is not offered.
TEST_F(BadInput, WhatOfNoxIsOffered) {
  const std::string search = "\"Solver / NOX / Line Search";
  expect_scene_refused(scene_with_solver("NOX: {Line Search: {Full Step: {Full Step: 0.9}}}"),
                       {search + " / Full Step\"", "unknown name"});
  expect_scene_refused(scene_with_solver("NOX: {Line Search: {Polynomial: {}}}"),
                       {search + " / Polynomial\"", "allowed", "Backtrack"});
  expect_scene_refused(scene_with_solver("NOX: {Solver Options: {Status Test Check Type: None}}"),
                       {"Status Test Check Type", "\"Complete\", \"Minimal\""});
  for (const char* method : {"Rotation Limited", "Full Step", "Backtrack"}) {
    SCOPED_TRACE(method);
    expect_in(
        expect_code(kOk, run_scene(scene_with_solver("NOX: {Line Search: {Method: " + std::string(method) + "}}"))).out,
        {"3 of 3 checks passed"});
  }
}

TEST_F(BadInput, ScenesThatAreInOrder) {  // the twin of all tests above: the unchanged scene passes
  const Ended ended = expect_code(kOk, run_scene(scene_of(kApplication)));
  EXPECT_EQ(ended.err, "");
  expect_in(ended.out, {"3 of 3 checks passed"});
  EXPECT_EQ(ended.out.find("warning"), std::string::npos);
}

TEST_F(BadInput, RemovedParametersAreWarnedOf) {
  const std::string scene =
      scene_with_solver("Newton: {Tangent Reuse: 2}, Linear Solver: {Precision: single}, Symmetric Tangent: true");
  expect_in(expect_code(kOk, run_scene(scene, {"--summary", file("summary.json")})).out,
            {"3 of 3 checks passed", "warning: " + file("scene.xml") + ":",
             "XML path \"Solver / Newton / Tangent Reuse\": this parameter was removed",
             "XML path \"Solver / Linear Solver / Precision\"", "XML path \"Solver / Symmetric Tangent\""});
  EXPECT_EQ(nlohmann::json::parse(text("summary.json")).at("warnings").size(), 3);
  expect_scene_refused(scene_with_solver("Newton: {Tangent Reus: 2}"),
                       {"\"Solver / Newton / Tangent Reus\"", "unknown name"});
}

TEST_F(BadInput, MissedExpectationsFailTheRun) {
  expect_in(expect_code(kCheckFailed, run_scene(scene_with("value=\"-1.535072\"", "value=\"-1.535082\""))).out,
            {"FAIL  u1 of the tip = -1.53507", "reference -1.535082", "from Humer", "1 FAILED"});
}

double load_factor_of_first_step(const fs::path& results) {
  return h5::number(results, "/steps/000001", "load_factor");
}

/// The first step takes 5 iterations, the second one 6 and may not be shortened: the path ends half way.
std::string scene_that_does_not_converge() {
  return scene_with_solver(
      "Newton: {Maximum Iterations: 5}, Load Path: {Method: adaptive, Initial Step: 0.1, Minimum Step: 0.1}");
}

TEST_F(BadInput, NoConvergenceLeavesTheLastConvergedState) {
  const fs::path summary = folder_ / "summary.json";
  const Ended ended =
      expect_code(kNoConvergence, run_scene(scene_that_does_not_converge(), {"--summary", summary.string()}));
  const fs::path results = folder_ / "results" / "single.h5";
  expect_in(ended.err, {"no convergence: ", "beyond load factor ", "minimum of 0.1", "What to try", "\"Minimum Step\"",
                        "\"Maximum Iterations\"", "\"Maximum Rotation\"", results.string()});
  expect_in(text_of(folder_ / "results" / "single_failure.txt"), {"beyond load factor", "What to try"});
  const auto json = nlohmann::json::parse(text_of(summary));
  EXPECT_EQ(json["all_passed"], false);
  expect_in(json["failure"].get<std::string>(), {"beyond load factor"});
  EXPECT_GT(json["newton_iterations"].get<int>(), 0);
  ASSERT_TRUE(fs::exists(results));
  EXPECT_GT(load_factor_of_first_step(results), 0.0);
  EXPECT_LT(load_factor_of_first_step(results), 1.0);
}

TEST_F(BadInput, AFailedRunDoesNotLeaveTheSummaryOfAnEarlierOne) {
  const fs::path summary = folder_ / "summary.json";
  write_text(summary, "{\"all_passed\": true}");
  expect_code(kBadInput, run_scene(scene_with("value=\"1e4\"", "value=\"abc\""), {"--summary", summary.string()}));
  EXPECT_FALSE(fs::exists(summary));
}

}  // namespace
}  // namespace mixbeam
