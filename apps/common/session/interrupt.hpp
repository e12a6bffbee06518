/// Ctrl-C (SIGINT) and SIGTERM end the program within two seconds, with one exit code: at once before anything is
/// computed; later in order after the last completed step. If that takes longer (a factorisation inside a library,
/// samples of a large structure), the program leaves with that step on disk. A second signal ends it at once.
#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>

#include "discretization/mesh/tpetra_types.hpp"

namespace mixbeam {

/// Exit code that shells expect after Ctrl-C.
inline constexpr int kInterruptedExitCode = 130;

/// Makes both signals end the program at once, while there is nothing to lose.
void leave_on_interrupts();

/// Makes both signals request an orderly end, until the program exits.
void watch_for_interrupts();

/// Removes the limit of two seconds, for results that are written as a whole and would be lost.
void finish_in_order();

/// True after this process has received a signal.
bool interrupt_requested_here();

/// True on every rank after one of them has received a signal. Collective.
bool interrupt_requested(const Communicator& communicator);

/// Watches for an interrupt in its own thread. If the program does not end in order within a second of it, calls `save`
/// and exits with kInterruptedExitCode, or with kInputErrorExitCode and the reason if that fails. For programs of one
/// rank that watch for interrupts.
class LastResort {
 public:
  explicit LastResort(std::function<void()> save);
  ~LastResort();
  LastResort(const LastResort&) = delete;
  LastResort& operator=(const LastResort&) = delete;

 private:
  void watch();

  std::function<void()> save_;
  std::mutex mutex_;
  std::condition_variable done_changed_;
  bool done_ = false;
  std::thread thread_;  ///< last: it uses the others
};

}  // namespace mixbeam
