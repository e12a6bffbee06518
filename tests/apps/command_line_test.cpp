/// The command line that all applications share, and what a script reads of a run.
#include "apps/common/session/command_line.hpp"

#include "discretization/text/errors.hpp"
#include "process.hpp"

#include <nlohmann/json.hpp>

namespace mixbeam {
namespace {

const std::vector<std::string> kApplications = {"rollup",      "superimposed_rotation", "arc_segment", "helix",
                                                "helical_rod", "slope_discontinuity",   "fork",        "extremes",
                                                "trade"};

CommandLine line_of(std::vector<const char*> words) {
  words.insert(words.begin(), "program");
  return read_command_line(static_cast<int>(words.size()), words.data());
}

TEST(CommandLine, ReadsWhatItSays) {
  const CommandLine empty = line_of({});
  EXPECT_FALSE(empty.scene_file || empty.output || empty.summary || empty.threads || empty.single || empty.quiet);
  const CommandLine line =
      line_of({"--quiet", "scene.xml", "--single", "--threads", "3", "--output", "here", "--summary", "s.json"});
  EXPECT_TRUE(line.single && line.quiet);
  EXPECT_EQ(line.scene_file, "scene.xml");
  EXPECT_EQ(line.threads, 3);
  EXPECT_EQ(line.output, "here");
  EXPECT_EQ(line.summary, "s.json");
  EXPECT_TRUE(line_of({"-h"}).help);
}

TEST(CommandLine, RefusesTheRest) {
  EXPECT_THROW(line_of({"--threads", "1.5"}), InputError);
  EXPECT_THROW(line_of({"--threads"}), InputError);
  EXPECT_THROW(line_of({"--output", ""}), InputError);
  EXPECT_THROW(line_of({""}), InputError);
  EXPECT_THROW(line_of({"--Single2"}), InputError);
  EXPECT_THROW(line_of({"a.xml", "b.xml"}), InputError);
}

class Programs : public ::testing::Test {
 protected:
  TemporaryFolder folder_;
};

TEST_F(Programs, Help) {
  for (const std::string& application : kApplications) {
    SCOPED_TRACE(application);
    const Ended ended = expect_code(kOk, run_process(program(application), {"--help"}, folder_));
    EXPECT_EQ(ended.err, "");
    expect_in(ended.out, {application + ": ", "usage: ", "--single", "--output", "--summary", "--threads", "--quiet",
                          "--print-parameters", "exit code: 0 ", "mpirun"});
  }
}

TEST_F(Programs, PrintTheirParameters) {
  for (const std::string& application : kApplications) {
    SCOPED_TRACE(application);
    expect_in(expect_code(kOk, run_process(program(application), {"--print-parameters"}, folder_)).out,
              {"[Scene] required",
               "[Sections]",
               "[Points]",
               "[Members]",
               "[Curve]",
               "[Supports]",
               "[Point Loads]",
               "[Distributed Loads]",
               "[Solver]",
               "[Load Path]",
               "[Newton]",
               "[Linear Solver]",
               "[NOX] optional",
               "[Status Tests] optional",
               "[LOCA] optional",
               "[Study]",
               "[Expected]",
               "Maximum Iterations: int",
               "Load Factor: double",
               "Source: string",
               "Stage: int"});
  }
}

TEST_F(Programs, StudyParametersAreInTheManual) {
  const Ended ended = run_process(program("fork"), {"--print-parameters"}, folder_);
  expect_in(ended.out,
            {"Orders: Array(int), 1 <= value <= 8; default {1, 2, 3, 4}", "Elements per Member", "Most Iterations"});
}

nlohmann::json summary_of(const std::vector<std::string>& options, const TemporaryFolder& folder) {
  std::vector<std::string> arguments = {"--single", "--output", (folder / "results").string(), "--summary",
                                        (folder / "new folder" / "summary.json").string()};
  arguments.insert(arguments.end(), options.begin(), options.end());
  expect_code(kOk, run_process(program("fork"), arguments, folder));
  return nlohmann::json::parse(text_of(folder / "new folder" / "summary.json"));
}

TEST_F(Programs, SummaryHoldsWhatAScriptWants) {
  const auto json = summary_of({"--threads", "1"}, folder_);
  EXPECT_EQ(json["program"], "fork");
  EXPECT_FALSE(json["version"].get<std::string>().empty());
  EXPECT_FALSE(json["compiler"].get<std::string>().empty());
  EXPECT_EQ(json["threads"], 1);
  EXPECT_EQ(json["ranks"], 1);
  EXPECT_EQ(json["load_steps"], 2);
  EXPECT_GT(json["newton_iterations"].get<int>(), 2);
  EXPECT_LE(json["newton_iterations"].get<int>(), 24);  // both stages, one load step each
  EXPECT_EQ(json["all_passed"], true);
  for (const char* phase : {"total", "residual", "element tangent", "solve"})
    EXPECT_GT(json["seconds"].at(phase).get<double>(), 0.0) << phase;
  ASSERT_EQ(json["checks"].size(), 6U);  // both configurations: expected values at load factor 1 and 2
  for (const auto& check : json["checks"]) {
    EXPECT_TRUE(check["pass"].get<bool>());
    EXPECT_TRUE(check["value"].is_number() && check["reference"].is_number() && check["tolerance"].is_number());
    EXPECT_NE(check["value"], check["reference"]);  // the paper's digits, not our own
    expect_in(check["source"].get<std::string>(), {"Humer, Steinbrecher, Pechstein"});
  }
}

TEST_F(Programs, QuietMeansNoProgress) {
  const std::vector<std::string> options = {"--single", "--output", (folder_ / "results").string()};
  expect_in(run_process(program("fork"), options, folder_).out, {"fork single: step   2", "load factor", "elapsed"});
  std::vector<std::string> quiet = options;
  quiet.push_back("--quiet");
  const std::string out = run_process(program("fork"), quiet, folder_).out;
  EXPECT_EQ(out.find("step"), out.find("steps,")) << out;  // only in the closing line
}

/// A state that is not a number must not pass for a solution: here the force is so large that its squares overflow.
TEST_F(Programs, WhatIsNotANumberIsNoSolution) {
  const std::string scene = changed(scene_of("slope_discontinuity"), "{-10, 0, -10}", "{-1e308, 0, -1e308}");
  write_text(folder_ / "scene.xml", scene);
  expect_in(expect_code(kNoConvergence, run_process(program("slope_discontinuity"),
                                                    {(folder_ / "scene.xml").string(), "--single", "--output",
                                                     (folder_ / "results").string()},
                                                    folder_))
                .err,
            {"no convergence", "does not solve the equations", "allowed 1e-08"});
}

}  // namespace
}  // namespace mixbeam
