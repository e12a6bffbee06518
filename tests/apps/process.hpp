/// Starting an application as a user does: a process of its own, in a folder of its own.
#pragma once

#include "tests/support/files.hpp"
#include "tests/support/text.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

namespace mixbeam {

inline fs::path program(const std::string& name) { return fs::path(MIXBEAM_BIN_DIR) / name; }

/// The scene that belongs to an application.
inline std::string scene_of(const std::string& application) {
  return text_of(fs::path(MIXBEAM_SOURCE_DIR) / "apps" / application / (application + ".xml"));
}

constexpr int kOk = 0, kCheckFailed = 1, kBadInput = 2, kNoConvergence = 3, kInterrupted = 130;  // exit codes

/// How a process ended. A crash is never taken for an exit code: `exit_code` is then -signal.
struct Ended {
  int exit_code = -1;
  std::string out, err;
};

/// The environment without what MPI told the test about itself: the program must not think that it is one of its ranks.
inline std::vector<std::string> environment_of_a_user() {
  std::vector<std::string> variables;
  for (char** variable = environ; *variable != nullptr; ++variable) {
    const std::string text = *variable;
    if (text.rfind("OMPI_", 0) == 0 || text.rfind("PMIX_", 0) == 0) continue;
    variables.push_back(text);
  }
  return variables;
}

inline std::vector<char*> pointers(std::vector<std::string>& texts) {
  std::vector<char*> result;
  for (std::string& text : texts) result.push_back(text.data());
  result.push_back(nullptr);
  return result;
}

/// Starts a program in `folder`; what it prints goes to stdout.txt and stderr.txt there. Returns its number, 0 on
/// failure.
inline pid_t start_process(const fs::path& executable, const std::vector<std::string>& arguments,
                           const fs::path& folder) {
  const std::string out = (folder / "stdout.txt").string(), err = (folder / "stderr.txt").string();
  std::vector<std::string> words = {executable.string()};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<std::string> variables = environment_of_a_user();
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addchdir_np(&actions, folder.c_str());
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, err.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  pid_t process = 0;
  const int problem =
      posix_spawn(&process, executable.c_str(), &actions, nullptr, pointers(words).data(), pointers(variables).data());
  posix_spawn_file_actions_destroy(&actions);
  EXPECT_EQ(problem, 0) << executable << ": " << std::strerror(problem);
  return problem == 0 ? process : 0;
}

/// Waits for the end of a started program.
inline Ended end_of(pid_t process, const fs::path& folder) {
  if (process == 0) return {};
  int status = 0;
  EXPECT_EQ(waitpid(process, &status, 0), process);
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status), text_of(folder / "stdout.txt"),
          text_of(folder / "stderr.txt")};
}

/// Runs a program to its end. `folder`: for the prints.
inline Ended run_process(const fs::path& executable, const std::vector<std::string>& arguments,
                         const fs::path& folder) {
  const Ended ended = end_of(start_process(executable, arguments, folder), folder);
  EXPECT_GE(ended.exit_code, 0) << executable << " crashed: " << strsignal(-ended.exit_code) << "\n" << ended.err;
  return ended;
}
inline Ended run_process(const fs::path& executable, const std::vector<std::string>& arguments,
                         const TemporaryFolder& folder) {
  return run_process(executable, arguments, folder.path());
}

/// What ended as it should.
inline Ended expect_code(int code, Ended ended) {
  EXPECT_EQ(ended.exit_code, code) << ended.out << ended.err;
  return ended;
}
inline void expect_refused(const Ended& ended, const std::vector<std::string>& parts) {
  expect_in(expect_code(kBadInput, ended).err, parts);
}

/// A folder of the build for one test, emptied when it starts.
inline fs::path folder_for(const std::string& test) {
  const fs::path folder = fs::path(MIXBEAM_BIN_DIR) / "test_results" / test;
  fs::remove_all(folder);
  fs::create_directories(folder);
  return folder;
}

/// Runs a benchmark with these arguments (no spaces inside them) on one thread, quietly; what it prints goes to
/// <folder>/output.txt. Returns the exit code.
inline int run_program(const std::string& name, const std::string& arguments, const fs::path& folder) {
  std::vector<std::string> words;
  std::istringstream stream(arguments);
  for (std::string word; stream >> word;) words.push_back(word);
  for (const std::string word : {"--quiet", "--threads", "1", "--output"}) words.push_back(word);
  words.push_back(folder.string());
  const Ended ended = run_process(program(name), words, folder);
  write_text(folder / "output.txt", ended.out + ended.err);
  return ended.exit_code;
}

/// The page that the scripts write of what a benchmark has written to `folder`.
inline std::string page_of(const std::string& benchmark, const fs::path& folder) {
  const fs::path results = folder / "results";
  fs::create_directories(results);
  fs::create_directory_symlink(folder, results / benchmark);
  const std::string script = (fs::path(MIXBEAM_BIN_DIR) / "plots" / "plot_all.py").string();
  const Ended ended =
      run_process("/usr/bin/python3", {script, results.string(), "--only", benchmark, "--pages"}, folder);
  EXPECT_EQ(ended.exit_code, 0) << ended.out << ended.err;
  return text_of(folder / (benchmark + ".md"));
}

}  // namespace mixbeam
