/// The paper's study of the structure with slope discontinuity.
#pragma once

#include "apps/common/run/application.hpp"

namespace mixbeam {

/// Declaration of the list "Study".
ListSpec slope_study_spec();

/// Table of orders and meshes beside the paper's; shapes under growing load (single.h5); load-displacement curve
/// (load_displacement.csv); the fully loaded state must not depend on the number of load steps.
void run_slope_study(Application& app);

}  // namespace mixbeam
