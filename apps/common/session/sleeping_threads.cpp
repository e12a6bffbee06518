#include "apps/common/session/sleeping_threads.hpp"

#include <omp.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <future>
#include <thread>

namespace mixbeam {

namespace {

/// libgomp reads how long to spin when it is loaded, long before main(), and starting again with another environment
/// costs 35 ms. But it looks at each wait whether it has more threads than there are processors, and then spins 100
/// times instead of 300,000 (do_spin in its config/linux/wait.h, gomp_managed_threads). So a thread that never works
/// opens a team as large as the machine and sleeps in it, and the team of the program makes one too many. With another
/// OpenMP library this changes nothing.
void crowd(std::promise<void>& ready) {
  sigset_t all;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, nullptr);  // signals are for the main thread
  [[maybe_unused]] int members = 0;
  const int machine = std::max(omp_get_num_procs(), omp_get_max_threads());  // now, and when libgomp was loaded
#pragma omp parallel num_threads(machine) reduction(+ : members)
  ++members;
  ready.set_value();
  for (;;) pause();
}

bool crowd_once() {
  std::promise<void> ready;
  std::thread([&ready] { crowd(ready); }).detach();
  ready.get_future().wait();
  return true;
}

}  // namespace

void let_waiting_threads_sleep() {
  if (std::getenv("OMP_WAIT_POLICY") != nullptr || std::getenv("GOMP_SPINCOUNT") != nullptr) return;
  [[maybe_unused]] static const bool done = crowd_once();
}

}  // namespace mixbeam
