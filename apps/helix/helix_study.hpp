/// The study of the helix experiment: accuracy at the vertices and between them, over order, mesh and slenderness.
#pragma once

#include "apps/common/run/application.hpp"

namespace mixbeam {

/// Declaration of the list "Study".
ListSpec helix_study_spec();

/// Prints and checks the paper's statements, writes convergence.csv, order1.h5, order3.h5.
void run_helix_study(Application& app);

}  // namespace mixbeam
