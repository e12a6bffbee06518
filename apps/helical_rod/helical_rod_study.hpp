/// The study of the rod bent to helical shape: the paper's table, the evolution of the tip, strains, shapes, and the
/// independence of the final state from the load steps.
#pragma once

#include "apps/common/run/application.hpp"

namespace mixbeam {

/// Declaration of the list "Study".
ListSpec helical_rod_study_spec();

/// Prints and checks the paper's table; writes load_displacement.csv, strains_k*.csv, shape_k*.csv,
/// path_independence.csv.
void run_helical_rod_study(Application& app);

}  // namespace mixbeam
