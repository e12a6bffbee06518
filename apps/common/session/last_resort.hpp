/// Completes results that are written as a whole when a program is interrupted.
#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>

namespace mixbeam {

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
