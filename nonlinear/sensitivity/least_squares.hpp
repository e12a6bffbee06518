/// Least squares with bounds by Levenberg and Marquardt, and what residuals say of their unknowns. Plain numbers,
/// scaled so that steps of one are large.
#pragma once

#include <functional>
#include <optional>
#include <vector>

namespace mixbeam {

/// Unknowns of a search and the bounds between which they stay.
struct SearchSpace {
  std::vector<double> start{}, lower{}, upper{};
};

/// An accepted point of a search.
struct SearchStep {
  int number = 0;
  std::vector<double> unknowns{};
  double objective = 0.0;
  double gradient = 0.0;   ///< largest entry over those that no bound holds, as the search says
  double step = 0.0;       ///< largest change of an unknown
  double violation = 0.0;  ///< of constraints, the largest
};

struct SearchProblem {
  SearchSpace space{};
  /// At these unknowns; none: where nothing can be evaluated, and then a smaller step is tried.
  std::function<std::optional<std::vector<double>>(const std::vector<double>&)> values{};
  /// Derivatives (value, unknown) at the unknowns of the last values, where the search goes on from.
  std::function<std::vector<double>()> derivatives{};
  std::function<void(const SearchStep&)> report{};
  std::function<bool()> stop{};  ///< asked before each step
};

enum class SearchEnd {
  found,
  stopped,     ///< from outside
  blocked,     ///< not even the smallest step can be evaluated
  no_descent,  ///< no step makes the objective smaller, far from a minimum
  too_long
};

struct SearchResult {
  SearchEnd end = SearchEnd::found;
  std::vector<double> unknowns{}, values{}, derivatives{};
  std::vector<double> blocked_at{};  ///< unknowns of the last step that could not be evaluated
};

/// The least sum of squares of the values. Gradients of a step: largest cosine between the values and the column of an
/// unknown that no bound holds.
SearchResult minimise_squares(const SearchProblem& problem);

/// Of unknowns with residuals of unit variance; NaN for one that a bound holds.
struct Information {
  std::vector<double> covariance{};  ///< (unknown, unknown); infinite where the residuals do not tell an unknown
  /// Changes of all unknowns together, largest one, that change no residual.
  std::vector<std::vector<double>> untold{};
};
Information information_of(const std::vector<double>& jacobian, const std::vector<bool>& is_held);

}  // namespace mixbeam
