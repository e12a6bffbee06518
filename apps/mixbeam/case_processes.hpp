/// Load cases of a scene solved side by side, each in a process: HDF5 and Teuchos do not stand runs on several threads
/// of one.
#pragma once

#include "apps/common/run/application.hpp"
#include "apps/mixbeam/scene_run.hpp"

#include <sys/types.h>

#include <cstdio>

namespace mixbeam {

/// What a process does: it reads the scene before its first case. `number`: of the case.
struct CaseWork {
  std::function<void(Application& app)> set_up;
  std::function<RunEnd(Application& app, std::size_t number)> solve;
};

/// Processes that wait for cases, to the end of this object or of the process that made it. Signals are for the latter,
/// which asks the others to stop.
class CaseProcesses {
 public:
  /// Before MPI starts, for each of them starts its own. Throws std::runtime_error.
  CaseProcesses(int count, const CaseWork& work);
  /// Lets them end; in the middle of a case, after its last completed step.
  ~CaseProcesses();
  CaseProcesses(const CaseProcesses&) = delete;
  CaseProcesses& operator=(const CaseProcesses&) = delete;

  /// Solves these cases, as many at once as there are processes. What they print and add to the summary comes out case
  /// by case, in this order. After one that fails none begins; what ended the first of them is thrown when those that
  /// had begun have ended. Interrupted: where this process is asked to stop.
  RunEnd solve(Application& app, const std::vector<std::string>& cases);

 private:
  struct Process {
    pid_t id = 0;
    FILE* socket = nullptr;
    std::size_t number = 0;  ///< of the case that it solves
    bool is_busy = false;
  };

  void stop();
  void ask(const Application& app, Process& process, std::size_t number);

  std::vector<Process> processes_;
};

}  // namespace mixbeam
