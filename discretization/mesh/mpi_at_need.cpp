#include "discretization/mesh/mpi_at_need.hpp"

#include <Teuchos_DefaultMpiComm.hpp>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <string>

#include <dlfcn.h>
#include <unistd.h>

namespace mixbeam {

namespace {

struct Setting {
  const char *name, *value;
};

// Without mpirun, Open MPI searches for a network and a daemon for 0.3 s before it finds that it is alone; a small
// scene is solved in a tenth of that. All such programs would share one session folder, and the first to end removes it
// while others use it. Shared memory leaves a file behind without MPI_Finalize.
constexpr Setting kAlone[] = {{"OMPI_MCA_ess_singleton_isolated", "1"},
                              {"OMPI_MCA_pml", "ob1"},
                              {"OMPI_MCA_btl", "self"},
                              {"OMPI_MCA_mtl", "^ofi"},
                              {"OMPI_MCA_orte_create_session_dirs", "false"}};

/// Restores the environment on destruction.
class Environment {
 public:
  Environment() : before_(variables()) {}
  ~Environment() {
    for (const auto& [name, value] : variables())
      if (before_.count(name) == 0) unsetenv(name.c_str());
    for (const auto& [name, value] : before_) setenv(name.c_str(), value.c_str(), 1);
  }
  Environment(const Environment&) = delete;
  Environment& operator=(const Environment&) = delete;

 private:
  static std::map<std::string, std::string> variables() {
    std::map<std::string, std::string> found;
    for (char** entry = environ; *entry != nullptr; ++entry) {
      const std::string text = *entry;
      const std::size_t end = text.find('=');
      if (end != std::string::npos) found[text.substr(0, end)] = text.substr(end + 1);
    }
    return found;
  }

  std::map<std::string, std::string> before_;
};

/// Restores the handlers of all signals on destruction.
class SignalHandlers {
 public:
  SignalHandlers() {
    for (int signal = 1; signal < NSIG; ++signal) is_known_[signal] = sigaction(signal, nullptr, &before_[signal]) == 0;
  }
  ~SignalHandlers() {
    for (int signal = 1; signal < NSIG; ++signal)
      if (is_known_[signal] && !is_ours(signal)) sigaction(signal, &before_[signal], nullptr);
  }
  SignalHandlers(const SignalHandlers&) = delete;
  SignalHandlers& operator=(const SignalHandlers&) = delete;

 private:
  /// Handlers set by an interrupt meanwhile: its alarm, and the default for the next one.
  static bool is_ours(int signal) {
    struct sigaction now {};
    if (signal == SIGALRM || signal == SIGKILL || signal == SIGSTOP) return true;
    return (signal == SIGINT || signal == SIGTERM) && sigaction(signal, nullptr, &now) == 0 &&
           now.sa_handler == SIG_DFL;
  }

  struct sigaction before_[NSIG] {};
  bool is_known_[NSIG]{};
};

}  // namespace

bool is_under_mpirun() { return std::getenv("OMPI_COMM_WORLD_SIZE") != nullptr; }

void find_packaged_mpi() {
  Dl_info place{};
  if (dladdr(reinterpret_cast<void*>(&MPI_Init_thread), &place) == 0) return;
  const std::filesystem::path files = std::filesystem::absolute(place.dli_fname).parent_path() / "mpi";
  std::error_code error;
  if (std::filesystem::is_directory(files / "share" / "openmpi", error)) setenv("OPAL_PREFIX", files.c_str(), 1);
}

void require_mpi() {
  int is_started = 0;
  MPI_Initialized(&is_started);
  if (is_started != 0) return;
  const SignalHandlers kept;
  const Environment kept_too;
  for (const Setting& setting : kAlone) setenv(setting.name, setting.value, 1);
  find_packaged_mpi();
  int provided = MPI_THREAD_SINGLE;
  MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &provided);
}

MPI_Comm mpi_of(const Teuchos::Comm<int>& comm) {
  if (const auto* ranks = dynamic_cast<const Teuchos::MpiComm<int>*>(&comm)) return *ranks->getRawMpiComm();
  require_mpi();
  return MPI_COMM_SELF;
}

}  // namespace mixbeam
