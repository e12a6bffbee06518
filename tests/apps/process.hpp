/// Starting an application as a user does: a process of its own, in a folder of its own.
#pragma once

#include "run_program.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace mixbeam {

namespace fs = std::filesystem;

inline void write_text(const fs::path& file, const std::string& text) { std::ofstream(file, std::ios::binary) << text; }

inline fs::path program(const std::string& name) { return fs::path(MIXBEAM_BIN_DIR) / name; }

/// The scene that belongs to an application.
inline std::string scene_of(const std::string& application) {
  return text_of(fs::path(MIXBEAM_SOURCE_DIR) / "apps" / application / (application + ".xml"));
}

/// How a process ended. A crash is never taken for an exit code: `exit_code` is then -signal.
struct Ended {
  int exit_code = -1;
  std::string out, err;
};

/// A new folder that goes away at the end of the test.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string folder = (fs::temp_directory_path() / "mixbeam_app_XXXXXX").string();
    if (mkdtemp(folder.data()) == nullptr) throw std::runtime_error("no temporary folder: " + folder);
    path_ = folder;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  fs::path operator/(const std::string& name) const { return path_ / name; }
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
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

/// Runs a program to its end; what it prints is kept. `folder`: for the prints.
inline Ended run_process(const fs::path& executable, const std::vector<std::string>& arguments,
                         const TemporaryFolder& folder) {
  const std::string out = (folder / "stdout.txt").string(), err = (folder / "stderr.txt").string();
  std::vector<std::string> words = {executable.string()};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<std::string> variables = environment_of_a_user();
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, err.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  pid_t process = 0;
  const int problem =
      posix_spawn(&process, executable.c_str(), &actions, nullptr, pointers(words).data(), pointers(variables).data());
  posix_spawn_file_actions_destroy(&actions);
  EXPECT_EQ(problem, 0) << executable << ": " << std::strerror(problem);
  if (problem != 0) return {};
  int status = 0;
  EXPECT_EQ(waitpid(process, &status, 0), process);
  EXPECT_FALSE(WIFSIGNALED(status)) << executable << " crashed: " << strsignal(WTERMSIG(status)) << "\n"
                                    << text_of(err);
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status), text_of(out), text_of(err)};
}

/// `text` with the first `from` after the place of `after` replaced; a test that changes nothing would prove nothing.
inline std::string changed(std::string text, const std::string& from, const std::string& to,
                           const std::string& after = "") {
  const std::size_t start = text.find(after);
  const std::size_t place = start == std::string::npos ? start : text.find(from, start);
  EXPECT_NE(place, std::string::npos) << "the scene does not contain: " << after << " ... " << from;
  return place == std::string::npos ? text : text.replace(place, from.size(), to);
}

inline void expect_in(const std::string& text, const std::vector<std::string>& parts) {
  for (const std::string& part : parts)
    EXPECT_NE(text.find(part), std::string::npos) << "missing: " << part << "\nin: " << text;
}

}  // namespace mixbeam
