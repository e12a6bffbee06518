/// Whether a user wants the path of a scene, or its end only.
#pragma once

#include "discretization/checks/expected_values.hpp"
#include "nonlinear/parameters/solver_parameters.hpp"

#include <string>
#include <vector>

namespace mixbeam {

/// Whether the solver's parameters or the expected values of this load case ("": of a scene without any) ask for steps
/// on the way to the end. `scene`: of the case.
bool asks_for_path(const SolverParameters& parameters, const std::vector<ExpectedValue>& expected,
                   const std::string& load_case, const Scene& scene);

}  // namespace mixbeam
