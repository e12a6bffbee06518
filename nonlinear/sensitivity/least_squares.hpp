/// Least squares with bounds by Levenberg and Marquardt, and covariances of the unknowns. Unknowns are plain numbers,
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
  double gradient = 0.0;   ///< largest entry for unknowns that no bound holds; see the search for its definition
  double step = 0.0;       ///< largest change of an unknown
  double violation = 0.0;  ///< largest violation of a constraint
};

struct SearchProblem {
  SearchSpace space{};
  /// Evaluates values at these unknowns; none if that is not possible, and then a smaller step is tried.
  std::function<std::optional<std::vector<double>>(const std::vector<double>&)> values{};
  /// Evaluates derivatives (value, unknown) at the unknowns of the last values, from which the search continues.
  std::function<std::vector<double>()> derivatives{};
  std::function<void(const SearchStep&)> report{};
  std::function<bool()> stop{};  ///< asked before each step
};

enum class SearchEnd {
  found,
  stopped,     ///< stopped from outside
  blocked,     ///< not even the smallest step can be evaluated
  no_descent,  ///< no step decreases the objective, far from a minimum
  too_long
};

struct SearchResult {
  SearchEnd end = SearchEnd::found;
  std::vector<double> unknowns{}, values{}, derivatives{};
  std::vector<double> blocked_at{};  ///< unknowns of the last step that could not be evaluated
};

/// Minimises the sum of squares of the values. Gradient of a step: largest cosine between the values and the column of
/// an unknown that no bound holds.
SearchResult minimise_squares(const SearchProblem& problem);

/// Covariances of unknowns for residuals of unit variance; NaN for an unknown that a bound holds.
struct Information {
  std::vector<double> covariance{};  ///< (unknown, unknown); infinite if the residuals do not determine an unknown
  /// Directions of unknowns, with largest entry one, that change no residual.
  std::vector<std::vector<double>> untold{};
};
Information information_of(const std::vector<double>& jacobian, const std::vector<bool>& is_held);

}  // namespace mixbeam
