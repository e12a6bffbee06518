/// Cost of one Newton iteration against size, order and number of threads.
#pragma once

#include "apps/common/run/application.hpp"

namespace mixbeam {

/// Declaration of the list "Study".
ListSpec scaling_spec();

/// For each kind, size, order and number of threads: median wall time of the phases of an iteration, as a multiple of
/// the unit of time (see ChainUnit), against the machine's ceilings, and memory. Each case has a process of its own.
/// Writes machine.csv, ceilings.csv, thread_scaling.csv and cases.csv, prints the tables.
void run_scaling_study(Application& app);

}  // namespace mixbeam
