#include "nonlinear/stability/stressed_structure.hpp"

#include <algorithm>
#include <cmath>
#include "discretization/mesh/element_view.hpp"
#include "nonlinear/stability/thresholds.hpp"

namespace mixbeam {

namespace {

/// Each repetition gains as much as the cap is above the forces at work, five digits: three reach rounding.
constexpr int kRefinements = 3;

}  // namespace

StressedStructure::StressedStructure(BeamProblem& problem, const State& state, double load_factor)
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
  stiffness_ = symmetric_part(unknowns_.matrix());
}

void StressedStructure::factorize() {
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
}

/// About a state that carries stress the stresses to come balance in the motion that they cause, not in the state where
/// they are put: what this leaves of moments is the skew part of a stiffness that is symmetric along the path.
std::vector<double> StressedStructure::symmetric_part(const SparseMatrix& matrix) const {
  if (base_ == 0.0 || !symmetric_) return matrix.value;
  std::vector<double> value = matrix.value;
  const auto columns = matrix.column.begin();
  for (int i = 0; i < matrix.rows(); ++i)
    for (int k = matrix.row_start[i]; k < matrix.row_start[i + 1]; ++k) {
      const int j = matrix.column[k];
      const auto end = columns + matrix.row_start[j + 1], other = std::find(columns + matrix.row_start[j], end, i);
      value[k] = 0.5 * (matrix.value[k] + (other == end ? 0.0 : matrix.value[other - columns]));
    }
  return value;
}

/// Of the response its N and M alone: the linear theory of buckling lets stresses act on the undeformed structure.
/// With displacements as well the pencil would be that of a stiffness C turned by a linearised rotation, C + lambda
/// (theta C
/// - C theta), which is singular at lambda theta ~ sqrt(ratio of stiffnesses): factors without meaning, of both
/// signs, that change with the mesh.
void StressedStructure::keep_stresses() {
  const KernelView<double*> vertex = response_.vertex(), interior = response_.writable_interior(true);
  for (size_t i = 0; i < vertex.extent(0); ++i) vertex(i) = 0.0;
  for_each_element(model_.structure(), [&](const ElementView& element) {
    double* row = element.increments_in(interior);
    for (int i = element.layout().relative_rotation(1); i < element.layout().increments(); ++i) row[i] = 0.0;
  });
}

/// dx / d(load factor) at the reference state, of what begins to act there. Solved with the capped tangent and refined
/// to the true one: where forces are shared according to stiffness the cap would shift them.
void StressedStructure::find_response() {
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

/// Largest of N L^2/EI and M L/EI per load factor.
double StressedStructure::largest_stress() const {
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

/// K_g = (4 D(t) - D(2t))/3 with central differences D of the internal part; loads are evaluated at factor zero there
/// because a ramp has no negative side, and their own part, linear in the factor, comes from the reference state.
std::vector<double> StressedStructure::geometric_stiffness(double t) {
  std::vector<double> result(stiffness_.size(), 0.0);
  const auto add = [&](double factor, const std::vector<double>& k) {
    for (size_t i = 0; i < result.size(); ++i) result[i] += factor * k[i];
  };
  for (double sign : {1.0, -1.0}) {
    add(sign * 4.0 / (6.0 * t), stiffness_at(state_at(sign * t)));
    add(-sign / (12.0 * t), stiffness_at(state_at(sign * 2.0 * t)));
  }
  const double load_factor = std::min(t, 1.0);
  by_loads_ = stiffness_at(reference_, load_factor);
  for (size_t i = 0; i < by_loads_.size(); ++i) {
    by_loads_[i] = (by_loads_[i] - stiffness_[i]) / load_factor;
    result[i] += by_loads_[i];
  }
  return result;
}

/// K at the stresses of a load factor, interiors condensed exactly; loads without a potential apart.
Tangent StressedStructure::tangent_under_stress(double load_factor) {
  Tangent tangent = tangent_at(state_at(load_factor));
  under_stress_.row_start = matrix_.row_start;
  under_stress_.column = matrix_.column;
  under_stress_.value = symmetric_part(unknowns_.reduce(tangent));
  for (size_t i = 0; i < by_loads_.size(); ++i) under_stress_.value[i] += load_factor * by_loads_[i];
  return tangent;
}

InertiaSolver::Signs StressedStructure::factorize_under_stress() {
  if (moving_solver_ == nullptr)
    moving_solver_ = std::make_unique<InertiaSolver>(InertiaSolver::Kind::symmetric, under_stress_);
  return moving_solver_->factorize(under_stress_);
}

}  // namespace mixbeam
