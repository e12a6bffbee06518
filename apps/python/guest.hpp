/// Rules for a library in the process of another program: one call of the library at a time, the interpreter's lock
/// released meanwhile, its signals heard, its forks survived.
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

/// What the calls of this process share.
struct Guest {
  std::recursive_mutex mutex{};     ///< of the library: reference counts of Trilinos and Kokkos are not atomic
  std::atomic<int> visitors{0};     ///< that hold it or wait for it
  std::atomic<pid_t> process{0};    ///< that has called last; 0: none so far
  std::atomic<bool> forked{false};  ///< threads of OpenMP do not live on in a forked child, which works on one
  std::atomic<int> away{0};         ///< threads that are without the interpreter's lock, and will ask for it
  std::atomic<bool> ends{false};  ///< the interpreter, in the thread `last`: others must not ask for its lock any more
  std::thread::id last{};

  static Guest& instance() {
    static Guest guest;
    [[maybe_unused]] static const int once = pthread_atfork(nullptr, nullptr, [] { guest.away = 0; });
    return guest;
  }

  bool is_over_for_this_thread() const { return ends && std::this_thread::get_id() != last; }

  /// Before the interpreter ends: daemon threads come out of the library, and stay outside of the interpreter, which
  /// would end them in the midst of C++.
  void end_of_interpreter() {
    last = std::this_thread::get_id();
    ends = true;
    PyThreadState* const released = PyEval_SaveThread();
    constexpr int kMostMilliseconds = 30'000;  // a callback may wait for what never comes
    for (int i = 0; away > 0 && i < kMostMilliseconds; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    PyEval_RestoreThread(released);
  }
};

/// The right to call the library, for its own life. Throws where it can never be had: in the child of a process that
/// was forked while another of its threads was inside.
class Turn {
 public:
  Turn() : Turn(Guest::instance()) { start_as_guest(); }  // should it throw, the turn ends
  ~Turn() {
    Guest& guest = Guest::instance();
    set_number_of_threads(threads_);  // a run may have chosen a number
    guest.mutex.unlock();
    --guest.visitors;
    if (released_ == nullptr) return;
    if (guest.is_over_for_this_thread()) stay_away(guest);
    PyEval_RestoreThread(released_);
    --guest.away;
  }
  Turn(const Turn&) = delete;
  Turn& operator=(const Turn&) = delete;

  /// Threads that a call may use: `wanted`, or one in a forked child.
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
      guest.process = before;  // the next call hears the same
      return false;
    }
    guest.forked = true;
    omp_set_num_threads(1);  // for libraries below that use OpenMP on their own
    return true;
  }

  /// Until the process ends.
  [[noreturn]] static void stay_away(Guest& guest) {
    --guest.away;
    for (;;) pause();
  }

  PyThreadState* released_ = nullptr;
  int threads_ = 1;  ///< before
};

/// Deletes what the library has made, in turn.
struct DeleteInTurn {
  template <class Object>
  void operator()(Object* object) const noexcept {
    try {
      const Turn turn;
      delete object;
    } catch (const std::runtime_error&) {  // a child without a turn: the end of the process frees it
    }
  }
};

/// Listens to the host while a run goes on: Ctrl-C and other signals, and the callback of the user, which stops the run
/// by returning True. What they raise is kept until the run has come to its end.
class Listener {
 public:
  explicit Listener(pybind11::object callback) : callback_(std::move(callback)) {}

  /// Asked within every iteration.
  bool stops() {
    using Clock = std::chrono::steady_clock;
    constexpr auto kPatience = std::chrono::milliseconds(50);  // nobody notices, and the lock is asked for seldom
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

  /// With the lock of the interpreter.
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
