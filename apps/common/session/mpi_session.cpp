#include "apps/common/session/mpi_session.hpp"

#include "discretization/results/result_file.hpp"
#include "discretization/text/errors.hpp"
#include "kernels/execution/execution_space.hpp"

#include <malloc.h>
#include <mpi.h>
#include <unistd.h>

#include <Teuchos_DefaultMpiComm.hpp>
#include <Tpetra_Core.hpp>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <map>
#include <string>
#include <vector>

namespace mixbeam {

namespace {

struct Setting {
  const char *name, *value;
};

// Without mpirun, Open MPI searches for a network and a daemon for 0.3 s before it finds that it is alone; a small
// scene is solved in a tenth of that. All programs that are alone would share one folder for their sessions, and the
// first to end removes it under the others.
const std::vector<Setting> kAlone = {{"OMPI_MCA_ess_singleton_isolated", "1"},
                                     {"OMPI_MCA_pml", "ob1"},
                                     {"OMPI_MCA_btl", "self,vader"},
                                     {"OMPI_MCA_mtl", "^ofi"},
                                     {"OMPI_MCA_orte_create_session_dirs", "false"}};

void tell_open_mpi_that_it_is_alone() {
  if (std::getenv("OMPI_COMM_WORLD_SIZE") != nullptr) return;  // started by mpirun
  const int keep_the_users_choice = 0;
  for (const Setting& setting : kAlone) setenv(setting.name, setting.value, keep_the_users_choice);
}

/// Vectors and states of large models come and go in every iteration. By default glibc returns such blocks to the
/// system, and the page faults of getting them back cost as much as the arithmetic.
void keep_freed_memory() {
#ifdef __GLIBC__
  constexpr int kNever = 2'000'000'000;
  mallopt(M_MMAP_THRESHOLD, kNever);
  mallopt(M_TRIM_THRESHOLD, kNever);
#endif
}

/// Several ranks on one node share its cores; OpenMP would give all of them to each rank, and waiting threads spin.
void share_cores_between_ranks() {
  if (std::getenv("OMP_NUM_THREADS") != nullptr) return;  // the user's choice
  MPI_Comm node = MPI_COMM_NULL;
  MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &node);
  int ranks = 1;
  MPI_Comm_size(node, &ranks);
  MPI_Comm_free(&node);
  if (ranks > 1) set_number_of_threads(std::max(1, number_of_threads() / ranks));
}

// Tpetra would call plain MPI_Init; kernels run on threads, MPI is called by one thread at a time.
void start_mpi() {
  int provided = MPI_THREAD_SINGLE;
  MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &provided);
}

/// A command line. Kokkos would take "--threads 2" for one of its own options and abort: it sees a program's name only.
struct NameOnly {
  char name[8] = "mixbeam";
  char* words[2] = {name, nullptr};
  char** values = words;
  int count = 1;
};

/// Puts the environment back at its end: Open MPI leaves settings of its own there, which programs that the host starts
/// would inherit.
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

/// Puts the handlers of all signals back at its end.
class SignalHandlers {
 public:
  SignalHandlers() {
    for (int signal = 1; signal < NSIG; ++signal) is_known_[signal] = sigaction(signal, nullptr, &before_[signal]) == 0;
  }
  ~SignalHandlers() {
    for (int signal = 1; signal < NSIG; ++signal)
      if (is_known_[signal] && signal != SIGKILL && signal != SIGSTOP) sigaction(signal, &before_[signal], nullptr);
  }
  SignalHandlers(const SignalHandlers&) = delete;
  SignalHandlers& operator=(const SignalHandlers&) = delete;

 private:
  struct sigaction before_[NSIG] {};
  bool is_known_[NSIG]{};
};

}  // namespace

Communicator start_as_guest() {
  static const Communicator communicator = [] {
    const SignalHandlers kept;
    int is_started = 0;
    MPI_Initialized(&is_started);
    begin_results_library();
    if (is_started == 0) {
      const char* ranks = std::getenv("OMPI_COMM_WORLD_SIZE");
      if (ranks != nullptr && std::string(ranks) != "1")
        throw InputError(std::string(ranks) +
                         " ranks of mpirun; a library in another program runs on one; allowed: no " +
                         "mpirun, or the program itself, mpirun mixbeam run");
      const Environment kept_too;
      for (const Setting& setting : kAlone) setenv(setting.name, setting.value, 1);
      setenv("OMPI_MCA_btl", "self", 1);  // vader leaves a file of shared memory behind without MPI_Finalize
      start_mpi();
    }
    const Communicator alone = Teuchos::rcp(new Teuchos::MpiComm<int>(MPI_COMM_SELF));
    NameOnly line;
    Tpetra::initialize(&line.count, &line.values, alone);
    return alone;
  }();
  return communicator;
}

MpiSession::MpiSession() {
  keep_freed_memory();
  tell_open_mpi_that_it_is_alone();
  begin_results_library();
  start_mpi();
  NameOnly line;
  guard_ = std::make_unique<Tpetra::ScopeGuard>(&line.count, &line.values);
  communicator_ = Tpetra::getDefaultComm();
  share_cores_between_ranks();
}

MpiSession::~MpiSession() {
  communicator_ = Teuchos::null;
  guard_.reset();
  MPI_Finalize();
}

}  // namespace mixbeam
