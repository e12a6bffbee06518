#include "apps/mixbeam/commands.hpp"
#include "apps/mixbeam/verify_command.hpp"
#include "discretization/text/errors.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <cstring>

namespace mixbeam {

namespace {

/// Debian's Python has Debian's packages; another one earlier in PATH need not.
const std::vector<std::string> kInterpreters = {"/usr/bin/python3", "python3"};
constexpr const char* kNeeded = "import numpy, matplotlib, h5py";

/// Exit code of a program, -1 when it cannot be started or is killed. `quiet`: its messages are of no interest.
int exit_code_of(std::vector<std::string> words, bool quiet) {
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  if (quiet) posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t as_usual;  // which this program ignores
  sigemptyset(&as_usual);
  sigaddset(&as_usual, SIGPIPE);
  sigaddset(&as_usual, SIGXFSZ);
  posix_spawnattr_setsigdefault(&attributes, &as_usual);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGDEF);
  pid_t process = 0;
  const int problem = posix_spawnp(&process, argv[0], &actions, &attributes, argv.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  int status = 0;
  if (problem != 0 || waitpid(process, &status, 0) != process || !WIFEXITED(status)) return -1;
  return WEXITSTATUS(status);
}

std::string suitable_python() {
  for (const std::string& python : kInterpreters)
    if (exit_code_of({python, "-c", kNeeded}, true) == 0) return python;
  throw InputError(
      "pictures need Python with numpy, matplotlib and h5py; none of \"/usr/bin/python3\" and \"python3\" in PATH has "
      "them (Debian: apt-get install python3-matplotlib python3-h5py)");
}

}  // namespace

namespace {

/// Runs a script of the folder plots beside the program on the result files among the arguments, once they are whole.
int run_script(const Arguments& arguments, const std::string& name) {
  if (arguments.count() < 2)
    throw InputError(std::string("a result file is missing: mixbeam ") + arguments.values[0] + " RESULTS.h5");
  for (const char* argument : arguments.values)
    if (std::filesystem::path(argument).extension() == ".h5" && std::filesystem::exists(argument))
      require_whole(argument);
  const std::filesystem::path script = std::filesystem::read_symlink("/proc/self/exe").parent_path() / "plots" / name;
  if (!std::filesystem::exists(script)) throw InputError("the script " + script.string() + " is missing");
  std::vector<std::string> words = {suitable_python(), script.string()};
  words.insert(words.end(), arguments.values.begin() + 1, arguments.values.end());
  const int keep_the_users_choice = 0;
  setenv("MPLBACKEND", "Agg", keep_the_users_choice);
  const int code = exit_code_of(words, false);
  return code == 0 ? 0 : kInputErrorExitCode;
}

}  // namespace

int plot_command(const Arguments& arguments) { return run_script(arguments, "plot_result.py"); }

int report_command(const Arguments& arguments) { return run_script(arguments, "report.py"); }

int view_command(const Arguments& arguments) { return run_script(arguments, "view_result.py"); }

}  // namespace mixbeam
