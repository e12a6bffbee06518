/// The study: both ways of every economy, timed in turn, tabulated, written.
#pragma once

#include "apps/common/run/application.hpp"
#include "apps/economies/economy.hpp"

namespace mixbeam {

struct TimedWay {
  double seconds = 0.0;  ///< wall time from the scene to the answer, reading left out; median
  int iterations = 0, load_steps = 0;
  Vector3 tip{};  ///< displacement
};

struct EconomyResult {
  Economy economy;
  TimedWay plain, other;
  double difference() const;  ///< of the tip's displacement, relative
  double ratio() const { return other.seconds / plain.seconds; }
};

/// Declaration of the list "Study".
ListSpec economies_spec();

/// Checks that both ways give the same answer; times are shown, not judged. Writes economies.csv, machine.csv,
/// economies.md.
void run_economies_study(Application& app);

}  // namespace mixbeam
