#include "apps/common/session/command_line.hpp"
#include "apps/mixbeam/commands.hpp"
#include "discretization/results/stored_run.hpp"
#include "discretization/text/errors.hpp"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <iostream>

namespace mixbeam {

namespace {

const std::string kBadInput = "mixbeam: bad input: ";

std::string advice(const FileReport& report, const std::string& file) {
  if (!report.last_whole_step) return "; none of its steps is intact";
  const std::string step = std::to_string(*report.last_whole_step);
  return "; intact up to step " + step + ": mixbeam resume " + file + " --from " + step + " continues from there";
}

/// Identifies the file behind a path, to detect its replacement.
std::array<long long, 4> stamp_of(const std::string& file) {
  struct stat now {};
  if (stat(file.c_str(), &now) != 0) return {};
  return {static_cast<long long>(now.st_ino), static_cast<long long>(now.st_size),
          static_cast<long long>(now.st_mtim.tv_sec), static_cast<long long>(now.st_mtim.tv_nsec)};
}

/// Verifies a file. A running simulation publishes another copy with each step and rewrites the previous one, so damage
/// in a file replaced meanwhile is ignored.
FileReport report_on(const std::string& file) {
  constexpr int kMostReplacements = 50;  // reading takes milliseconds, as do the fastest steps
  for (int replaced = 0;; ++replaced) {
    const auto before = stamp_of(file);
    const bool is_last = replaced == kMostReplacements;
    try {
      FileReport report = verify_results(file);
      if (report.damage.empty() || is_last || stamp_of(file) == before) return report;
    } catch (const InputError&) {
      if (is_last || stamp_of(file) == before) throw;
    }
  }
}

/// Limits memory and time of a process that reads a possibly hostile file, above what reading it takes.
void limit_process(std::uintmax_t file_bytes) {
#if !defined(__SANITIZE_ADDRESS__)  // its shadow memory takes terabytes
  constexpr rlim_t kMemory = rlim_t{4} << 30;
  const rlim_t most = kMemory + 2 * file_bytes;
  const rlimit memory{most, most};
  setrlimit(RLIMIT_AS, &memory);
#endif
  constexpr rlim_t kBytesInASecond = 50'000'000;  // lower bound of reading and checking
  const rlim_t seconds = 10 + file_bytes / kBytesInASecond;
  const rlimit processor{seconds, seconds};
  setrlimit(RLIMIT_CPU, &processor);
  constexpr unsigned kSlowness = 8;  // factor for a busy machine and its disk
  alarm(kSlowness * static_cast<unsigned>(seconds));
  const rlimit no_core{0, 0};
  setrlimit(RLIMIT_CORE, &no_core);
}

/// Reads the stderr of a child process to its end.
std::string all_of(int pipe_end) {
  std::string text;
  std::array<char, 4096> part{};
  for (;;) {
    const ssize_t got = read(pipe_end, part.data(), part.size());
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return text;
    text.append(part.data(), static_cast<std::size_t>(got));
  }
}

/// Makes only calls that are allowed between fork and exec.
[[noreturn]] void become_verifier(char* const* words, int stderr_pipe, std::uintmax_t file_bytes) {
  limit_process(file_bytes);
  const int nowhere = open("/dev/null", O_WRONLY);
  dup2(nowhere, STDOUT_FILENO);
  dup2(stderr_pipe, STDERR_FILENO);
  execv("/proc/self/exe", words);
  _exit(1);
}

}  // namespace

int verify_command(const Arguments& arguments) {
  const CommandLine line =
      read_command_line(arguments.count(), arguments.values.data(), {"--from", "--help"}, "result file");
  if (!line.scene_file) throw InputError("a result file is missing: mixbeam verify RESULTS.h5");
  const std::string file = *line.scene_file;
  const FileReport report = report_on(file);
  const bool is_enough = line.last_step && report.last_whole_step && *line.last_step <= *report.last_whole_step;
  if (!report.damage.empty() && !is_enough)
    throw InputError(file + ": damaged: " + report.damage + advice(report, file));
  std::cout << file << ": " << report.steps.size() << (report.steps.size() == 1 ? " step" : " steps");
  if (!report.damage.empty())
    std::cout << ", intact up to step " << *report.last_whole_step << "; damaged: " << report.damage << "\n";
  else if (report.is_sealed)
    std::cout << ", intact: all checksums agree\n";
  else
    std::cout << ", readable; it was written by a version without checksums: more cannot be told\n";
  return 0;
}

bool is_first_process() {
  const char* const rank = std::getenv("OMPI_COMM_WORLD_RANK");
  return rank == nullptr || std::strcmp(rank, "0") == 0;
}

void require_whole(const std::filesystem::path& results, std::optional<int> last_step) {
  if (!is_first_process()) return;
  std::vector<std::string> words = {"mixbeam", "verify"};
  if (last_step) words.insert(words.end(), {"--from", std::to_string(*last_step)});
  words.push_back(results.string());
  if (words.back()[0] == '-') words.back().insert(0, "./");  // not an option
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  std::error_code ignored;
  const std::uintmax_t size = std::filesystem::is_regular_file(results, ignored)
                                  ? std::filesystem::file_size(results, ignored)
                                  : std::uintmax_t{0};
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) throw std::runtime_error("no pipe: " + std::string(std::strerror(errno)));
  const pid_t process = fork();
  if (process < 0) throw std::runtime_error("no process: " + std::string(std::strerror(errno)));
  if (process == 0) become_verifier(pointers.data(), ends[1], size);
  close(ends[1]);
  std::string said = all_of(ends[0]);
  close(ends[0]);
  int status = 0;
  while (waitpid(process, &status, 0) < 0 && errno == EINTR) continue;
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return;
  if (WIFEXITED(status) && WEXITSTATUS(status) == kInputErrorExitCode && said.rfind(kBadInput, 0) == 0) {
    while (!said.empty() && said.back() == '\n') said.pop_back();
    throw InputError(said.substr(kBadInput.size()));
  }
  const std::string end =
      WIFSIGNALED(status) ? strsignal(WTERMSIG(status)) : "exit " + std::to_string(WEXITSTATUS(status));
  throw InputError(results.string() + ": damaged: reading it ended a process of its own (" + end + ")");
}

}  // namespace mixbeam
