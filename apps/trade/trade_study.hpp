/// The study: every cell of the matrix on every benchmark, judged, tabulated, written.
#pragma once

#include "apps/common/application.hpp"

namespace mixbeam {

/// Declaration of the list "Study".
ListSpec trade_spec();

/// Computes the matrix of orders and meshes on the benchmarks that the study names. Checks the references against each
/// other and against closed forms, and rates of convergence against theory. Writes trade.csv, benchmarks.csv,
/// orders.csv, machine.csv, trade.md.
void run_trade_study(Application& app);

}  // namespace mixbeam
