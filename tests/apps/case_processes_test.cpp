/// Load cases side by side (run --jobs): as if one after another, whatever happens to the processes.
#include "mixbeam_files.hpp"

#include <nlohmann/json.hpp>

namespace mixbeam::case_processes_test {
namespace {

const std::vector<std::string> kCases = {"down", "side", "both"};

/// A cantilever under two loads and their combination. Some warnings, some checks, of which one fails.
std::string scene_of(int steps, const std::string& side = "[0, 2, 0]") {
  return R"yaml(Scene:
  Load Cases: [down, side]
  Combinations: {both: {down: 1, side: -0.5}}
  Points: {root: [0, 0, 0], tip: [1, 0, 0]}
  Sections: {round: {EA: 1e4, GA2: 1e4, GA3: 1e4, GIt: 1, EI2: 1, EI3: 1, Largest Strain: 1e-6}}
  Members: {rod: {Start: root, End: tip, Order: 3, Elements: 8}}
  Supports: {wall: {Point: root}}
  Point Loads:
    down: {Point: tip, Force: [0, 0, -1], Case: down}
    side: {Point: tip, Case: side, Force: )yaml" +
         side + R"yaml(}
Quantities: {sag: {Quantity: displacement, Point: tip}}
Expected:
  down: {Quantity: sag.z, Case: down, Value: -0.3, Absolute Tolerance: 1e-2, Source: a guess}
  side: {Quantity: sag.z, Case: side, Value: 1, Absolute Tolerance: 1e-2, Source: a guess}
Solver: {Load Path: {Method: fixed, Steps: )yaml" +
         std::to_string(steps) + "}}\n";
}

/// Without what tells of time and folder.
std::string without_times(const std::string& prints, const std::string& folder) {
  std::istringstream lines(prints);
  std::string kept;
  for (std::string line; std::getline(lines, line);) {
    line = line.substr(0, line.find("  elapsed"));
    if (line.rfind("mixbeam: ", 0) == 0) line = line.substr(0, line.find("iterations"));
    for (std::size_t place; (place = line.find(folder + "/")) != std::string::npos;) line.erase(place, folder.size());
    kept += line + "\n";
  }
  return kept;
}

nlohmann::json summary_without_times(const fs::path& file) {
  auto json = nlohmann::json::parse(text_of(file));
  for (const char* of_this_run : {"seconds", "threads"}) json.erase(of_this_run);
  return json;
}

class SideBySide : public MixbeamTest {
 protected:
  std::vector<std::string> words(const std::string& folder, int jobs) {
    return {"run", "scene.yaml", "--output", folder, "--jobs", std::to_string(jobs), "--summary", folder + ".json"};
  }
  Ended run(const std::string& folder, int jobs) { return mixbeam(words(folder, jobs)); }
  /// Empty where all files of two folders say the same.
  std::string differences_of(const std::string& a, const std::string& b) {
    std::string text;
    for (const auto& entry : fs::directory_iterator(folder_ / a)) {
      const fs::path other = folder_ / b / entry.path().filename();
      const bool is_table = entry.path().extension() == ".h5";
      const auto mine = is_table ? contents_of(entry.path()) : FileContents{{"text", text_of(entry.path())}};
      const auto theirs = is_table ? contents_of(other) : FileContents{{"text", text_of(other)}};
      if (!differences(mine, theirs).empty()) text += other.string() + "\n";
    }
    return text;
  }
  /// Starts a run of two processes at once and waits until both are in the middle of a case.
  pid_t start_in_the_middle() {
    write_text(folder_ / "scene.yaml", scene_of(2000));
    const pid_t process = start(words("cut", 2));
    const auto started = [this](const std::string& load_case) {
      const std::string rows = text_of(folder_ / "cut" / ("scene-" + load_case + "-monitor.csv"));
      return std::count(rows.begin(), rows.end(), '\n') > 3;
    };
    for (int i = 0; i < 5000 && !(started("down") && started("side")); ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    EXPECT_TRUE(started("down") && started("side"));
    return process;
  }
  void expect_whole_in_the_middle(const std::string& load_case) {
    const auto left = contents_of(folder_ / "cut" / ("scene-" + load_case + ".h5"));
    EXPECT_GT(complete_steps(left), 2);
    EXPECT_LT(complete_steps(left), 2000);
  }
};

std::vector<pid_t> children_of(pid_t process) {
  const std::string number = std::to_string(process);
  std::istringstream words(text_of("/proc/" + number + "/task/" + number + "/children"));
  std::vector<pid_t> found;
  for (pid_t child = 0; words >> child;) found.push_back(child);
  return found;
}

/// Within two seconds.
bool end_soon(const std::vector<pid_t>& processes) {
  const auto is_gone = [](pid_t process) {
    const std::string state = text_of("/proc/" + std::to_string(process) + "/stat");
    return state.empty() || state.find(") Z ") != std::string::npos;
  };
  for (int i = 0; i < 200; ++i, std::this_thread::sleep_for(std::chrono::milliseconds(10)))
    if (std::all_of(processes.begin(), processes.end(), is_gone)) return true;
  return false;
}

TEST_F(SideBySide, FilesPrintsSummaryAndCodeAreThoseOfOneAfterAnother) {
  write_text(folder_ / "scene.yaml", scene_of(5));
  const Ended in_turn = expect_code(kCheckFailed, run("turn", 1));
  expect_in(in_turn.out, {"warning: ", "7 of 8 checks passed, 1 FAILED", "envelope of the ends"});
  for (const int jobs : {2, 3, 7}) {
    const std::string folder = "jobs" + std::to_string(jobs);
    const Ended ended = run(folder, jobs);
    EXPECT_EQ(ended.exit_code, in_turn.exit_code) << ended.err;
    EXPECT_EQ(without_times(ended.out, folder), without_times(in_turn.out, "turn"));
    EXPECT_EQ(summary_without_times(folder_ / (folder + ".json")), summary_without_times(folder_ / "turn.json"));
    EXPECT_EQ(differences_of("turn", folder), "");
    EXPECT_EQ(differences_of(folder, "turn"), "");
  }
  write_text(folder_ / "scene.yaml", scene_of(5, "[0, 2.0000001, 0]"));
  run("other", 2);
  EXPECT_NE(differences_of("turn", "other"), "") << "the twin";
  EXPECT_NE(summary_without_times(folder_ / "other.json"), summary_without_times(folder_ / "turn.json"));
}

TEST_F(SideBySide, AFailureIsToldAsOneAfterAnother) {
  write_text(folder_ / "scene.yaml", scene_of(2, "[0, 1e200, 0]"));
  const Ended in_turn = run("turn", 1), ended = run("jobs", 2);
  EXPECT_EQ(in_turn.exit_code, kNoConvergence);
  EXPECT_EQ(ended.exit_code, kNoConvergence);
  EXPECT_EQ(without_times(ended.err, "jobs"), without_times(in_turn.err, "turn"));
  expect_in(ended.out, {"scene-down: 2 steps"});
  EXPECT_EQ(summary_without_times(folder_ / "jobs.json")["all_passed"], false);
  expect_in(text("jobs.json"), {"\"failure\": \"scene-side: no equilibrium"});
  EXPECT_FALSE(fs::exists(folder_ / "jobs/scene-envelope.csv"));
}

TEST_F(SideBySide, CtrlCStopsEveryCaseBehindAWholeStep) {
  for (const int signal : {SIGINT, SIGTERM}) {
    fs::remove_all(folder_ / "cut");
    const pid_t process = start_in_the_middle();
    const std::vector<pid_t> children = children_of(process);
    EXPECT_EQ(children.size(), 2u);
    const auto start = std::chrono::steady_clock::now();
    kill(process, signal);
    const Ended ended = expect_code(kInterrupted, end_of(process, folder_.path()));
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(3));
    EXPECT_TRUE(end_soon(children));
    expect_in(ended.out, {"mixbeam resume cut/scene-down.h5", "mixbeam resume cut/scene-side.h5"});
    for (const char* load_case : {"down", "side"}) expect_whole_in_the_middle(load_case);
    EXPECT_FALSE(fs::exists(folder_ / "cut/scene-both.h5"));
  }
}

TEST_F(SideBySide, KilledProcessesAreNamedAndLeaveWholeFiles) {
  const pid_t process = start_in_the_middle();
  const std::vector<pid_t> children = children_of(process);
  ASSERT_EQ(children.size(), 2u);
  kill(children[1], SIGKILL);
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  kill(process, SIGINT);  // who waits for the other case ends too
  expect_in(expect_code(kCheckFailed, end_of(process, folder_.path())).err, {"case \"side\"", "Killed"});
  for (const char* load_case : {"down", "side"}) expect_whole_in_the_middle(load_case);
}

TEST_F(SideBySide, NoProcessOutlivesTheProgram) {
  const pid_t process = start_in_the_middle();
  const std::vector<pid_t> children = children_of(process);
  ASSERT_EQ(children.size(), 2u);
  kill(process, SIGKILL);
  end_of(process, folder_.path());
  EXPECT_TRUE(end_soon(children));
  for (const char* load_case : {"down", "side"}) expect_whole_in_the_middle(load_case);
}

TEST_F(SideBySide, IsRefusedAsAWhole) {
  write_text(folder_ / "scene.yaml", scene_of(2000));
  const pid_t other = start({"run", "scene.yaml", "--case", "both", "--output", "cut", "--quiet"});
  while (!fs::exists(folder_ / "cut/scene-both.h5")) std::this_thread::sleep_for(std::chrono::milliseconds(2));
  kill(other, SIGSTOP);
  fs::create_directory(folder_ / "prints");
  expect_refused(run_process(program("mixbeam"), {"run", "../scene.yaml", "--output", file("cut"), "--jobs", "3"},
                             folder_ / "prints"),
                 {"scene-both.h5", "process " + std::to_string(other) + " on "});
  for (const char* load_case : {"down", "side"})
    EXPECT_FALSE(fs::exists(folder_ / "cut" / (std::string("scene-") + load_case + ".h5")));
  kill(other, SIGKILL);
  end_of(other, folder_.path());
}

TEST_F(SideBySide, NeedTheMemoryOfAllThatRunAtOnce) {
  write_text(folder_ / "scene.yaml", changed(scene_of(1), "Elements: 8", "Elements: 300000"));  // 2 GB each
  const auto in_limit = [this](const std::string& command) {
    return run_process("/bin/bash", {"-c", "ulimit -v 5000000; exec \"$0\" " + command, program("mixbeam").string()},
                       folder_.path());
  };
  expect_refused(in_limit("run scene.yaml --output out --jobs 3"),
                 {"of memory for 3 cases side by side (--jobs)", "fewer cases"});
  EXPECT_TRUE(fs::is_empty(folder_ / "out"));
  EXPECT_EQ(in_limit("check scene.yaml").exit_code, kOk) << "one fits";
}

TEST_F(SideBySide, BadOptionsAreNamed) {
  write_text(folder_ / "scene.yaml", scene_of(1));
  for (const int jobs : {0, 1025}) {
    expect_refused(run("out", jobs), {"option --jobs: value \"" + std::to_string(jobs) + "\"", "from 1 to 1024"});
  }
  expect_refused(
      run_process("/usr/bin/env",
                  {"OMPI_COMM_WORLD_SIZE=1", program("mixbeam").string(), "run", "scene.yaml", "--jobs", "2"},
                  folder_.path()),
      {"option --jobs: value \"2\" under mpirun", "allowed: 1"});
}

}  // namespace
}  // namespace mixbeam::case_processes_test
