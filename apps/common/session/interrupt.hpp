/// Ctrl-C (SIGINT) and SIGTERM end the program within two seconds, with one exit code: at once before anything is
/// computed; then in order at the last completed step, within the iteration, as long as that takes no longer (a
/// factorisation inside a library, samples of a large structure), else at once with that step on disk. A second one
/// ends it at once.
#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>

#include "discretization/mesh/tpetra_types.hpp"

namespace mixbeam {

/// Code that shells expect of a program that Ctrl-C ended.
inline constexpr int kInterruptedExitCode = 130;

/// Makes both signals end the program at once from now on: nothing is lost yet.
void leave_on_interrupts();

/// Makes both signals ask for an orderly end from now to the end of the program.
void watch_for_interrupts();

/// Takes the limit of two seconds away from an orderly end that would lose its results, which are written as a whole.
void finish_in_order();

/// True as soon as this process was asked to stop.
bool interrupt_requested_here();

/// True on every rank as soon as one of them was asked to stop. Collective.
bool interrupt_requested(const Communicator& communicator);

/// While alive: where the program was asked to stop and has not come to an orderly end within a second, saves what
/// there is, in a thread of its own, and leaves with kInterruptedExitCode; with kInputErrorExitCode and the reason
/// where that fails. For programs of one rank that watch for interrupts.
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
