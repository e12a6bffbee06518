/// Rules for the library inside a host process: one call of the library at a time, without the interpreter's lock;
/// signals are handled, forks survived.
#pragma once

#include "apps/common/session/mpi_session.hpp"
#include "kernels/execution/execution_space.hpp"

#include <omp.h>
#include <pthread.h>
#include <pybind11/pybind11.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <exception>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <thread>
#include <utility>

namespace mixbeam {

/// State shared by all calls of this process.
struct Guest {
  std::recursive_mutex mutex{};     ///< of the library; reference counts of Trilinos and Kokkos are not atomic
  std::atomic<int> visitors{0};     ///< threads that hold the mutex or wait for it
  std::atomic<pid_t> process{0};    ///< process of the last call; 0: none so far
  std::atomic<bool> forked{false};  ///< OpenMP threads do not survive a fork; the child uses one thread
  std::atomic<int> away{0};         ///< threads that have released the interpreter's lock and will need it
  std::atomic<bool> ends{false};  ///< the interpreter ends in the thread `last`; others must not take its lock any more
  std::thread::id last{};

  static Guest& instance() {
    static Guest guest;
    [[maybe_unused]] static const int once = pthread_atfork(nullptr, nullptr, [] { guest.away = 0; });
    return guest;
  }

  bool is_over_for_this_thread() const { return ends && std::this_thread::get_id() != last; }

  /// Call before the interpreter ends: waits until daemon threads leave the library; they then stay outside the
  /// interpreter, which would terminate them inside C++.
  void end_of_interpreter() {
    last = std::this_thread::get_id();
    ends = true;
    PyThreadState* const released = PyEval_SaveThread();
    constexpr int kMostMilliseconds = 30'000;  // a callback may wait for ever
    for (int i = 0; away > 0 && i < kMostMilliseconds; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    PyEval_RestoreThread(released);
  }
};

/// The right to call the library, as a scope guard. Throws in a child that was forked while another thread was in the
/// library.
class Turn {
 public:
  Turn() : Turn(Guest::instance()) { start_as_guest(); }  // if it throws, the turn ends
  ~Turn() {
    Guest& guest = Guest::instance();
    set_number_of_threads(threads_);  // a run may have changed the number
    guest.mutex.unlock();
    --guest.visitors;
    if (released_ == nullptr) return;
    if (guest.is_over_for_this_thread()) stay_away(guest);
    PyEval_RestoreThread(released_);
    --guest.away;
  }
  Turn(const Turn&) = delete;
  Turn& operator=(const Turn&) = delete;

  /// Number of threads for a call: `wanted`, or one in a forked child.
  static std::optional<int> threads(std::optional<int> wanted) { return Guest::instance().forked ? 1 : wanted; }

 private:
  explicit Turn(Guest& guest) {
    const pid_t before = guest.process.exchange(getpid());
    if (before != 0 && before != getpid() && !survives_fork(guest, before))
      throw std::runtime_error(
          "this process was forked while another thread was running mixbeam; allowed: start it by the method spawn or "
          "forkserver of multiprocessing, or fork between runs");
    ++guest.visitors;
    if (PyGILState_Check() != 0) {
      ++guest.away;
      released_ = PyEval_SaveThread();
    }
    guest.mutex.lock();
    if (guest.is_over_for_this_thread()) {
      guest.mutex.unlock();
      stay_away(guest);
    }
    threads_ = number_of_threads();
    if (guest.forked) set_number_of_threads(1);
  }

  static bool survives_fork(Guest& guest, pid_t before) {
    if (guest.visitors > 0) {
      guest.process = before;  // the next call fails likewise
      return false;
    }
    guest.forked = true;
    omp_set_num_threads(1);  // for other libraries that use OpenMP
    return true;
  }

  /// Waits until the process ends.
  [[noreturn]] static void stay_away(Guest& guest) {
    --guest.away;
    for (;;) pause();
  }

  PyThreadState* released_ = nullptr;
  int threads_ = 1;  ///< number before the turn
};

/// Deletes objects of the library while holding a Turn.
struct DeleteInTurn {
  template <class Object>
  void operator()(Object* object) const noexcept {
    try {
      const Turn turn;
      delete object;
    } catch (const std::runtime_error&) {  // no turn in a forked child; the end of the process frees it
    }
  }
};

/// Handles signals of the host (Ctrl-C and others) and the user's callback during a run; the callback stops the run by
/// returning True. Their exceptions are kept until the run has ended.
class Listener {
 public:
  explicit Listener(pybind11::object callback) : callback_(std::move(callback)) {}

  /// Polled in every iteration.
  bool stops() {
    using Clock = std::chrono::steady_clock;
    constexpr auto kPatience = std::chrono::milliseconds(50);  // not noticeable; the lock is taken rarely
    if (stops_ || Clock::now() - heard_ < kPatience) return stops_;
    heard_ = Clock::now();
    if (Guest::instance().is_over_for_this_thread()) return stops_ = true;
    const pybind11::gil_scoped_acquire lock;
    keep([] {
      if (PyErr_CheckSignals() != 0) throw pybind11::error_already_set();
      return false;
    });
    return stops_;
  }

  template <class... Arguments>
  void call(const Arguments&... arguments) {
    if (callback_.is_none() || stops_ || Guest::instance().is_over_for_this_thread()) return;
    const pybind11::gil_scoped_acquire lock;
    keep([&] { return pybind11::bool_(callback_(arguments...)).cast<bool>(); });
  }

  /// Rethrows a kept exception; needs the interpreter's lock.
  void rethrow() {
    if (error_) std::rethrow_exception(std::exchange(error_, nullptr));
  }

 private:
  template <class Action>
  void keep(const Action& action) {
    try {
      stops_ = action() || stops_;
    } catch (...) {
      error_ = std::current_exception();
      stops_ = true;
    }
  }

  pybind11::object callback_;
  std::exception_ptr error_{};
  bool stops_ = false;
  std::chrono::steady_clock::time_point heard_ = std::chrono::steady_clock::now();
};

}  // namespace mixbeam
