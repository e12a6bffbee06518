/// Changes of a scene or of the solver's parameters that studies make; each returns a changed copy.
#pragma once

#include "discretization/scene/scene.hpp"
#include "nonlinear/parameters/solver_parameters.hpp"

namespace mixbeam {

/// Every member with this order and this number of elements.
Scene with_mesh(Scene scene, int order, int elements_per_member);

/// Equal load steps, this many for each stage.
SolverParameters with_fixed_steps(SolverParameters parameters, int steps);

}  // namespace mixbeam
