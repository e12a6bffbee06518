#include "nonlinear/sensitivity/least_squares.hpp"

#include <gsl/gsl_linalg.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

namespace mixbeam {

namespace {

/// Accuracy of unknowns of order one, which quadratic convergence exceeds in its last step.
constexpr double kSmallestMove = 1e-10;
/// Cosine below which residuals of measurements count as orthogonal to all columns.
constexpr double kOrthogonal = 1e-9;
/// Share of the objective that is rounding.
constexpr double kHidden = 1e-14;
constexpr int kMostSearchSteps = 200, kMostTrials = 24;
/// Marquardt's damping, relative to the squares of columns: initial and least value, and factors of its changes.
constexpr double kDampingAtStart = 1e-4, kLeastDamping = 1e-14, kLessDamping = 0.1, kMoreDamping = 10.0;
/// Share of the predicted descent with which a step is accepted.
constexpr double kSufficient = 1e-4;
/// Least length of a column for its damping, over the longest one.
constexpr double kDampedColumn = 1e-3;
/// Limit of the change of an unknown in a step, over its size or one, within which linear equations may hold.
constexpr double kMostChange = 2.0;
/// Ratio of singular values below which a direction is undetermined: a hundred times the error of derivatives.
constexpr double kUntold = 1e-8;
/// Ratio of an entry of such a direction to its largest one above which its unknown is undetermined.
constexpr double kTakesPart = 1e-4;

using GslMatrix = std::unique_ptr<gsl_matrix, void (*)(gsl_matrix*)>;
using GslVector = std::unique_ptr<gsl_vector, void (*)(gsl_vector*)>;

/// Decomposition A = U S V^T; A has at least as many rows as columns.
struct SingularValues {
  GslMatrix u, v;
  GslVector s;

  explicit SingularValues(GslMatrix a)
      : u(std::move(a)), v(gsl_matrix_alloc(u->size2, u->size2), gsl_matrix_free), s(vector(u->size2)) {
    const GslVector work = vector(u->size2);
    gsl_linalg_SV_decomp(u.get(), v.get(), s.get(), work.get());
  }
  static GslVector vector(std::size_t n) { return {gsl_vector_calloc(n), gsl_vector_free}; }
  /// Allocates a matrix of zeros.
  static GslMatrix matrix(std::size_t rows, std::size_t columns) {
    return {gsl_matrix_calloc(rows, columns), gsl_matrix_free};
  }
};

double square_sum(const std::vector<double>& numbers) {
  double sum = 0.0;
  for (const double one : numbers) sum += one * one;
  return sum;
}

class LeastSquaresSearch {
 public:
  explicit LeastSquaresSearch(const SearchProblem& problem)
      : problem_(problem), unknowns_(problem.space.start.size()) {}

  SearchResult run() {
    result_.unknowns = problem_.space.start;
    std::optional<std::vector<double>> residuals = problem_.values(result_.unknowns);
    if (!residuals) return ended(SearchEnd::blocked);
    result_.values = std::move(*residuals);
    double move = 0.0;
    for (int number = 0;; ++number) {
      look();
      problem_.report({number, result_.unknowns, square_sum(result_.values), cosine_, move, 0.0});
      if (cosine_ <= kOrthogonal) return ended(SearchEnd::found);
      if (number == kMostSearchSteps) return ended(SearchEnd::too_long);
      if (problem_.stop()) return ended(SearchEnd::stopped);
      const std::optional<SearchEnd> end = step(move);
      if (end) return ended(*end);
    }
  }

 private:
  SearchResult ended(SearchEnd end) {
    result_.end = end;
    return result_;
  }
  double entry(std::size_t residual, std::size_t unknown) const {
    return result_.derivatives[residual * unknowns_ + unknown];
  }

  /// Evaluates derivatives, and determines which bounds hold, at the present point.
  void look() {
    result_.derivatives = problem_.derivatives();
    columns_.assign(unknowns_, 0.0);
    held_.assign(unknowns_, false);
    cosine_ = 0.0;
    const double size = std::sqrt(square_sum(result_.values));
    for (std::size_t i = 0; i < unknowns_; ++i) {
      double slope = 0.0;
      for (std::size_t k = 0; k < result_.values.size(); ++k) {
        columns_[i] += entry(k, i) * entry(k, i);
        slope += entry(k, i) * result_.values[k];
      }
      columns_[i] = std::sqrt(columns_[i]);
      const double x = result_.unknowns[i];
      held_[i] = (x <= problem_.space.lower[i] && slope >= 0.0) || (x >= problem_.space.upper[i] && slope <= 0.0);
      const double sizes = columns_[i] * size;
      if (!held_[i] && sizes > 0.0) cosine_ = std::max(cosine_, std::abs(slope) / sizes);
    }
  }

  /// Takes a step; returns why the search ends, none: it continues.
  std::optional<SearchEnd> step(double& move) {
    const double before = square_sum(result_.values);
    double share = 1.0;  // of the step, reduced if its end cannot be evaluated
    for (int trial = 0; trial < kMostTrials; ++trial) {
      std::vector<double> change = bounded_change();
      move = 0.0;
      for (double& one : change) move = std::max(move, std::abs(one *= share));
      double largest = 1.0;
      for (const double one : result_.unknowns) largest = std::max(largest, std::abs(one));
      const double predicted = before - square_sum(linear(change));
      if (move <= kSmallestMove * largest || predicted <= kHidden * before)
        return share < 1.0 ? SearchEnd::blocked : SearchEnd::found;
      std::vector<double> there(unknowns_);
      for (std::size_t i = 0; i < unknowns_; ++i)
        there[i] = std::clamp(result_.unknowns[i] + change[i], problem_.space.lower[i], problem_.space.upper[i]);
      std::optional<std::vector<double>> residuals = problem_.values(there);
      if (!residuals) {
        share *= 0.5;
        result_.blocked_at = there;
        continue;
      }
      if (before - square_sum(*residuals) < kSufficient * predicted) {
        damping_ *= kMoreDamping;
        continue;
      }
      damping_ = std::max(damping_ * kLessDamping, kLeastDamping);
      result_.unknowns = there;
      result_.values = std::move(*residuals);
      return {};
    }
    return share < 1.0 ? SearchEnd::blocked : SearchEnd::no_descent;
  }

  /// Residuals of the linear equations after a change.
  std::vector<double> linear(const std::vector<double>& change) const {
    std::vector<double> residuals = result_.values;
    for (std::size_t k = 0; k < residuals.size(); ++k)
      for (std::size_t i = 0; i < unknowns_; ++i) residuals[k] += entry(k, i) * change[i];
    return residuals;
  }

  /// Minimises |r + J d|^2 + damping |D d|^2 over unknowns that no bound holds, D the lengths of columns; clamps d to
  /// bounds and to kMostChange. An unknown that reaches its bound is held in the next step, if its slope is outward.
  std::vector<double> bounded_change() const {
    std::vector<std::size_t> free;
    for (std::size_t i = 0; i < unknowns_; ++i)
      if (!held_[i]) free.push_back(i);
    std::vector<double> change(unknowns_, 0.0);
    const std::size_t m = result_.values.size(), n = free.size();
    if (n == 0) return change;
    const double longest = *std::max_element(columns_.begin(), columns_.end());
    GslMatrix a = SingularValues::matrix(m + n, n);
    const GslVector right = SingularValues::vector(m + n), d = SingularValues::vector(n);
    for (std::size_t k = 0; k < m; ++k) {
      gsl_vector_set(right.get(), k, -result_.values[k]);
      for (std::size_t j = 0; j < n; ++j) gsl_matrix_set(a.get(), k, j, entry(k, free[j]));
    }
    for (std::size_t j = 0; j < n; ++j)
      gsl_matrix_set(a.get(), m + j, j, std::sqrt(damping_) * std::max(columns_[free[j]], kDampedColumn * longest));
    const SingularValues svd(std::move(a));
    gsl_linalg_SV_solve(svd.u.get(), svd.v.get(), svd.s.get(), right.get(), d.get());
    for (std::size_t j = 0; j < n; ++j) {
      const std::size_t i = free[j];
      const double x = result_.unknowns[i], far = kMostChange * std::max(1.0, std::abs(x));
      change[i] = std::clamp(gsl_vector_get(d.get(), j), std::max(problem_.space.lower[i] - x, -far),
                             std::min(problem_.space.upper[i] - x, far));
    }
    return change;
  }

  const SearchProblem& problem_;
  std::size_t unknowns_;
  SearchResult result_;
  std::vector<double> columns_{};  ///< lengths of the columns of J
  std::vector<bool> held_{};
  double cosine_ = 0.0, damping_ = kDampingAtStart;
};

}  // namespace

SearchResult minimise_squares(const SearchProblem& problem) { return LeastSquaresSearch(problem).run(); }

Information information_of(const std::vector<double>& jacobian, const std::vector<bool>& is_held) {
  const std::size_t all = is_held.size(), m = jacobian.size() / all;
  std::vector<std::size_t> free;
  for (std::size_t i = 0; i < all; ++i)
    if (!is_held[i]) free.push_back(i);
  const std::size_t n = free.size();
  Information found;
  found.covariance.assign(all * all, std::numeric_limits<double>::quiet_NaN());
  if (n == 0) return found;
  GslMatrix a = SingularValues::matrix(std::max(m, n), n);
  for (std::size_t k = 0; k < m; ++k)
    for (std::size_t j = 0; j < n; ++j) gsl_matrix_set(a.get(), k, j, jacobian[k * all + free[j]]);
  const SingularValues svd(std::move(a));
  std::vector<bool> is_told(n, true);
  std::vector<double> sums(n * n, 0.0);
  for (std::size_t d = 0; d < n; ++d) {
    const auto entry = [&svd, d](std::size_t j) { return gsl_matrix_get(svd.v.get(), j, d); };
    const double value = gsl_vector_get(svd.s.get(), d);
    if (value > kUntold * gsl_vector_get(svd.s.get(), 0)) {
      for (std::size_t i = 0; i < n * n; ++i) sums[i] += entry(i / n) * entry(i % n) / (value * value);
      continue;
    }
    double largest = 0.0;
    for (std::size_t j = 0; j < n; ++j)
      if (std::abs(entry(j)) > std::abs(largest)) largest = entry(j);
    found.untold.emplace_back(all, 0.0);
    for (std::size_t j = 0; j < n; ++j) {
      found.untold.back()[free[j]] = entry(j) / largest;
      is_told[j] = is_told[j] && std::abs(entry(j)) <= kTakesPart * std::abs(largest);
    }
  }
  for (std::size_t i = 0; i < n * n; ++i)
    found.covariance[free[i / n] * all + free[i % n]] =
        is_told[i / n] && is_told[i % n] ? sums[i] : std::numeric_limits<double>::infinity();
  return found;
}

}  // namespace mixbeam
