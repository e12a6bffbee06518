/// The program `mixbeam` as a user runs it: every subcommand, exit codes, Ctrl-C, and what is left when it is killed.
#include "discretization/results/result_lock.hpp"
#include "discretization/text/number_text.hpp"
#include "mixbeam_files.hpp"

#include <random>
#include <regex>

namespace mixbeam::mixbeam_test {
namespace {

class Mixbeam : public MixbeamTest {};

/// The fork's two stages in many steps, some of which fail and are repeated with half the size.
std::string scene_of_many_steps() {
  return with(scene_of("fork"), "Solver: {Load Path: {Initial Step: 0.05, Maximum Step: 0.05}}");
}

TEST_F(Mixbeam, RunWritesEverythingAndChecksIt) {
  expect_in(expect_code(kOk, run_scene(scene_of("fork"))).out,
            {"\"Study\" belongs to a benchmark program", "step   2", "displacement of", "reaction at", "strain energy",
             "estimated discretization error", "displacement, any vertex", "loads and reactions balance",
             "8 of 8 checks passed", "scene.h5"});
  const auto contents = contents_of(folder_ / "results/scene.h5");
  for (const char* path :
       {"scene", "version", "supports/0@point", "members/points_per_element", "steps/000002/residual_history",
        "steps/000002/reactions", "steps/000002/balance", "steps/000002/state/interior",
        "steps/000002/error_estimate@energy_error", "steps/000002/error_estimate/vertex_displacement",
        "steps/000002/error_estimate/points/P1", "monitor/moment_energy", "monitor/clamp.reaction_moment"})
    EXPECT_EQ(contents.count(path), 1u) << path;
  EXPECT_EQ(contents.count("steps/000001/error_estimate"), 0u);  // of the state at the end only
  EXPECT_EQ(complete_steps(contents), 3);
  const std::string csv = text("results/scene-monitor.csv");
  expect_in(csv, {"step,load_factor,", "P1.displacement.x", "clamp.reaction_force.z"});
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 4);  // the head and three steps
  EXPECT_NE(text("results/scene.xdmf").find("/steps/000002/position"), std::string::npos);
}

TEST_F(Mixbeam, ErrorEstimateOnRequestOnly) {
  const auto with_estimate = [](const std::string& choice) {
    return with(scene_of("fork"), "Analysis: {Error Estimate: '" + choice + "'}");
  };
  expect_code(kOk, run_scene(with_estimate("on")));
  expect_in(text("summary.json"),
            {"\"estimated_errors\"", "\"strain energy\"", "\"displacement of P1\"", "\"relative\""});
  const Ended off = expect_code(kOk, run_scene(with_estimate("off")));
  EXPECT_EQ(off.out.find("discretization error"), std::string::npos);
  EXPECT_EQ(text("summary.json").find("estimated_errors"), std::string::npos);
  EXPECT_EQ(run_scene(with_estimate("maybe")).exit_code, kBadInput);
}

TEST_F(Mixbeam, ExitCodes) {
  expect_code(kCheckFailed, run_scene(changed(scene_of("fork"), "value=\"-1.088614\"", "value=\"-1.088624\"")));
  expect_in(
      expect_code(kNoConvergence, run_scene(with(scene_of("fork"), "Solver: {Newton: {Maximum Iterations: 1}}"))).err,
      {"no convergence", "The last converged state is the last step in", "scene.h5"});
  contents_of(folder_ / "results/scene.h5");
}

constexpr const char* kRod = "Sections: {rod: {EA: 1e6, Shear Rigid: true, GIt: 1, EI2: 1, EI3: 1}}";

/// One rod of one element from a clamp to "tip", which a load acts on; `more` entries of the scene.
std::string one_element(const std::string& load, const std::string& members, const std::string& more) {
  return std::string("Analysis: {Stability: false}\nScene: {") + kRod +
         ", Members: {beam: {Start: wall, End: tip, Section: rod, Order: 1, Elements: 1}" + members +
         "}, Point Loads: {load: {Point: tip, " + load + "}}, " + more + "}\n";
}

/// A bar between two walls, pushed in the middle along its axis.
std::string pushed_bar(const std::string& stiffness) {
  return changed(one_element("Force: [1, 0, 0]", ", other: {Start: tip, End: far, Section: rod}",
                             "Points: {wall: [0, 0, 0], tip: [1, 0, 0], far: [2, 0, 0]}, "
                             "Supports: {clamp: {Point: wall}, end: {Point: far}}"),
                 "1e6", stiffness);
}

/// Rolled up by a tip moment to `share` of the angle at which the ends of its element stand at pi.
std::string rolled_up(double share) {
  return one_element("Moment: [0, 0, " + shortest(share * 2.0 * 3.14159265358979323846) + "]", "",
                     "Points: {wall: [0, 0, 0], tip: [1, 0, 0]}, Supports: {clamp: {Point: wall}}");
}

TEST_F(Mixbeam, AnElementThatReachesPiAtTheEndLeavesThePageOfAFailure) {
  EXPECT_EQ(run_scene(rolled_up(1.0 - 1e-6)).exit_code, kOk);
  EXPECT_FALSE(fs::exists(folder_ / "results/scene_failure.txt"));
  expect_in(expect_code(kNoConvergence, run_scene(rolled_up(1.0 - 1e-11))).err,
            {"no convergence", "turns by pi against its vertices", "What to try"});
  expect_in(text("results/scene_failure.txt"), {"turns by pi against its vertices", "\"Elements\""});
}

TEST_F(Mixbeam, WarnsOfForcesThatRoundingErrorsShare) {
  const Ended fine = expect_code(kOk, run_scene(pushed_bar("1e6")));
  EXPECT_EQ(fine.out.find("rounding errors"), std::string::npos) << fine.out;
  EXPECT_EQ(text("summary.json").find("rounding errors"), std::string::npos);
  expect_in(expect_code(kOk, run_scene(pushed_bar("1e15"))).out, {"warning: member", "rounding errors"});
  expect_in(text("summary.json"), {"\"warnings\"", "rounding errors"});
}

TEST_F(Mixbeam, ValuesOfALoadCaseThatNoStepComparesAreAnError) {
  const std::string text = with(text_in_repository("apps/verification/elastica.xml"),
                                "Expected: {'deflection, alpha 10': {Load Factor: 0.123}}");
  const std::string scene = write_scene(text);
  expect_refused(mixbeam({"run", scene, "--quiet", "--output", "results"}),
                 {"deflection, alpha 10", "0.123", "no load step ended there"});
  EXPECT_EQ(mixbeam({"run", scene, "--quiet", "--case", "alpha 1", "--output", "results"}).exit_code, kOk);
}

TEST_F(Mixbeam, CheckMeasuresAndSolvesNothing) {
  const Ended ended = expect_code(kOk, check_scene(scene_of("fork")));
  // 31 vertices of 6 unknowns; shaft 1 and two quarter circles of radius 1; forces of 200 in z, then -200 on top
  expect_in(ended.out,
            {"members 3, elements 30, vertices 31", "equations to solve 186", "total length 4.14159265",
             "box (0, -1, 0) to (2, 1, 0)", "stage 1: force (0, 0, 200)", "stage 2: force (0, 0, 0)", "in order"});
  EXPECT_FALSE(fs::exists(folder_ / "results"));
  expect_refused(check_scene(changed(scene_of("fork"), "name=\"EA\"", "name=\"EB\"")),
                 {"scene.xml:", "did you mean \"EA\"?"});
}

TEST_F(Mixbeam, ParametersAsTextAndMarkdown) {
  const Ended text = mixbeam({"parameters"}), markdown = mixbeam({"parameters", "--markdown"});
  EXPECT_EQ(text.exit_code, kOk);
  EXPECT_EQ(markdown.exit_code, kOk);
  expect_in(text.out, {"[Scene] required", "Maximum Iterations: int", "[Expected]"});
  expect_in(markdown.out, {"# Parameters of a scene file", "- [Scene](#scene): [Variables](#scene--variables), ",
                           "\n## Scene\n\nRequired. ", "\n### Scene / Members\n\nOptional. ",
                           "| Maximum Iterations | int", "| --- |", "\\<member>"});
}

TEST_F(Mixbeam, ThePageOfParametersIsWhatTheProgramPrints) {
  const fs::path page = fs::path(MIXBEAM_SOURCE_DIR) / "apps" / "docs" / "parameters.md";
  EXPECT_EQ(text_of(page), mixbeam({"parameters", "--markdown"}).out)
      << "to bring it up to date: mixbeam parameters --markdown > apps/docs/parameters.md";
}

TEST_F(Mixbeam, CommandLine) {
  expect_in(mixbeam({"--version"}).out, {"mixbeam "});
  expect_in(mixbeam({"--help"}).out, {"run SCENE.xml", "resume RESULTS.h5", "exit code: 0"});
  for (const char* command : {"run", "check", "parameters", "resume", "plot"})
    expect_in(mixbeam({command, "--help"}).out, {std::string("usage: mixbeam ") + command, "exit code: 0"});
  expect_in(mixbeam({"view", "results.h5", "--help"}).out, {"usage: mixbeam view"});
  const auto refused = [&](const std::vector<std::string>& arguments, const std::vector<std::string>& parts) {
    const Ended ended = expect_code(kBadInput, mixbeam(arguments));
    expect_in(ended.err, {"mixbeam: bad input: "});
    expect_in(ended.err, parts);
  };
  refused({}, {"a command is missing", "\"check\""});
  refused({"resmue"}, {"did you mean \"resume\"?"});
  refused({"beam.xml"}, {"did you mean \"mixbeam run beam.xml\"?"});
  refused({"run"}, {"a scene file is missing"});
  refused({"run", "x.xml", "--qiet"}, {"did you mean \"--quiet\"?"});
  refused({"run", write_scene(scene_of("fork")), "--case", "wind"}, {"\"wind\" is not a load case", "has none"});
  refused({"resume", file("none.h5")}, {"none.h5: no such file"});
  refused({"resume", write_scene("<a/>")}, {"scene.xml: not an HDF5 file"});
  refused({"plot"}, {"a result file is missing"});
}

/// A run of many steps and what it writes when nobody disturbs it.
class Disturbed : public Mixbeam {
 protected:
  void SetUp() override {
    scene_ = write_scene(scene_of_many_steps());
    const auto start = std::chrono::steady_clock::now();
    const Ended ended = mixbeam({"run", scene_, "--output", file("whole"), "--threads", "2"});
    milliseconds_ = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    ASSERT_EQ(ended.exit_code, kOk) << ended.err;
    whole_ = contents_of(folder_ / "whole/scene.h5");
    ASSERT_GE(complete_steps(whole_), 30);
  }

  pid_t start_run() { return start({"run", scene_, "--output", file("cut")}); }

  void expect_resumes_to_the_same_bits(const std::string& threads) {
    expect_code(kOk, mixbeam({"resume", file("cut/scene.h5"), "--threads", threads, "--quiet"}));
    EXPECT_EQ(differences(whole_, contents_of(folder_ / "cut/scene.h5")), "");
    for (const char* name : {"scene-monitor.csv", "scene.xdmf"})
      EXPECT_EQ(text_of(folder_ / "cut" / name), text_of(folder_ / "whole" / name)) << name;
    EXPECT_EQ(std::distance(fs::directory_iterator(folder_ / "cut"), fs::directory_iterator()), 3);
  }

  std::string scene_;
  double milliseconds_ = 0.0;
  FileContents whole_;
};

/// As many kills between the first and the last step as the environment variable MIXBEAM_KILLS says.
int number_of_kills() {
  const char* given = std::getenv("MIXBEAM_KILLS");
  return given == nullptr ? 8 : std::stoi(given);
}

TEST_F(Disturbed, KilledAtAnyMomentLeavesEveryCompletedStepAndResumes) {
  constexpr unsigned kSeed = 20261121;
  std::mt19937 generator(kSeed);
  std::uniform_real_distribution<double> moment(0.05, 1.0);
  const int wanted = number_of_kills();
  int kills = 0, in_the_middle = 0, without_file = 0;
  double longest_wait = milliseconds_;  // follows the speed of the machine, which other programs share
  for (const int most = 6 * wanted; in_the_middle < wanted && kills < most; ++kills) {
    const int kill_number = kills;
    SCOPED_TRACE("kill " + std::to_string(kill_number) + ", seed " + std::to_string(kSeed));
    fs::remove_all(folder_ / "cut");
    const pid_t process = start_run();
    std::this_thread::sleep_for(std::chrono::duration<double, std::milli>(moment(generator) * longest_wait));
    end(process, SIGKILL);
    if (!fs::exists(folder_ / "cut/scene.h5")) {  // killed before there was anything to keep
      ++without_file;
      longest_wait *= 1.05;
      continue;
    }
    const auto left = contents_of(folder_ / "cut/scene.h5");
    const int steps = complete_steps(left);
    ASSERT_GE(steps, 0) << "a step is incomplete";
    for (const auto& [path, bytes] : left) {
      if (path.rfind("steps/", 0) != 0) continue;
      EXPECT_TRUE(bytes == whole_.at(path)) << path << " differs";
    }
    if (steps > 0 && steps < complete_steps(whole_))
      ++in_the_middle;
    else if (steps > 0)
      longest_wait *= 0.9;  // too late
    expect_resumes_to_the_same_bits(kill_number % 2 == 0 ? "1" : "2");
    if (HasFailure()) return;
  }
  std::cout << kills << " kills, " << in_the_middle << " of them between first and last step, " << without_file
            << " before there was a file\n";
  EXPECT_GE(in_the_middle, wanted / 2) << "most kills missed the run";
}

TEST_F(Disturbed, ASecondRunIsRefusedAndTouchesNothing) {
  const pid_t first = start_run();
  wait_for_steps(folder_ / "cut/scene-monitor.csv", 2);
  ASSERT_EQ(kill(first, SIGSTOP), 0);
  const std::string result = file("cut/scene.h5"), before = text_of(result);
  const fs::path elsewhere = folder_ / "prints";
  fs::create_directory(elsewhere);
  for (const std::vector<std::string>& command :
       {std::vector<std::string>{"run", scene_, "--output", file("cut")}, {"resume", result}})
    expect_refused(run_process(program("mixbeam"), command, elsewhere),
                   {"scene.h5", "process " + std::to_string(first) + " on "});
  EXPECT_EQ(text_of(result), before);
  expect_code(kOk, end(first, SIGCONT));
  EXPECT_EQ(differences(whole_, contents_of(result)), "");
}

/// The step that a refusal of a damaged file advises; empty where it advises none.
std::string advised_step(const std::string& refusal) {
  std::smatch found;
  return std::regex_search(refusal, found, std::regex("--from (\\d+)")) ? found.str(1) : "";
}

TEST_F(Disturbed, DamagedFilesAreRefusedByNameAndGoOnFromAWholeStep) {
  const fs::path file = folder_ / "whole/scene.h5";
  const std::string whole = text_of(file);
  std::string damaged = whole;
  damaged[whole.size() * 9 / 10] ^= 1;  // among the last steps
  write_text(file, damaged);
  for (const char* command : {"verify", "resume", "plot"}) {
    expect_refused(mixbeam({command, file.string()}),
                   {"whole/scene.h5: damaged: bytes ", "; in them /steps/", "--from "});
  }
  {  // what a run that goes on rewrites looks damaged as well: who resumes it is told of the run
    const ResultLock lock(file);
    const Ended second = expect_code(kBadInput, mixbeam({"resume", file.string()}));
    expect_in(second.err, {"scene.h5", "process " + std::to_string(getpid()) + " on "});
    EXPECT_EQ(second.err.find("damaged"), std::string::npos) << second.err;
  }
  const std::string step = advised_step(mixbeam({"verify", file.string()}).err);
  EXPECT_EQ(mixbeam({"verify", file.string(), "--from", step}).exit_code, kOk);
  expect_in(expect_code(kOk, mixbeam({"resume", file.string(), "--from", step, "--quiet"})).out,
            {"Resuming after step " + step + ","});
  EXPECT_EQ(differences(whole_, contents_of(file)), "");
  EXPECT_EQ(mixbeam({"verify", file.string()}).exit_code, kOk);
  EXPECT_EQ(mixbeam({"resume", file.string(), "--from", "9999"}).exit_code, kBadInput);
}

/// The series of a run are made anew from its steps, unless the same block holds what all steps need.
TEST_F(Disturbed, DamagedTimeSeriesLoseNoStep) {
  const fs::path file = folder_ / "whole/scene.h5", table = folder_ / "whole/scene-monitor.csv";
  const std::string whole = text_of(file), rows = text_of(table);
  constexpr std::size_t kBegin = 24;  // three numbers: they follow each other nowhere else
  int made_anew = 0;
  for (const auto& [name, series] : whole_) {
    const std::size_t colon = series.find(':');
    if (name.rfind("monitor/", 0) != 0 || colon == std::string::npos) continue;
    std::string damaged = whole;
    const std::size_t place = damaged.find(series.substr(colon + 1, kBegin));
    ASSERT_NE(place, std::string::npos) << name;
    damaged[place + kBegin - 1] ^= 1;
    write_text(file, damaged);
    const Ended refused = expect_code(kBadInput, mixbeam({"resume", file.string()}));
    expect_in(refused.err, {"damaged: bytes "});
    const std::string step = advised_step(refused.err);
    if (refused.err.find("in them /monitor") == std::string::npos || step.empty()) continue;
    ++made_anew;
    expect_code(kOk, mixbeam({"resume", file.string(), "--from", step, "--quiet"}));
    EXPECT_EQ(differences(whole_, contents_of(file)), "") << name;
    EXPECT_EQ(text_of(table), rows) << name;
  }
  EXPECT_GT(made_anew, 0);
}

TEST_F(Mixbeam, LostOutputIsNoticed) {
  const std::string command = program("mixbeam").string() + " --help 2> " + file("err");
  const auto code_of = [](const std::string& shell) {
    return WEXITSTATUS(std::system(("bash -c '" + shell + "'").c_str()));
  };
  EXPECT_EQ(code_of(command + " > /dev/full"), kBadInput);
  expect_in(text("err"), {"standard output cannot be written: No space left"});
  EXPECT_EQ(code_of(command + " > >(exec true); exit $?"), kOk) << "a reader that has gone";
  EXPECT_EQ(code_of(command + " >&-"), kOk);
  EXPECT_EQ(code_of(command + " > /dev/null"), kOk);
}

TEST_F(Disturbed, CtrlCFinishesTheStepAndSaysHowToResume) {
  for (const int signal : {SIGINT, SIGTERM}) {
    fs::remove_all(folder_ / "cut");
    const pid_t process = start_run();
    wait_for_steps(folder_ / "cut/scene-monitor.csv", 3);
    const Ended ended = expect_code(kInterrupted, end(process, signal));
    expect_in(ended.err, {"once more to end at once"});
    expect_in(ended.out, {"Stopped after step", "mixbeam resume", "cut/scene.h5"});
    EXPECT_EQ(ended.out.find("FAIL"), std::string::npos) << "what was not reached is not checked";
    EXPECT_EQ(ended.out.find(": stable: "), std::string::npos) << "nor is its end";
    const auto left = contents_of(folder_ / "cut/scene.h5");
    EXPECT_GT(complete_steps(left), 2);
    EXPECT_LT(complete_steps(left), complete_steps(whole_));
    expect_resumes_to_the_same_bits("2");
  }
}

TEST_F(Disturbed, ResumingAFinishedRunChangesNothing) {
  fs::copy(folder_ / "whole", folder_ / "cut");
  expect_resumes_to_the_same_bits("1");
}

/// A cantilever from two tables, bent in a hundred steps.
std::string scene_of_tables() {
  return R"yaml(Scene:
  Sections: {rod: {EA: 50, GA2: 50, GA3: 50, GIt: 50, EI2: 50, EI3: 50}}
  Import: {Points File: points.csv, Members File: members.csv, Section: rod}
  Supports: {clamp: {Point: A}}
  Point Loads: {pull: {Point: C, Force: [0, 20, 5]}}
Solver: {Load Path: {Method: fixed, Steps: 100}}
)yaml";
}

TEST_F(Mixbeam, NoOutputReplacesAnImportedTable) {
  const std::string table = "A,0,0,0\nB,1,0,0\nC,2,0.5,0\n";
  write_text(folder_ / "members.csv", "name,start,end,elements\nm,A,B,10\nn,B,C,10\n");
  const std::string scene = write_scene(changed(scene_of_tables(), "points.csv", "scene-monitor.csv"));
  write_text(folder_ / "scene-monitor.csv", table);
  expect_refused(mixbeam({"run", scene, "--output", ".", "--quiet"}),
                 {"scene-monitor.csv: cannot be written: it is the input"});
  EXPECT_EQ(text("scene-monitor.csv"), table);
  expect_code(kOk, mixbeam({"run", scene, "--output", file("results"), "--quiet"}));
  EXPECT_EQ(text("scene-monitor.csv"), table);
}

/// The result file keeps the tables: deleted or changed, they do not matter to a run that goes on.
TEST_F(Mixbeam, ResumesWithoutTheImportedFiles) {
  const std::string scene = write_scene(scene_of_tables());
  const fs::path points = folder_ / "points.csv", members = folder_ / "members.csv", cut = folder_ / "cut";
  const auto write_tables = [&](const std::string& end) {
    write_text(points, "A,0,0,0\nB,1,0,0\nC," + end + ",0.5,0\n");
    write_text(members, "name,start,end,elements\nm,A,B,10\nn,B,C,10\n");
  };
  write_tables("2");
  ASSERT_EQ(mixbeam({"run", scene, "--output", file("whole"), "--quiet"}).exit_code, kOk);
  const auto whole = contents_of(folder_ / "whole/scene.h5");
  EXPECT_EQ(whole.count("imported/0/text") + whole.count("imported/1/text"), 2u);
  for (const bool deleted : {true, false}) {
    SCOPED_TRACE(deleted ? "deleted" : "changed");
    write_tables("2");
    fs::remove_all(cut);
    const pid_t process = start({"run", scene, "--output", cut.string()});
    wait_for_steps(cut / "scene-monitor.csv", 3);
    end(process, SIGKILL);
    const auto left = contents_of(cut / "scene.h5");
    EXPECT_GE(complete_steps(left), 2);
    EXPECT_LT(complete_steps(left), complete_steps(whole));
    write_tables("3");
    if (deleted) fs::remove(points), fs::remove(members);
    expect_code(kOk, mixbeam({"resume", (cut / "scene.h5").string(), "--quiet"}));
    EXPECT_EQ(differences(whole, contents_of(cut / "scene.h5")), "");
    const Ended again = mixbeam({"run", scene, "--output", file("other"), "--quiet"});  // it does need them
    EXPECT_EQ(again.exit_code, deleted ? kBadInput : kOk) << again.err;
  }
  EXPECT_NE(differences(whole, contents_of(folder_ / "other/scene.h5")), "");  // the change does matter to a run
}

/// A path through limit points goes on with the same bits, and values at critical points before the stop are compared.
TEST_F(Mixbeam, ResumesAPathThroughLimitPoints) {
  const std::string scene = write_scene(text_in_repository("apps/verification/lee_frame.xml"));
  const fs::path cut = folder_ / "cut";
  expect_in(expect_code(kOk, mixbeam({"run", scene, "--output", file("whole")})).out,
            {"critical point 2: limit point at load factor 0.618557"});
  const auto whole = contents_of(folder_ / "whole/scene.h5");
  for (const int steps : {3, 8}) {
    SCOPED_TRACE("killed behind step " + std::to_string(steps));
    fs::remove_all(cut);
    const pid_t process = start({"run", scene, "--output", cut.string()});
    wait_for_steps(cut / "scene-monitor.csv", steps + 1);
    end(process, SIGKILL);
    expect_in(expect_code(kOk, mixbeam({"resume", (cut / "scene.h5").string()})).out,
              {"critical point 1: bifurcation", "collapse: bifurcation at load factor 0.61", "8 of 8 checks passed"});
    EXPECT_EQ(differences(whole, contents_of(cut / "scene.h5")), "");
  }
}

TEST_F(Mixbeam, CriticalPointsThatAreExpectedMustBeThere) {
  const std::string frame = text_in_repository("apps/verification/lee_frame.xml");
  const std::string missed = with(frame, "Expected: {'load, first limit point': {Critical Point: 7}}");
  expect_in(expect_code(kCheckFailed, run_scene(missed, {"--quiet"})).out,
            {"FAIL", "critical point 7 did not come; critical points on the path: 3", "FAILED"});
  expect_in(text("summary.json"), {"\"pass\": false", "critical point 7 did not come", "\"all_passed\": false"});
  expect_refused(check_scene(with(frame, "Analysis: {Stability: false}")), {"Critical Point", "\"Stability\" = false"});
}

/// A column of length one and EI = 1, its foot clamped, under the axial load P; P_cr = pi^2 / 4.
std::string column(const std::string& load, const std::string& lists = "") {
  return R"yaml(Scene:
  Sections: {rod: {EA: 1e6, Shear Rigid: true, GIt: 1, EI2: 2, EI3: 1}}
  Points: {foot: [0, 0, 0], tip: [1, 0, 0]}
  Members: {rod: {Start: foot, End: tip, Section: rod, Order: 5, Elements: 4}}
  Supports: {foot: {Point: foot}}
  Point Loads: {weight: {Point: tip, Force: [-)yaml" +
         load + ", 0, 0]}}\n" + lists;
}

std::string expecting_stable(const std::string& value) {
  return "Expected: {end: {Quantity: stable, Value: " + value + ", Source: Euler}}\n";
}

std::string last_line(const std::string& text) {
  const std::size_t end = text.find_last_not_of('\n'), begin = text.rfind('\n', end);
  return text.substr(begin + 1, end - begin);
}

/// Euler: the straight column is stable up to pi^2 / 4 = 2.467.
TEST_F(Mixbeam, TheLastWordIsWhetherTheEndIsStable) {
  const auto end_under = [&](const std::string& load, const std::string& lists = "") {
    return run_scene(column(load, lists), {"--quiet"});
  };
  const Ended below = expect_code(kOk, end_under("2.4", expecting_stable("true")));
  EXPECT_EQ(last_line(below.out), "scene: stable: true");
  expect_in(text("summary.json"), {"\"stable\": \"true\""});
  EXPECT_EQ(text("summary.json").find("warnings"), std::string::npos);
  expect_in(last_line(text("results/scene-monitor.csv")), {",true"});

  const Ended above = expect_code(kOk, end_under("2.5"));
  EXPECT_EQ(last_line(above.out), "scene: stable: false (1 negative eigenvalue): a real structure does not stay there");
  expect_in(above.out, {"checks passed, 1 warning."});
  expect_in(text("summary.json"), {"\"stable\": \"false\"", "\"warnings\"", "a real structure does not stay there"});
  const std::string monitor = text("results/scene-monitor.csv");
  expect_in(monitor.substr(0, monitor.find('\n')), {",stable"});
  expect_in(last_line(monitor), {",false"});
  EXPECT_NE(contents_of(folder_ / "results/scene.h5").at("steps/000001@stable").find("false"), std::string::npos);

  const Ended blind = end_under("2.5", "Analysis: {Stability: false}");
  expect_in(last_line(blind.out), {"scene: stable: unknown"});
  EXPECT_EQ(text("summary.json").find("warnings"), std::string::npos);
}

/// Coordinates of 1e8 have 1e-8 of the length left.
TEST_F(Mixbeam, StructuresFarFromTheOriginBalance) {
  const auto bent_at = [&](const std::string& start, const std::string& end) {
    std::string text = changed(column("1", ""), "[1, 0, 0]", end);
    text = changed(changed(text, "[0, 0, 0]", start), "[-1, 0, 0]", "[0.1, 0.3, 0.2]");
    return run_scene(text, {"--quiet"});
  };
  expect_code(kOk, bent_at("[1e8, 2e8, 1e8]", "[100000000.6, 200000000.48, 100000000.64]"));
  const Ended near = bent_at("[0, 0, 0]", "[0.6, 0.48, 0.64]");
  expect_in(near.out, {"allowed 1e-10"});
}

/// A slanted bar is stretched along itself: no moment is at work but those that its forces have about its middle, and
/// the rows of 3000 elements leave 1e-8 of the little that rounding leaves of its bending moments.
TEST_F(Mixbeam, ABarThatIsOnlyStretchedBalances) {
  const auto stretched = [&](const std::string& lists) {
    std::string text = changed(column("1", lists), "[1, 0, 0]", "[0.6, 0.48, 0.64]");
    text = changed(text, "[-1, 0, 0]", "[0.6, 0.48, 0.64]");
    text = changed(text, "Order: 5", "Order: 1");
    return run_scene(changed(text, "Elements: 4", "Elements: 3000"), {"--quiet"});
  };
  expect_in(expect_code(kOk, stretched("")).out, {"loads and reactions balance: "});
  // the twin: the undeformed bar is taken for the equilibrium (by fixed steps, which do not start from a prediction)
  expect_in(
      expect_code(kCheckFailed,
                  stretched("Solver: {Load Path: {Method: fixed}, Status Tests: {Test Type: NormF, Tolerance: 2.0}}"))
          .out,
      {"DO NOT BALANCE: forces 1.0e+00"});
}

/// Coordinates of 1e8 have eight digits of a length of one, those of 1e6 ten.
TEST_F(Mixbeam, WarnsOfAnOriginFarAway) {
  const auto checked = [this](const std::string& place) {
    return check_scene(R"(Scene:
  Sections: {rod: {EA: 1e4, GA2: 1e3, GA3: 1e3, GIt: 1, EI2: 1, EI3: 1}}
  Points: {foot: [)" + place +
                       R"(, 0, 0], head: [)" + place + R"(, 0, 1]}
  Members: {rod: {Start: foot, End: head, Section: rod, Order: 3, Elements: 3}}
  Supports: {foot: {Point: foot}}
  Point Loads: {p: {Point: head, Force: [1, 0, 0]}}
)");
  };
  expect_in(checked("1e8").out, {"coordinates up to 1e+08 are rounded to about 2.2e-08 of the size of the structure"});
  EXPECT_EQ(checked("1e6").out.find("are rounded to about"), std::string::npos);
}

TEST_F(Mixbeam, StableMayBeExpected) {
  const auto code_of = [&](const std::string& load, const std::string& value) {
    return run_scene(column(load, expecting_stable(value)), {"--quiet"}).exit_code;
  };
  EXPECT_EQ(code_of("2.5", "\"false\""), kOk);
  EXPECT_EQ(code_of("2.5", "false"), kOk);
  EXPECT_EQ(code_of("2.5", "true"), kCheckFailed);
  EXPECT_EQ(code_of("2.4", "unknown"), kCheckFailed);
  EXPECT_EQ(code_of("2.4", "maybe"), kBadInput);
}

/// A value that was compared when the file was written is compared again from it, without solving anything.
TEST_F(Mixbeam, ResumingAtTheEndTellsTheSame) {
  const Ended first = run_scene(column("2.5", expecting_stable("false")), {"--quiet"});
  const Ended again = expect_code(kOk, mixbeam({"resume", "results/scene.h5", "--quiet", "--summary", "again.json"}));
  EXPECT_EQ(last_line(again.out), last_line(first.out));
  expect_in(text("again.json"), {"\"load_factor\": 1.0"});
}

/// Members whose elements or chains take longer, and why; plain ones under dead loads are not among them.
TEST_F(Mixbeam, CheckNamesMembersOffTheFastPath) {
  const Ended ended = expect_code(kOk, check_scene(R"(
Scene:
  Sections:
    even: {EA: 1e4, GA2: 5e3, GA3: 5e3, GIt: 1, EI2: 1, EI3: 1}
    coupled: {Matrix: [1e4,0,0,0,1,0, 0,5e3,0,0,0,0, 0,0,5e3,0,0,0, 0,0,0,1,0,0, 1,0,0,0,1,0, 0,0,0,0,0,1]}
  Points: {a: [0, 0, 0], b: [1, 0, 0], c: [2, 0, 0], d: [3, 0, 0], e: [4, 0, 0]}
  Members:
    plain: {Start: a, End: b, Section: even, Order: 2, Elements: 2, Inner Points: {inside: 0.5}}
    tapered: {Start: b, End: c, Section: even, End Section: even, Order: 2, Elements: 2}
    matrix: {Start: c, End: d, Section: coupled, Order: 2, Elements: 2}
    pushed: {Start: d, End: e, Section: even, Order: 2, Elements: 2, Inner Points: {middle: 0.5}}
  Supports: {clamp: {Point: a}}
  Distributed Loads:
    weight: {Member: plain, Force: [0, 0, -1]}
    wind: {Member: pushed, Frame: follower, Force: [0, 1, 0]}
  Point Loads:
    dead: {Point: inside, Force: [0, 0, 1]}
    couple: {Point: middle, Moment: [0, 0, 1]}
)"));
  expect_in(ended.out,
            {"off the fast path by a taper: \"tapered\"\n", "by a 6 x 6 matrix: \"matrix\"\n",
             "by line loads without potential: \"pushed\"\n", "by moments or followers at inner points: \"pushed\"\n"});
  EXPECT_EQ(check_scene(scene_of("fork")).out.find("fast path"), std::string::npos);
}

/// An axial load does not move the tip sideways at first; along the axis, or with a lateral force, it does.
TEST_F(Mixbeam, CheckTellsOfAControlledDisplacementThatTheLoadDoesNotMove) {
  const auto checked = [&](const std::string& component, const std::string& force = "[-1, 0, 0]") {
    const std::string control = "Analysis: {Control: {Point: tip, Component: " + component + ", Target: -0.1}}\n";
    return check_scene(changed(column("1", control), "[-1, 0, 0]", force));
  };
  expect_in(expect_code(kOk, checked("y")).out,
            {"does not move point \"tip\" along y at first", "\"Branch\"", "small load along y"});
  EXPECT_EQ(checked("x").out.find("warning"), std::string::npos);
  EXPECT_EQ(checked("y", "[-1, 1e-3, 0]").out.find("warning"), std::string::npos);
}

/// Without loads nothing moves, and errors are rounding: none is relative, none is warned of.
TEST_F(Mixbeam, ErrorsOfAStructureWithoutLoadsAreNotRelative) {
  const std::string bow = "  Imperfection: {Bows: {bow: {Member: rod, Share: 0.01, Direction: [0, 1, 0.5]}}}\n";
  const auto out = [&](const std::string& load) { return run_scene(column(load, bow)).out; };
  const std::string bare = out("0");
  expect_in(bare, {"displacement, any vertex", "        -\n"});
  EXPECT_EQ(bare.find("1.0e+00"), std::string::npos) << bare;
  EXPECT_EQ(bare.find("estimated error of displacements is"), std::string::npos) << bare;
  const std::string loaded = out("1");  // the twin
  const std::size_t line = loaded.find("displacement, any vertex");
  ASSERT_NE(line, std::string::npos);
  EXPECT_NE(loaded.substr(line, loaded.find('\n', line) - line).back(), '-') << loaded;
}

/// Nothing grows with the load factor, which is the unknown of a controlled displacement.
TEST_F(Mixbeam, AControlledDisplacementNeedsALoad) {
  const std::string loaded = column("1", "Analysis: {Control: {Point: tip, Component: x, Target: -0.1}}\n");
  const std::string bare = changed(loaded, "  Point Loads: {weight: {Point: tip, Force: [-1, 0, 0]}}\n", "");
  for (const std::string command : {"check", "run"}) {
    expect_refused(mixbeam({command, write_scene(bare)}),
                   {"\"Analysis / Control\": given, but nothing acts", "Prescribed Displacement"});
  }
  EXPECT_EQ(check_scene(loaded).exit_code, kOk);
}

/// A strip of length one whose hinged ends are pushed past each other bends into a loop: 29.38 EI at the end, by
/// elliptic integrals. It used to end straight and turned inside out, in one step that was stable by its numbers.
TEST_F(Mixbeam, EndsThatArePushedPastEachOtherBendTheMember) {
  const std::string scene = R"yaml(Scene:
  Sections: {rod: {EA: 1e8, Shear Rigid: true, GIt: 1, EI2: 1, EI3: 5}}
  Points: {a: [0, 0, 0], b: [0, 0, 1]}
  Members: {rod: {Start: a, End: b, Order: 5, Elements: 8, Second Axis: [0, 1, 0]}}
  Supports:
    a: {Point: a, Fixed Rotation: [x, z]}
    b: {Point: b, Fixed Rotation: [x, z], Prescribed Displacement: [0, 0, -1.2]}
Analysis: {Branch: positive}
Expected: {push: {Quantity: reaction force, Point: b, Component: z, Value: -VALUE, Relative Tolerance: 1e-5, Source: elastica}}
)yaml";
  EXPECT_EQ(run_scene(changed(scene, "VALUE", "29.38259871")).exit_code, kOk);
  EXPECT_EQ(run_scene(changed(scene, "VALUE", "1.2e8")).exit_code, kCheckFailed);
}

/// What a support fixes cannot grow to a target.
TEST_F(Mixbeam, AControlledDisplacementIsFree) {
  const auto controlled = [&](const std::string& point, const std::string& component) {
    return check_scene(
        column("1", "Analysis: {Control: {Point: " + point + ", Component: " + component + ", Target: -0.1}}\n"));
  };
  expect_refused(controlled("foot", "x"),
                 {"\"Analysis / Control / Component\": value \"x\", but a support fixes it at \"foot\""});
  EXPECT_EQ(controlled("tip", "x").exit_code, kOk);  // the twin
}

/// A load factor at which no step will end is told before anything is solved, by `check` as by `run`.
TEST_F(Mixbeam, LoadFactorsWhereNoStepEndsAreRefusedBeforeTheRun) {
  const auto asked_at = [&](const std::string& load_factor, const std::string& lists = "") {
    return write_scene(
        column("2.4", changed(expecting_stable("true"), "Value", "Load Factor: " + load_factor + ", Value")) + lists);
  };
  const std::string fixed = "Solver: {Load Path: {Method: fixed, Steps: 4}}\n";
  for (const char* command : {"check", "run"}) {
    std::vector<std::string> arguments = {command, asked_at("0.5")};
    if (std::string(command) == "run") arguments.insert(arguments.end(), {"--output", "results"});
    expect_refused(mixbeam(arguments),
                   {"\"Expected / end / Load Factor\"", "value 0.5", "no load step ended there", "\"Steps\""});
    EXPECT_FALSE(fs::exists(folder_ / "results/scene.h5"));
  }
  const std::string quarters = "Solver: {Load Path: {Maximum Step: 0.25}}\n";
  EXPECT_EQ(mixbeam({"check", asked_at("1")}).exit_code, kOk);
  EXPECT_EQ(mixbeam({"check", asked_at("0.5", quarters)}).exit_code, kOk);
  EXPECT_EQ(mixbeam({"check", asked_at("0.6", quarters)}).exit_code, kBadInput);
  EXPECT_EQ(mixbeam({"check", asked_at("0.6", fixed)}).exit_code, kBadInput);
  EXPECT_EQ(mixbeam({"check", asked_at("0.5", fixed)}).exit_code, kOk);
  EXPECT_EQ(mixbeam({"run", asked_at("0.5", fixed), "--quiet", "--output", "results"}).exit_code, kOk);
}

TEST_F(Mixbeam, RefusesToResumeWhatRemembersMore) {
  expect_code(kOk, run_scene(with(scene_of("fork"), "Solver: {LOCA: {Predictor: {Method: Secant}}}")));
  expect_refused(mixbeam({"resume", "results/scene.h5"}),
                 {"cannot be resumed", "extrapolates from steps before the last one"});
}

}  // namespace
}  // namespace mixbeam::mixbeam_test
