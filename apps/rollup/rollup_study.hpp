/// The paper's study of the rod bent to a double circle: error of the centerline over meshes, element orders,
/// slendernesses and integration of the force strains.
#pragma once

#include "apps/common/run/application.hpp"

namespace mixbeam {

/// Declaration of the list "Study".
ListSpec rollup_spec();

/// Records the scene as it stands (single.h5); checks what pure bending gives exactly, and in how many iterations;
/// writes convergence.csv, prints the errors of the centerline, checks their rates and which elements lock.
void run_rollup_study(Application& app);

}  // namespace mixbeam
