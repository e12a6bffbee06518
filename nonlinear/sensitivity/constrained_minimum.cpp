#include "nonlinear/sensitivity/constrained_minimum.hpp"

#include <nlopt.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>

namespace mixbeam {

namespace {

/// Tolerances of unknowns and objective, which are of order one at the start of the search.
constexpr double kSettledUnknowns = 1e-9, kSettledObjective = 1e-12;
/// Projected gradient at a minimum, in the units of the search.
constexpr double kFlat = 1e-4;
/// Distance to its limit below which a constraint is active.
constexpr double kActive = 1e-6;
/// Distance to a bound, over one or the bound, at which an unknown is at it.
constexpr double kAtBound = 1e-12;
/// Distance of the end of a search to a point that could not be evaluated, over one or the unknown, if that stopped it.
constexpr double kBeside = 1e-2;
/// Largest change of an unknown, over one or its size: beyond, the line search continues with a tenth.
constexpr double kFarthest = 2.0;
constexpr int kMostEvaluations = 1000, kMostBlocked = 12;

class MinimumSearch {
 public:
  MinimumSearch(const SearchProblem& problem, std::size_t equations)
      : problem_(problem),
        equations_(equations),
        unknowns_(problem.space.start.size()),
        search_(nlopt_create(NLOPT_LD_SLSQP, static_cast<unsigned>(unknowns_)), nlopt_destroy) {}

  SearchResult run() {
    nlopt_opt search = search_.get();
    result_.unknowns = problem_.space.start;
    if (!go_to(result_.unknowns)) return ended(is_stopped_ ? SearchEnd::stopped : SearchEnd::blocked);
    const std::size_t inequalities = result_.values.size() - 1 - equations_;
    const std::vector<double> allowed(result_.values.size(), kFeasible);
    nlopt_set_lower_bounds(search, problem_.space.lower.data());
    nlopt_set_upper_bounds(search, problem_.space.upper.data());
    nlopt_set_min_objective(search, objective, this);
    if (equations_ > 0)
      nlopt_add_equality_mconstraint(search, static_cast<unsigned>(equations_), rows_of, &equality_, allowed.data());
    if (inequalities > 0)
      nlopt_add_inequality_mconstraint(search, static_cast<unsigned>(inequalities), rows_of, &inequality_,
                                       allowed.data());
    nlopt_set_xtol_rel(search, kSettledUnknowns);
    nlopt_set_ftol_rel(search, kSettledObjective);
    nlopt_set_ftol_abs(search, kSettledObjective);
    nlopt_set_maxeval(search, kMostEvaluations);
    double value = 0.0;
    const nlopt_result reason = nlopt_optimize(search, result_.unknowns.data(), &value);
    if (failure_) std::rethrow_exception(failure_);
    return ended(end_of(reason));
  }

 private:
  SearchResult ended(SearchEnd end) {
    result_.end = end;
    return result_;
  }

  SearchEnd end_of(nlopt_result reason) {
    const bool is_there = go_to(result_.unknowns);
    if (is_there) {
      look();
      result_.unknowns = at_;
    }
    if (is_stopped_) return SearchEnd::stopped;
    if (blocked_ >= kMostBlocked) return SearchEnd::blocked;
    if (reason == NLOPT_MAXEVAL_REACHED) return SearchEnd::too_long;
    if (is_there && gradient_left() <= kFlat && violation() <= kFeasible) return SearchEnd::found;
    return ends_beside_block() ? SearchEnd::blocked : SearchEnd::no_descent;
  }

  /// Whether steps have shrunk towards a point that could not be evaluated.
  bool ends_beside_block() const {
    for (std::size_t i = 0; i < result_.blocked_at.size(); ++i)
      if (std::abs(result_.blocked_at[i] - result_.unknowns[i]) >
          kBeside * std::max(1.0, std::abs(result_.unknowns[i])))
        return false;
    return !result_.blocked_at.empty();
  }

  /// Keeps the first exception until the end, since C code cannot pass it on.
  template <class Action>
  static void guarded(MinimumSearch& self, const Action& action) {
    if (self.failure_) return;
    try {
      action();
    } catch (...) {
      self.failure_ = std::current_exception();
      nlopt_force_stop(self.search_.get());
    }
  }

  static double objective(unsigned, const double* x, double* gradient, void* data) {
    MinimumSearch& self = *static_cast<MinimumSearch*>(data);
    double value = HUGE_VAL;
    guarded(self, [&] {
      if (!self.go_to({x, x + self.unknowns_})) return;
      if (gradient != nullptr) {
        self.look();
        std::copy_n(self.result_.derivatives.begin(), self.unknowns_, gradient);
      }
      value = self.result_.values[0];
    });
    return value;
  }
  /// Constraints, which are the values from `first` on.
  struct Constraints {
    const MinimumSearch* search;
    std::size_t first;
  };
  /// Returns constraints. NLopt evaluates them after the objective, at the same point.
  static void rows_of(unsigned m, double* values, unsigned n, const double*, double* gradient, void* data) {
    const auto& [search, first] = *static_cast<const Constraints*>(data);
    std::copy_n(search->result_.values.data() + first, m, values);
    if (gradient != nullptr) std::copy_n(search->result_.derivatives.data() + first * n, m * n, gradient);
  }

  /// Moves unknowns onto bounds from which only rounding separates them.
  std::vector<double> snapped(std::vector<double> x) const {
    for (std::size_t i = 0; i < unknowns_; ++i)
      for (const double bound : {problem_.space.lower[i], problem_.space.upper[i]})
        if (std::isfinite(bound) && std::abs(x[i] - bound) <= kAtBound * std::max(1.0, std::abs(bound))) x[i] = bound;
    return x;
  }

  bool go_to(const std::vector<double>& unknowns) {
    const std::vector<double> x = snapped(unknowns);
    if (x == at_) return true;
    if (problem_.stop()) {
      is_stopped_ = true;
      nlopt_force_stop(search_.get());
      return false;
    }
    for (std::size_t i = 0; i < x.size() && !looked_at_.empty(); ++i)
      if (std::abs(x[i] - looked_at_[i]) > kFarthest * std::max(1.0, std::abs(looked_at_[i]))) return false;
    const std::optional<std::vector<double>> values = problem_.values(x);
    if (!values) {
      at_.clear();
      result_.blocked_at = x;
      if (++blocked_ == kMostBlocked) nlopt_force_stop(search_.get());
      return false;
    }
    at_ = x;
    result_.values = *values;
    return true;
  }

  void look() {
    if (at_ == looked_at_) return;
    result_.derivatives = problem_.derivatives();
    double change = 0.0;
    for (std::size_t i = 0; i < unknowns_ && !looked_at_.empty(); ++i)
      change = std::max(change, std::abs(at_[i] - looked_at_[i]));
    looked_at_ = at_;
    blocked_ = 0;
    problem_.report({steps_++, at_, result_.values[0], gradient_left(), change, violation()});
  }

  double violation() const {
    double largest = 0.0;
    for (std::size_t k = 1; k < result_.values.size(); ++k)
      largest = std::max(largest, k <= equations_ ? std::abs(result_.values[k]) : result_.values[k]);
    return largest;
  }

  bool is_active(std::size_t constraint) const {
    return constraint <= equations_ || result_.values[constraint] >= -kActive;
  }
  /// Largest component of the gradient orthogonal to those of active constraints, over unknowns that no bound holds. A
  /// bound holds an unknown that would decrease the objective beyond it or, with active constraints, any at it.
  double gradient_left() const {
    std::vector<std::size_t> rows = {0};
    for (std::size_t k = 1; k < result_.values.size(); ++k)
      if (is_active(k)) rows.push_back(k);
    std::vector<std::vector<double>> normals;
    for (auto row = rows.rbegin();; ++row) {  // the objective last
      double largest = 0.0, size = 0.0;
      std::vector<double> left(unknowns_, 0.0);
      for (std::size_t i = 0; i < unknowns_; ++i) {
        const double slope = rows.size() > 1 ? 0.0 : result_.derivatives[i];
        const bool is_held =
            (at_[i] <= problem_.space.lower[i] && slope >= 0.0) || (at_[i] >= problem_.space.upper[i] && slope <= 0.0);
        if (!is_held) left[i] = result_.derivatives[*row * unknowns_ + i];
      }
      for (const std::vector<double>& normal : normals) {
        const double along = std::inner_product(left.begin(), left.end(), normal.begin(), 0.0);
        for (std::size_t i = 0; i < unknowns_; ++i) left[i] -= along * normal[i];
      }
      for (const double one : left) {
        largest = std::max(largest, std::abs(one));
        size = std::hypot(size, one);
      }
      if (*row == 0) return largest;
      if (size <= kActive) continue;
      for (double& one : left) one /= size;
      normals.push_back(std::move(left));
    }
  }

  const SearchProblem& problem_;
  std::size_t equations_;
  std::size_t unknowns_;
  Constraints equality_{this, 1}, inequality_{this, 1 + equations_};
  std::unique_ptr<nlopt_opt_s, void (*)(nlopt_opt)> search_;
  SearchResult result_{};
  std::vector<double> at_{}, looked_at_{};  ///< unknowns of the last values and derivatives
  std::exception_ptr failure_{};
  bool is_stopped_ = false;
  int blocked_ = 0;  ///< since the last derivatives
  int steps_ = 0;
};

}  // namespace

SearchResult minimise(const SearchProblem& problem, std::size_t equations) {
  return MinimumSearch(problem, equations).run();
}

}  // namespace mixbeam
