#include "apps/common/session/interrupt.hpp"

#include "discretization/text/errors.hpp"

#include <Teuchos_CommHelpers.hpp>

#include <csignal>
#include <cstring>

#include <unistd.h>
#include <chrono>
#include <exception>
#include <iostream>

namespace mixbeam {

namespace {

volatile std::sig_atomic_t requested = 0;

/// Time for an orderly end; after it the program exits, with the last step on disk.
constexpr unsigned kPatience = 2;  // seconds

void leave(int) { _exit(kInterruptedExitCode); }

/// Handles both signals by async-signal-safe calls only: a flag, the default for the next signal, an alarm, a write.
void on_signal(int signal) {
  requested = 1;
  std::signal(signal, SIG_DFL);
  std::signal(SIGALRM, leave);
  alarm(kPatience);
  static constexpr char kText[] =
      "\nStopping after the last completed step, which is on disk; once more to end at once.\n";
  [[maybe_unused]] const auto written = write(STDERR_FILENO, kText, sizeof kText - 1);
}

void handle_both(void (*handler)(int)) {
  struct sigaction action;
  std::memset(&action, 0, sizeof action);
  action.sa_handler = handler;
  action.sa_flags = SA_RESTART;
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

using Milliseconds = std::chrono::milliseconds;
constexpr Milliseconds kLook{50};      // polling interval for interrupts
constexpr Milliseconds kOrderly{900};  // for an orderly end, out of the promised two seconds

}  // namespace

void leave_on_interrupts() { handle_both(leave); }

void watch_for_interrupts() { handle_both(on_signal); }

void finish_in_order() { alarm(0); }

bool interrupt_requested_here() { return requested != 0; }

bool interrupt_requested(const Communicator& communicator) {
  const int here = requested;
  if (communicator->getSize() == 1) return here != 0;
  int anywhere = 0;
  Teuchos::reduceAll(*communicator, Teuchos::REDUCE_MAX, here, Teuchos::outArg(anywhere));
  return anywhere != 0;
}

LastResort::LastResort(std::function<void()> save) : save_(std::move(save)), thread_([this] { watch(); }) {}

LastResort::~LastResort() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    done_ = true;
  }
  done_changed_.notify_all();
  thread_.join();
}

void LastResort::watch() {
  std::unique_lock<std::mutex> lock(mutex_);
  const auto is_done = [this] { return done_; };
  while (!interrupt_requested_here())
    if (done_changed_.wait_for(lock, kLook, is_done)) return;
  if (done_changed_.wait_for(lock, kOrderly, is_done)) return;
  finish_in_order();
  try {
    save_();
  } catch (const std::exception& error) {
    std::cerr << error.what() << std::endl;
    _exit(kInputErrorExitCode);
  }
  std::cout.flush();
  _exit(kInterruptedExitCode);
}

}  // namespace mixbeam
