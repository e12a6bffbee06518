/// Thread scaling of one Newton iteration.
#pragma once

#include "apps/common/application.hpp"

namespace mixbeam {

/// Declaration of the list "Study".
ListSpec scaling_spec();

/// For each size, order and number of threads: median wall time of residual, element tangent, assembly, factorisation,
/// solve, recovery and update, over iterations in which the numbers of threads take turns (a shared machine drifts;
/// ratios of neighbouring runs do not). Writes thread_scaling.csv, prints the table.
void run_scaling_study(Application& app);

}  // namespace mixbeam
