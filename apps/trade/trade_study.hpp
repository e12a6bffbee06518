/// The study: every cell of the matrix on every benchmark, judged, tabulated, written.
#pragma once

#include "apps/common/run/application.hpp"

namespace mixbeam {

/// Declaration of the list "Study".
ListSpec trade_spec();

/// Computes the matrix of orders and meshes on the benchmarks that the study names, and what the program makes of
/// wanted accuracies on them and on the scenes of the gallery. Checks the references against each other and against
/// closed forms, rates of convergence against theory, errors against the accuracies. Writes the tables of
/// trade_tables.hpp, estimates.csv, machine.csv, trade.md.
void run_trade_study(Application& app);

}  // namespace mixbeam
