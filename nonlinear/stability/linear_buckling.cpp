#include "nonlinear/stability/linear_buckling.hpp"

#include "discretization/mesh/element_view.hpp"
#include "nonlinear/newton/step.hpp"
#include "nonlinear/stability/block_krylov.hpp"
#include "nonlinear/stability/thresholds.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

namespace mixbeam {

namespace {

/// Number of refinements for the cap. Each gains the ratio of the cap to the forces, five digits: three reach rounding.
constexpr int kRefinements = 3;

/// Step of the load factor for the slope of line loads: accurate to all digits for ramps.
constexpr double kSlopeStep = 1.0 / 1024.0;

/// A structure in equilibrium, undeformed or under the loads of its first stages, with the stresses of its linear
/// response to the subsequent loads. Load factors are relative to that of the state. Throws LinearSolverError if the
/// structure is not stable there.
class StressedStructure {
 public:
  /// `state`: in equilibrium at `load_factor`, where the subsequent loads begin to act.
  StressedStructure(BeamProblem& problem, const State& state, double load_factor)
      : problem_(problem),
        model_(problem.model),
        unknowns_(model_),
        reference_(state),
        base_(load_factor),
        scales_(scales_of(model_, reference_, base_)),
        cap_(cap_for(model_, scales_, stability_limit.cap_of_count)),
        response_(model_.create_vector()),
        work_(model_.create_vector()) {
    find_response();
    keep_stresses();
    unknowns_.reduce(tangent_at(reference_));
    factorize();
  }
  StressedStructure(const StressedStructure&) = delete;
  StressedStructure& operator=(const StressedStructure&) = delete;

 protected:
  /// Tangent with the cap of the reference state, so that differences of tangents are not those of caps.
  /// `line_loads`, `other_loads`: their load factors. Line loads grow with their initial slope.
  Tangent tangent_at(const State& state, double line_loads = 0.0, double other_loads = 0.0) {
    EvaluationPoint point = point_at(state, other_loads);
    if (line_loads != other_loads) {
      const auto fields = [&](double load_factor) { return point_at(reference_, load_factor).line_fields; };
      const KernelView<double*[3]> first = fields(0.0), last = fields(kSlopeStep);
      point.line_fields = KernelView<double* [3]>("mixbeam::line_loads", first.extent(0));
      for (size_t i = 0; i < first.extent(0); ++i)
        for (int c = 0; c < 3; ++c)
          point.line_fields(i, c) = first(i, c) + line_loads / kSlopeStep * (last(i, c) - first(i, c));
    }
    return Tangent(model_, point, cap_, {true, true});
  }
  EvaluationPoint point_at(const State& state, double load_factor) {
    EvaluationPoint point = mixed_residual(model_, state, base_ + load_factor, work_);
    point.scales = scales_;
    return point;
  }
  /// Stiffness at the stresses and line loads of a load factor, without other loads: follower line loads also act on
  /// condensed interiors. About a stressed state the additional stresses are in balance with the motion that they
  /// cause, which is not applied: the moments left unbalanced are the skew part of a stiffness that is symmetric along
  /// the path, and are removed.
  Tangent stiffness_at(double load_factor, std::vector<double>& values) {
    const State state = state_at(load_factor);
    std::vector<double> skew;
    if (base_ != 0.0 && symmetric_) {
      const SparseMatrix by_stress = unknowns_.reduce(tangent_at(state));
      skew = symmetric_part(by_stress).value;
      for (size_t i = 0; i < skew.size(); ++i) skew[i] = by_stress.value[i] - skew[i];
    }
    Tangent tangent = tangent_at(state, load_factor);
    values = unknowns_.reduce(tangent).value;
    for (size_t i = 0; i < skew.size(); ++i) values[i] -= skew[i];
    return tangent;
  }
  /// Reference state with the stresses of a load factor.
  State state_at(double load_factor) { return model_.apply(reference_, response_, load_factor); }

  /// Largest of N L^2/EI and M L/EI per load factor.
  double largest_stress() const {
    const Structure& structure = model_.structure();
    const double L = structure.length, EI = structure.bending_reference;
    double largest = 0.0;
    for_each_element(structure, [&](const ElementView& element) {
      const double* row = element.increments_in(response_.interior());
      for (int i = 0; i < element.layout().relative_rotation(1); ++i)
        largest = std::max(largest, std::abs(row[i]) * (i < element.layout().moment(0) ? L * L : L) / EI);
    });
    return maximum_over_ranks(*model_.map()->getComm(), largest);
  }

  /// Computes K_g = (4 D(t) - D(2t))/3 with central differences D of stiffness_at(), at factor zero of other loads,
  /// since a ramp has no negative side; their part, linear in the factor, is added from the reference state.
  std::vector<double> geometric_stiffness(double t) {
    std::vector<double> result(matrix_.value.size(), 0.0), k;
    const auto add = [&](double factor, double load_factor) {
      stiffness_at(load_factor, k);
      for (size_t i = 0; i < result.size(); ++i) result[i] += factor * k[i];
    };
    for (double sign : {1.0, -1.0}) {
      add(sign * 4.0 / (6.0 * t), sign * t);
      add(-sign / (12.0 * t), sign * 2.0 * t);
    }
    const double load_factor = std::min(t, 1.0);
    by_loads_ = unknowns_.reduce(tangent_at(reference_, 0.0, load_factor)).value;
    for (size_t i = 0; i < by_loads_.size(); ++i) {
      by_loads_[i] = (by_loads_[i] - matrix_.value[i]) / load_factor;
      result[i] += by_loads_[i];
    }
    return result;
  }

  /// Evaluates K at the stresses and loads of a load factor, interiors condensed exactly.
  Tangent tangent_under_stress(double load_factor) {
    under_stress_.row_start = matrix_.row_start;
    under_stress_.column = matrix_.column;
    Tangent tangent = stiffness_at(load_factor, under_stress_.value);
    for (size_t i = 0; i < by_loads_.size(); ++i) under_stress_.value[i] += load_factor * by_loads_[i];
    return tangent;
  }

  InertiaSolver::Signs factorize_under_stress() {
    const auto kind = pencil_symmetric_ ? InertiaSolver::Kind::symmetric : InertiaSolver::Kind::general;
    if (moving_solver_ == nullptr) moving_solver_ = std::make_unique<InertiaSolver>(kind, under_stress_);
    return moving_solver_->factorize(under_stress_);
  }

  BeamProblem& problem_;
  const Model& model_;
  IndependentUnknowns unknowns_;
  State reference_;
  double base_;  ///< its load factor
  ResidualScales scales_;
  Cap cap_;
  MixedVector response_, work_;
  bool symmetric_ = true;         ///< without the subsequent loads
  bool pencil_symmetric_ = true;  ///< including subsequent stresses and loads
  std::vector<double> by_loads_;
  SparseMatrix matrix_, under_stress_;
  std::unique_ptr<InertiaSolver> solver_, moving_solver_;

 private:
  /// Solves for dx / d(load factor) at the reference state, due to loads that begin to act there, with the capped
  /// tangent, and refines to the true one: the cap would change how forces are distributed by stiffness.
  void find_response() {
    Linearization linearization(problem_, point_at(reference_, 0.0), cap_for(model_, scales_), {true, false});
    MixedVector rhs = model_.create_vector();
    load_derivative(model_, reference_, base_, scales_, rhs);
    linearization.solve(rhs, response_);
    MixedVector correction = response_.clone(true);
    for (int i = 0; i < kRefinements; ++i) {
      linearization.cap_compliance_rows(correction, rhs);
      linearization.solve(rhs, correction);
      response_.update(1.0, correction, 1.0);
    }
  }

  /// Keeps only N and M of the response: in the linear theory of buckling stresses act on the undeformed structure.
  /// With displacements the pencil would be that of a stiffness C rotated by a linearised rotation, C + lambda
  /// (theta C - C theta), which is singular at lambda theta ~ sqrt(ratio of stiffnesses): meaningless factors of both
  /// signs that depend on the mesh.
  void keep_stresses() {
    Kokkos::deep_copy(response_.vertex(), 0.0);
    clear_rows(model_.structure(), response_.writable_interior(true), RowsOf::motions);
  }

  void factorize() {
    on_root(unknowns_.root(), [&] {
      symmetric_ = asymmetry(unknowns_.matrix()) <= stability_limit.symmetric;
      matrix_ = unknowns_.matrix();
      const auto kind = symmetric_ ? InertiaSolver::Kind::symmetric : InertiaSolver::Kind::general;
      solver_ = std::make_unique<InertiaSolver>(kind, matrix_);
      const InertiaSolver::Signs signs = solver_->factorize(matrix_);
      if (signs.null > 0 || signs.negative > 0)
        throw LinearSolverError(base_ == 0.0 ? "linear buckling needs a structure that is stable without loads"
                                             : "linear buckling needs a state that is stable");
    });
    int symmetric = symmetric_ ? 1 : 0;
    unknowns_.root().share(&symmetric, 1, MPI_INT);
    symmetric_ = symmetric != 0;
  }
};

/// Key for sorting factors by magnitude; of a pair of both signs the positive one comes first, whatever the rounding.
double rank(double factor) { return std::abs(factor) * (factor < 0.0 ? 1.0 + stability_limit.same_size : 1.0); }

class LinearBuckling : private StressedStructure {
 public:
  using StressedStructure::StressedStructure;

  std::vector<EigenMode> modes(int count) {
    const double stress = largest_stress();
    if (stress == 0.0) return {};
    const std::vector<Factor> found = factors_of_pencil(1, stability_limit.first_stress / stress);
    if (found.empty()) return {};
    return improved(factors_of_pencil(count, stability_limit.difference_step * std::abs(found.front().value)));
  }

 private:
  struct Factor {
    double value = 0.0, residual = 0.0;
    std::vector<double> y, left;  ///< modes of the tangent and of its transpose
    bool confirmed = false;
  };

  /// Finds the factors of K_0 + lambda K_g, by differences over t: condensed tangents, too low by 1e-5 due to the cap.
  std::vector<Factor> factors_of_pencil(int count, double t) {
    const std::vector<double> geometric = geometric_stiffness(t);
    std::vector<double> inverse_factor;
    std::vector<std::vector<double>> y;
    on_root(unknowns_.root(), [&] {
      SparseMatrix prestress = matrix_;
      prestress.value = geometric;
      pencil_symmetric_ = symmetric_ && asymmetry_of(prestress, t) <= stability_limit.symmetric;
      KrylovProblem eigen;
      eigen.unknowns = unknowns_.count();
      eigen.symmetric = pencil_symmetric_;
      eigen.apply = [&](double* block, int columns) { apply(prestress, block, columns); };
      if (eigen.symmetric) eigen.inner = [&](const double* x, double* kx) { matrix_.multiply(x, kx); };
      for (RitzPair& pair : largest_eigenpairs(eigen, count)) {
        if (pair.value == 0.0 || std::abs(pair.imaginary) > stability_limit.real_value * std::abs(pair.value)) continue;
        inverse_factor.push_back(pair.value);
        y.push_back(std::move(pair.vector));
      }
    });
    int found = static_cast<int>(y.size());
    unknowns_.root().share(&found, 1, MPI_INT);
    int symmetric = pencil_symmetric_ ? 1 : 0;
    unknowns_.root().share(&symmetric, 1, MPI_INT);
    pencil_symmetric_ = symmetric != 0;
    inverse_factor.resize(found);
    y.resize(found);
    unknowns_.root().share(inverse_factor.data(), found, MPI_DOUBLE);
    if (found == 0) return {};
    std::vector<Factor> factors;
    for (int k = 0; k < found; ++k) factors.push_back({1.0 / inverse_factor[k], 0.0, y[k], y[k]});
    return factors;
  }

  /// Computes left . K y at the stresses of a load factor with the true compliance: zero for modes.
  double energy_at(double load_factor, const Factor& factor) {
    const Tangent tangent = tangent_under_stress(load_factor);
    const double energy = number_of_root(unknowns_.root(), [&] {
      std::vector<double> force(factor.y.size());
      under_stress_.multiply(factor.y.data(), force.data());
      return dot_product(factor.left, force);
    });
    const MixedVector motion = complete_motion(tangent, unknowns_, factor.y);
    return energy + cap_compliance_form(model_, cap_, complete_motion(tangent, unknowns_, factor.left), motion);
  }

  /// Finds the zero of energy_at() by the secant method; left . K_0 y = 1. Stops when the energy is rounding and no
  /// longer decreases, since the next secant would be arbitrary.
  double rayleigh_factor(const Factor& factor) {
    double a = 0.0, b = factor.value, at_a = 1.0;
    for (int i = 0; i < stability_limit.most_secants; ++i) {
      const double at_b = energy_at(b, factor);
      if (at_b == at_a) break;
      if (i > 0 && std::abs(at_b) >= std::abs(at_a)) return a;
      const double next = b - at_b * (b - a) / (at_b - at_a);
      a = b;
      at_a = at_b;
      b = next;
      if (!(std::abs(b - a) > stability_limit.settled_factor * std::abs(b))) break;
    }
    return b;
  }

  /// Computes |K(lambda) y| in units of K_0^-1, a bound of the relative error of the factor.
  double residual_of(const Factor& factor) {
    tangent_under_stress(factor.value);
    return number_of_root(unknowns_.root(), [&] {
      std::vector<double> force(factor.y.size());
      under_stress_.multiply(factor.y.data(), force.data());
      std::vector<double> moved = force;
      solver_->solve(moved.data(), 1);
      return std::sqrt(std::abs(dot_product(force, moved)));
    });
  }

  /// Performs one step of inverse iteration, y = K^-1 K_0 y, also of the transpose, and scales to left . K_0 y = 1. K
  /// is taken far enough from the factor that all modes of a multiple one grow alike.
  void improve(Factor& factor) {
    tangent_under_stress((1.0 - stability_limit.aside_of_factor) * factor.value);
    on_root(unknowns_.root(), [&] {
      const auto image = [&](const std::vector<double>& x) {
        std::vector<double> force(x.size());
        matrix_.multiply(x.data(), force.data());
        return force;
      };
      if (factorize_under_stress().null > 0) return;
      std::vector<double> moved = image(factor.y);
      moving_solver_->solve(moved.data(), 1);
      std::vector<double> left = moved;
      if (!pencil_symmetric_) {
        left = image(factor.left);
        moving_solver_->solve(left.data(), 1, true);
      }
      const double square = dot_product(left, image(moved)), size = std::sqrt(std::abs(square));
      if (!(size > 0.0) || !std::isfinite(size)) return;
      for (size_t i = 0; i < moved.size(); ++i) {
        factor.y[i] = moved[i] / size;
        factor.left[i] = left[i] / std::copysign(size, square);
      }
    });
  }

  /// Counts negative eigenvalues of K at the stresses of a load factor, interiors included; -1: uncertain.
  long negative_at(double load_factor) {
    const Tangent::InteriorCount interior = tangent_under_stress(load_factor).interior_count();
    const double negative = number_of_root(unknowns_.root(), [&] { return factorize_under_stress().negative; });
    return interior.uncertain ? -1 : static_cast<long>(negative) + interior.negative;
  }

  std::vector<EigenMode> improved(std::vector<Factor> factors) {
    for (Factor& factor : factors) {
      if (!pencil_symmetric_) improve(factor);  // finds its left mode
      for (int round = 0;; ++round) {
        factor.value = rayleigh_factor(factor);
        factor.residual = residual_of(factor);
        if (round == stability_limit.most_rounds || factor.residual <= stability_limit.small_residual) break;
        improve(factor);
      }
    }
    std::stable_sort(factors.begin(), factors.end(),
                     [](const Factor& a, const Factor& b) { return rank(a.value) < rank(b.value); });
    if (pencil_symmetric_)
      for (const double sign : {1.0, -1.0}) confirm(factors, sign);
    return modes_of(factors);
  }

  /// Confirms factors by Sylvester's law: beside each cluster of one sign the tangent has as many negative eigenvalues
  /// as there are factors between it and zero.
  void confirm(std::vector<Factor>& factors, double sign) {
    std::vector<Factor*> side;
    for (Factor& factor : factors)
      if (factor.value * sign > 0.0) side.push_back(&factor);
    for (size_t first = 0, last; first < side.size(); first = last) {
      last = first + 1;
      while (last < side.size() && std::abs(side[last]->value) <
                                       (1.0 + 4.0 * stability_limit.beside_factor) * std::abs(side[last - 1]->value))
        ++last;
      const bool agrees =
          negative_at((1.0 - stability_limit.beside_factor) * side[first]->value) == static_cast<long>(first) &&
          negative_at((1.0 + stability_limit.beside_factor) * side[last - 1]->value) >= static_cast<long>(last);
      for (size_t k = first; k < last; ++k)
        side[k]->confirmed = agrees && side[k]->residual <= stability_limit.beside_factor;
    }
  }

  /// Applies -K^-1 K_g.
  void apply(const SparseMatrix& prestress, double* block, int columns) {
    const size_t n = unknowns_.count();
    std::vector<double> image(n * columns);
    for (int j = 0; j < columns; ++j) prestress.multiply(block + j * n, image.data() + j * n);
    std::transform(image.begin(), image.end(), block, [](double x) { return -x; });
    solver_->solve(block, columns);
  }

  /// Asymmetry of K + t K_g, since K_g alone has no scale.
  double asymmetry_of(const SparseMatrix& prestress, double t) {
    SparseMatrix together = matrix_;
    for (size_t i = 0; i < together.value.size(); ++i) together.value[i] += t * prestress.value[i];
    return asymmetry(together);
  }

  /// Completes the modes at the reference state.
  std::vector<EigenMode> modes_of(const std::vector<Factor>& factors) {
    const Tangent tangent = tangent_at(reference_);
    unknowns_.reduce(tangent);
    std::vector<EigenMode> result;
    for (const Factor& factor : factors) {
      MixedVector mode = complete_motion(tangent, unknowns_, factor.y);
      normalize_mode(model_, mode);
      result.push_back({factor.value, std::move(mode), factor.residual, factor.confirmed});
    }
    return result;
  }
};

}  // namespace

std::vector<EigenMode> linear_buckling(BeamProblem& problem, int count) {
  return LinearBuckling(problem, problem.model.reference_state(), 0.0).modes(count);
}

std::vector<EigenMode> linear_buckling(BeamProblem& problem, int count, const State& state, double load_factor) {
  return LinearBuckling(problem, state, load_factor).modes(count);
}

}  // namespace mixbeam
