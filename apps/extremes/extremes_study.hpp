/// The study: every sweep computed, tabulated, written.
#pragma once

#include "apps/common/run/application.hpp"
#include "apps/extremes/sweeps.hpp"

namespace mixbeam {

/// One value of a sweep, computed.
struct SweepRow {
  double value = 0.0;
  bool converged = false;
  int load_steps = 0, failed_steps = 0, iterations = 0;
  double error = 0.0;              ///< Cantilever::error
  double residual = 0.0;           ///< scaled, of the last converged step
  double condition = 0.0;          ///< Simulation::condition_estimate
  double seconds = 0.0;            ///< wall time, condition estimate left out
  double processor_seconds = 0.0;  ///< the same of all threads together: what a busy machine does not lengthen
  std::string failure;             ///< why the run ended early
};

struct SweepResult {
  Sweep sweep;
  std::vector<SweepRow> rows;
};

/// Declaration of the list "Study".
ListSpec extremes_spec();

/// Computes the sweeps that the study names; checks errors where a sweep promises one, records the others. Writes
/// extremes.csv, machine.csv, extremes.md.
void run_extremes_study(Application& app);

}  // namespace mixbeam
