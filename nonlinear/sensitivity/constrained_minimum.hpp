/// Minimum of a function under bounds and constraints, by sequential quadratic programming (SLSQP of NLopt).
#pragma once

#include "nonlinear/sensitivity/least_squares.hpp"

namespace mixbeam {

/// Minimises the first value such that the next `equations` values are zero and the others not positive. Gradient of a
/// step: that of the first value, projected on active constraints and bounds.
SearchResult minimise(const SearchProblem& problem, std::size_t equations);

/// Violation of a constraint that is negligible.
inline constexpr double kFeasible = 1e-8;

}  // namespace mixbeam
