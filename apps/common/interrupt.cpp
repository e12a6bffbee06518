#include "apps/common/interrupt.hpp"

#include <Teuchos_CommHelpers.hpp>

#include <csignal>
#include <cstring>

#include <unistd.h>

namespace mixbeam {

namespace {

volatile std::sig_atomic_t requested = 0;

/// Only what is allowed in a signal handler: a flag, the default for the next signal, and a plain write.
void on_signal(int signal) {
  requested = 1;
  std::signal(signal, SIG_DFL);
  static constexpr char kText[] = "\nThe present step is finished and written; once more to end at once.\n";
  [[maybe_unused]] const auto written = write(STDERR_FILENO, kText, sizeof kText - 1);
}

}  // namespace

void watch_for_interrupts() {
  struct sigaction action;
  std::memset(&action, 0, sizeof action);
  action.sa_handler = on_signal;
  action.sa_flags = SA_RESTART;
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

bool interrupt_requested(const Communicator& communicator) {
  const int here = requested;
  if (communicator->getSize() == 1) return here != 0;
  int anywhere = 0;
  Teuchos::reduceAll(*communicator, Teuchos::REDUCE_MAX, here, Teuchos::outArg(anywhere));
  return anywhere != 0;
}

}  // namespace mixbeam
