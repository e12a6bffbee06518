/// Load cases of a scene solved concurrently in processes: HDF5 and Teuchos do not support runs on several threads.
#pragma once

#include "apps/common/run/application.hpp"
#include "apps/mixbeam/scene_run.hpp"

#include <sys/types.h>

#include <cstdio>

namespace mixbeam {

/// Work of a process: reads the scene before its first case. `number`: of the case.
struct CaseWork {
  std::function<void(Application& app)> set_up;
  std::function<RunEnd(Application& app, std::size_t number)> solve;
};

/// Processes that wait for cases until this object or its process ends. Only that process handles signals; it asks the
/// others to stop.
class CaseProcesses {
 public:
  /// Call it before MPI starts, since each process starts its own. Throws std::runtime_error.
  CaseProcesses(int count, const CaseWork& work);
  /// Ends the processes; during a case after its last completed step.
  ~CaseProcesses();
  CaseProcesses(const CaseProcesses&) = delete;
  CaseProcesses& operator=(const CaseProcesses&) = delete;

  /// Solves these cases on all processes. Output and additions to the summary appear case by case, in this order. After
  /// a failure no case is started; the error of the first failed case is thrown when the running ones have ended.
  /// Returns interrupted if this process is asked to stop.
  RunEnd solve(Application& app, const std::vector<std::string>& cases);

 private:
  struct Process {
    pid_t id = 0;
    FILE* socket = nullptr;
    std::size_t number = 0;  ///< of its case
    bool is_busy = false;
  };

  void stop();
  void ask(const Application& app, Process& process, std::size_t number);

  std::vector<Process> processes_;
};

}  // namespace mixbeam
