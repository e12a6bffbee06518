#include "apps/common/session/last_resort.hpp"

#include "apps/common/session/interrupt.hpp"
#include "discretization/text/errors.hpp"

#include <chrono>
#include <exception>
#include <iostream>

#include <unistd.h>

namespace mixbeam {

namespace {

using Milliseconds = std::chrono::milliseconds;
constexpr Milliseconds kLook{50};      // how often it is asked for an interrupt
constexpr Milliseconds kOrderly{900};  // that an orderly end may take; two seconds are promised in all

}  // namespace

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
