#include "apps/mixbeam/commands.hpp"
#include "discretization/text/errors.hpp"
#include "discretization/text/message_text.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>

namespace mixbeam {

namespace {

/// Isolates Python from the current folder, PYTHONPATH and ~/.local; only the folder of the script is added.
constexpr const char* kIsolated = "-I";
constexpr const char* kNeeded = "import numpy, matplotlib, h5py";
constexpr const char* kStart =
    "import runpy, sys; sys.path.insert(0, sys.argv[1]); del sys.argv[:2]; "
    "runpy.run_path(sys.argv[0], run_name='__main__')";

/// Debian's Python first: it has Debian's packages, which another one in PATH may lack.
const std::vector<std::string> kInterpreters = {"/usr/bin/python3", "python3"};

/// Finds a Python with the needed packages. `folder`: of the scripts, without foreign settings of matplotlib.
std::string suitable_python(const std::string& folder) {
  std::string found;
  for (const std::string& python : kInterpreters) {
    const auto runs = [&](const std::string& text) {
      return exit_code_of({python, kIsolated, "-c", text}, {folder, "", "/dev/null"}) == 0;
    };
    if (runs(kNeeded)) return python;
    if (!runs("")) continue;
    std::vector<std::string> lacks;
    for (const char* module : {"numpy", "matplotlib", "h5py"})
      if (!runs(std::string("import ") + module)) lacks.push_back(module);
    found += "; " + python + " lacks " + quoted_list(lacks);
  }
  throw InputError("pictures and reports need Python with numpy, matplotlib and h5py" +
                   (found.empty() ? "; there is neither \"/usr/bin/python3\" nor \"python3\" in PATH" : found) +
                   " (Debian: apt-get install python3-matplotlib python3-h5py); packages in ~/.local and PYTHONPATH do "
                   "not count");
}

/// Runs a script of plots_folder(), which verifies each result file before reading it.
int run_script(const Arguments& arguments, const std::string& name) {
  if (arguments.count() < 2)
    throw InputError(std::string("a result file is missing: mixbeam ") + arguments.values[0] +
                     " RESULTS.h5, or SCENE.yaml");
  require_run(arguments.values[0], arguments.values[1]);
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe");
  const std::filesystem::path script = plots_folder() / name;
  if (!std::filesystem::exists(script)) throw InputError("the script " + script.string() + " is missing");
  setenv("MPLBACKEND", "Agg", 1);
  setenv("MIXBEAM_PROGRAM", program.c_str(), 1);
  const std::string folder = script.parent_path().string();
  std::vector<std::string> words = {suitable_python(folder), kIsolated, "-c", kStart, folder, script.string()};
  words.insert(words.end(), arguments.values.begin() + 1, arguments.values.end());
  const int code = exit_code_of(words);
  return code == 0 ? 0 : kInputErrorExitCode;
}

}  // namespace

int exit_code_of(std::vector<std::string> words, const ProcessPlaces& places) {
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  const auto write_to = [&actions](int stream, const std::string& file) {
    constexpr int kFlags = O_WRONLY | O_CREAT | O_TRUNC, kMode = 0600;
    if (!file.empty()) posix_spawn_file_actions_addopen(&actions, stream, file.c_str(), kFlags, kMode);
  };
  write_to(STDOUT_FILENO, places.out);
  write_to(STDERR_FILENO, places.err);
  if (!places.folder.empty()) posix_spawn_file_actions_addchdir_np(&actions, places.folder.c_str());
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t as_usual;  // signals that this program ignores
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

std::filesystem::path plots_folder() {
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe");
  const std::filesystem::path beside = program.parent_path() / "plots";
  if (std::filesystem::exists(beside)) return beside;
  return program.parent_path().parent_path() / "lib/python3/dist-packages/mixbeam/plots";
}

void require_run(const std::string& command, const std::filesystem::path& file) {
  const std::string name = file.stem().string(), batch = "-batch", allowed = "; allowed: results of mixbeam run";
  if (command != "plot" && name.size() > batch.size() && name.substr(name.size() - batch.size()) == batch &&
      file.extension() == ".h5")
    throw InputError("\"" + excerpt(file.string()) + "\" holds the table of a batch" + allowed +
                     "; a picture: mixbeam plot; the same table for other programs: " +
                     excerpt((file.parent_path() / name).string()) + ".csv");
  if (command == "report" && (file.extension() == ".xml" || file.extension() == ".yaml" || file.extension() == ".yml"))
    throw InputError("\"" + excerpt(file.string()) + "\" is a scene" + allowed + ": mixbeam run " +
                     excerpt(file.string()) + ", then mixbeam report results/" + name + "/" + name + ".h5");
}

int plot_command(const Arguments& arguments) { return run_script(arguments, "plot_result.py"); }

int report_command(const Arguments& arguments) { return run_script(arguments, "report.py"); }

}  // namespace mixbeam
