/// Evaluation of what a list "Expected" asks for.
#pragma once

#include "discretization/checks/expected_values.hpp"
#include "nonlinear/run/simulation.hpp"

#include <optional>

namespace mixbeam {

/// Component of a vector by the names of the list "Expected".
double component_of(const Vector3& vector, const std::string& name);

/// The present value of one of common_quantities(); none for a quantity of the application's own. Collective.
std::optional<double> present_value(const Simulation& simulation, const ExpectedValue& wanted);

}  // namespace mixbeam
