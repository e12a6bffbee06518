/// The minimum of a function under bounds and constraints, by sequential quadratic programming (SLSQP of NLopt).
#pragma once

#include "nonlinear/sensitivity/least_squares.hpp"

namespace mixbeam {

/// The least first value; the next `equations` values shall be zero, the others shall not be positive. Gradients of a
/// step: what active constraints and bounds leave of that of the first value.
SearchResult minimise(const SearchProblem& problem, std::size_t equations);

/// Violation of a constraint that counts as none.
inline constexpr double kFeasible = 1e-8;

}  // namespace mixbeam
