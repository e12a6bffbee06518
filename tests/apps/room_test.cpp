// What a run takes of the machine is known before, threads that wait leave their cores to others, signals end a run in
// time, and what is unusual is said.
#include "mixbeam_files.hpp"
#include "tests/support/text.hpp"

#include <sys/resource.h>

namespace mixbeam {
namespace room_test {
namespace {

/// A cantilever; with `lists` beside its list "Scene". A force with three components bends it in space.
std::string cantilever(int elements, int order, const std::string& force, const std::string& lists = "") {
  return "Scene: {Sections: {s: {Inextensible: true, Shear Rigid: true, GIt: 1, EI2: 1, EI3: 1}}, "
         "Points: {wall: [0, 0, 0], tip: [1, 0, 0]}, Supports: {c: {Point: wall}}, Members: {rod: {Start: wall, End: "
         "tip, "
         "Section: s, Order: " +
         std::to_string(order) + ", Elements: " + std::to_string(elements) +
         "}}, Point Loads: {f: {Point: tip, Force: " + force + "}}}\n" + lists;
}

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// What a process took.
struct Cost {
  int status = 0;
  double peak = 0.0;      ///< RSS [byte]
  long times_asleep = 0;  ///< of all threads
};

Cost wait_for(pid_t process) {
  Cost cost;
  rusage usage{};
  EXPECT_EQ(wait4(process, &cost.status, 0, &usage), process);
  cost.peak = 1024.0 * static_cast<double>(usage.ru_maxrss);
  cost.times_asleep = usage.ru_nvcsw;
  return cost;
}

class Room : public MixbeamTest {
 protected:
  /// Peak of a run on top of that of a run of four elements.
  double growth(const std::string& text) {
    double peak[2] = {};
    for (int i = 0; i < 2; ++i) {
      const std::vector<std::string> words = {"run", write_scene(i == 0 ? cantilever(4, 2, "[0, 1, 0]") : text),
                                              "--output", folder_.path().string()};
      const Cost cost = wait_for(start(words));
      EXPECT_TRUE(WIFEXITED(cost.status) && WEXITSTATUS(cost.status) == kOk);
      peak[i] = cost.peak;
    }
    return peak[1] - peak[0];
  }
  /// As `check` prints it.
  double estimate(const std::string& text) {
    const Ended ended = mixbeam({"check", write_scene(text)});
    const std::string words = "memory of a run about ";
    const std::size_t place = ended.out.find(words);
    if (place == std::string::npos) return std::nan("");
    std::istringstream rest(ended.out.substr(place + words.size()));
    double number = 0.0;
    std::string unit;
    rest >> number >> unit;
    return number * (unit.rfind("GB", 0) == 0 ? 1e9 : unit.rfind("MB", 0) == 0 ? 1e6 : 1e3);
  }
};

TEST_F(Room, MemoryIsEstimatedWithinThirtyPerCent) {
  constexpr int kElements = 20'000;
  constexpr double kAllowed = 0.3;
  const std::string spatial = cantilever(kElements, 2, "[0.3, 1, 0.7]"), planar = cantilever(kElements, 4, "[0, 1, 0]");
  for (const std::string& text : {spatial, planar}) EXPECT_NEAR(estimate(text) / growth(text), 1.0, kAllowed);
  EXPECT_GT(std::abs(estimate(cantilever(kElements, 8, "[0, 1, 0]")) / growth(planar) - 1.0), kAllowed)
      << "other order";
}

TEST_F(Room, WhatDoesNotFitIsRefusedAtOnce) {
  const std::string large = write_scene(cantilever(10'000'000, 8, "[0, 1, 0]"));  // 200 GB
  const auto in_limit = [&](const std::string& command) {
    const std::string limited = "ulimit -v 3000000; exec \"$0\" " + command;
    return run_process("/bin/bash", {"-c", limited, program("mixbeam").string(), large, folder_.path().string()},
                       folder_);
  };
  for (const char* command : {"check \"$1\"", "run \"$1\" --output \"$2\""}) {
    const auto start = std::chrono::steady_clock::now();
    const Ended ended = in_limit(command);
    EXPECT_LT(seconds_since(start), 10.0) << "a second, and the wait for a busy machine";
    EXPECT_EQ(ended.exit_code, kBadInput) << ended.err;
    for (const char* part :
         {"scene.yaml:1:1: YAML path \"Scene\"", "GB of memory", "available", "allowed: ", "--force"})
      EXPECT_NE(ended.err.find(part), std::string::npos) << part << " in " << ended.err;
  }
  const Ended forced = in_limit("run \"$1\" --output \"$2\" --force");
  EXPECT_NE(forced.exit_code, kOk);
  EXPECT_EQ(forced.err.find("needs about"), std::string::npos) << forced.err;
}

/// 134 MB of addresses for OpenBLAS, which waited for them for ever.
TEST_F(Room, ALimitWithoutRoomForOpenBlasEndsTheRun) {
  const std::string column =
      write_scene(cantilever(4, 2, "[-5, 0, 0]"));  // beyond its critical load: eigenvalues are wanted
  for (const auto& [limit, exit_code] : {std::pair{"280000", kBadInput}, {"3000000", kOk}}) {
    const std::string limited = "ulimit -v " + std::string(limit) +
                                "; OMP_NUM_THREADS=1 exec timeout -s KILL 30 \"$0\" run \"$1\" --output \"$2\"";
    const Ended ended = run_process(
        "/bin/bash", {"-c", limited, program("mixbeam").string(), column, folder_.path().string()}, folder_);
    EXPECT_EQ(ended.exit_code, exit_code) << ended.err;
    EXPECT_EQ(ended.err.find("OpenBLAS") != std::string::npos, exit_code == kBadInput) << ended.err;
  }
}

/// Whether a run loads the parts of Open MPI that its start does.
bool starts_mpi(const std::string& scene, const fs::path& folder) {
  const fs::path log = folder / "loaded";
  const pid_t process = start_process("/usr/bin/env",
                                      {"LD_DEBUG=files", "LD_DEBUG_OUTPUT=" + log.string(), program("mixbeam").string(),
                                       "run", scene, "--quiet", "--output", folder.string()},
                                      folder);
  const Cost cost = wait_for(process);
  EXPECT_TRUE(WIFEXITED(cost.status) && WEXITSTATUS(cost.status) == kOk);
  const std::string name = log.string() + "." + std::to_string(process);
  EXPECT_TRUE(fs::exists(name));
  return text_of(fs::path(name)).find("mca_pml") != std::string::npos;
}

/// Its start takes longer than a small run.
TEST_F(Room, MpiStartsWhereSomethingNeedsIt) {
  EXPECT_FALSE(starts_mpi(write_scene(cantilever(20, 2, "[0, 1, 0]")), folder_.path()));
  EXPECT_TRUE(starts_mpi(write_scene(cantilever(20, 2, "[-5, 0, 0]")), folder_.path()))
      << "buckles: MUMPS for its modes";
}

/// The description of all steps was held as one text: 12 kB a step.
TEST_F(Room, StepsDoNotGrowTheProgram) {
  constexpr int kFew = 50, kMany = 450;
  constexpr double kOfStep = 3000.0;  // byte; what is kept of each takes 450, and heaps grow in blocks
  const auto peak = [&](int steps) {
    const std::string fixed = "Solver: {Load Path: {Method: fixed, Steps: " + std::to_string(steps) + "}}\n";
    const std::vector<std::string> words = {"run",
                                            write_scene(cantilever(2, 1, "[0, 1, 0]", fixed)),
                                            "--quiet",
                                            "--threads",
                                            "1",
                                            "--output",
                                            folder_.path().string()};
    const Cost cost = wait_for(start(words));
    EXPECT_TRUE(WIFEXITED(cost.status) && WEXITSTATUS(cost.status) == kOk);
    return cost.peak;
  };
  EXPECT_LT(peak(kMany) - peak(kFew), kOfStep * (kMany - kFew));
}

/// How often a thread of a run on two threads went to sleep. Unlike times the same on a busy machine and an idle one.
long times_asleep(const std::string& scene, const std::string& environment, const fs::path& folder) {
  const pid_t process =
      start_process("/usr/bin/env",
                    {"-u", "OMP_WAIT_POLICY", "-u", "OMP_NUM_THREADS", environment, program("mixbeam").string(), "run",
                     scene, "--threads", "2", "--quiet", "--output", folder.string()},
                    folder);
  return wait_for(process).times_asleep;
}

TEST_F(Room, ThreadsThatWaitLeaveTheProcessorToOthers) {
  if (std::thread::hardware_concurrency() < 2) GTEST_SKIP() << "OpenMP does not spin on one processor";
  const std::string path = write_scene(cantilever(10'000, 2, "[0.3, 1, 0.7]"));
  const long asleep = times_asleep(path, "NOTHING=", folder_.path());                   // 1,400 loops
  const long spinning = times_asleep(path, "GOMP_SPINCOUNT=infinite", folder_.path());  // reading and writing alone
  constexpr long kFarMore = 4;  // 14 to 60 times as often was seen, beside four other jobs too
  EXPECT_GT(asleep, kFarMore * spinning) << spinning;
}

TEST_F(Room, ManyThreadsAreLimitedAndSaidSo) {
  const std::string path = write_scene(cantilever(4, 2, "[0, 1, 0]")), output = folder_.path().string();
  expect_in(expect_code(kOk, mixbeam({"run", path, "--output", output, "--threads", "1024", "--quiet"})).out,
            {"warning: 1024 threads on "});
  EXPECT_EQ(mixbeam({"run", path, "--output", output, "--threads", "2", "--quiet"}).out.find("threads on"),
            std::string::npos);
}

TEST_F(Room, RunWarnsOfTheSceneAsCheckDoes) {
  const std::string path = write_scene(cantilever(2, 1, "[0, 1, 0]")), summary = file("summary.json");
  const Ended checked = mixbeam({"check", path});
  const Ended ended = mixbeam({"run", path, "--output", folder_.path().string(), "--summary", summary, "--quiet"});
  for (const std::string& text : {checked.out, ended.out, text("summary.json")})
    expect_in(text, {"Members / rod: 2 element(s) of order 1 are coarse"});
  const Ended sound =
      mixbeam({"run", write_scene(cantilever(8, 2, "[0, 1, 0]")), "--output", folder_.path().string(), "--quiet"});
  EXPECT_EQ(sound.out.find("are coarse"), std::string::npos);
}

/// A member that turns too far in its elements shows when these are made.
TEST_F(Room, ErrorsOfElementsHaveFileLineAndPath) {
  const auto wave = [&](const std::string& formula) {
    return write_scene(changed(cantilever(4, 2, "[0, 1, 0]"), "Order",
                               "Curve: {Shape: parametric, Formula: [t, '" + formula + "', 0]}, Order"));
  };
  const std::string many = wave("sin(300*t) - t*sin(300)"), output = folder_.path().string();
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"check", many}, {"run", many, "--output", output}}) {
    const Ended ended = expect_code(kBadInput, mixbeam(words));
    expect_in(ended.err,
              {"scene.yaml:1:172: YAML path \"Scene / Members / rod\"", "turns too far", "more elements are needed"});
  }
  EXPECT_EQ(mixbeam({"check", wave("sin(pi*t)")}).exit_code, kOk);
}

/// As many moments as the environment variable MIXBEAM_SIGNALS says.
int number_of_signals() {
  const char* given = std::getenv("MIXBEAM_SIGNALS");
  return given == nullptr ? 10 : std::stoi(given);
}

/// What is wrong with the end of a run that was asked to stop: 2 s are promised, and a busy machine takes its own.
std::string problem_of_end(const Ended& ended, int signal, double seconds) {
  constexpr double kPromised = 2.0, kBusyMachine = 3.0;
  if (seconds > kPromised + kBusyMachine) return "took " + std::to_string(seconds) + " s";
  // a signal before main() has begun has its usual effect
  if (ended.exit_code == kInterrupted || (ended.exit_code == -signal && ended.out.empty())) return "";
  return "exit code " + std::to_string(ended.exit_code) + ": " + ended.err;
}

TEST_F(Room, SignalsEndARunInEveryPhase) {
  const std::string path = write_scene(cantilever(20'000, 3, "[0.3, 1, 0.7]", "Analysis: {Buckling Modes: 2}"));
  const fs::path results = folder_ / "results";
  const int moments = number_of_signals();
  const double longest = 3.0;
  for (int i = 0; i < moments; ++i) {
    fs::remove_all(results);
    const int signal = i % 2 == 0 ? SIGINT : SIGTERM;
    SCOPED_TRACE("moment " + std::to_string(i));
    const pid_t process = start({"run", path, "--output", results.string()});
    std::this_thread::sleep_for(std::chrono::duration<double>(longest * (i + 0.5) / moments));
    kill(process, signal);
    const auto start = std::chrono::steady_clock::now();
    const Ended ended = end_of(process, folder_.path());
    if (ended.exit_code == kOk) continue;  // it had arrived
    EXPECT_EQ(problem_of_end(ended, signal, seconds_since(start)), "");
    if (!fs::exists(results / "scene.h5")) continue;
    const auto left = contents_of(results / "scene.h5");
    EXPECT_GE(complete_steps(left), 0);
  }
  EXPECT_NE(problem_of_end({kOk, "", ""}, SIGINT, 0.1), "");
  EXPECT_NE(problem_of_end({kInterrupted, "", ""}, SIGINT, 60.0), "");
}

}  // namespace
}  // namespace room_test
}  // namespace mixbeam
