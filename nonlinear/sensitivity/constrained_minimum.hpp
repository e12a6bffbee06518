/// The minimum of a function under bounds and constraints, by sequential quadratic programming (SLSQP of NLopt). Plain
/// numbers, scaled as those of least squares.
#pragma once

#include "nonlinear/sensitivity/least_squares.hpp"

namespace mixbeam {

struct ConstrainedMinimum {
  SearchSpace space{};
  /// After the objective, the first of the values: those that shall be zero, then those that shall not be positive.
  std::size_t equations = 0, inequalities = 0;
  /// At these unknowns; none: where nothing can be evaluated, and then a smaller step is tried.
  std::function<std::optional<std::vector<double>>(const std::vector<double>&)> values{};
  /// Derivatives (value, unknown) at the unknowns of the last values, where the search goes on from.
  std::function<std::vector<double>()> derivatives{};
  std::function<void(const SearchStep&)> report{};
  std::function<bool()> stop{};  ///< asked before each evaluation
};

struct ConstrainedMinimumResult {
  SearchEnd end = SearchEnd::found;
  std::vector<double> unknowns{};    ///< the best that were found
  double violation = 0.0;            ///< of constraints there
  std::vector<double> blocked_at{};  ///< unknowns of the last step that could not be evaluated
};

/// Gradients of a step: what active constraints and bounds leave of that of the objective.
ConstrainedMinimumResult minimise(const ConstrainedMinimum& problem);

/// Violation of a constraint that counts as none.
inline constexpr double kFeasible = 1e-8;

}  // namespace mixbeam
