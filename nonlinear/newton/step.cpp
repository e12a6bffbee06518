#include "nonlinear/newton/step.hpp"

#include "nonlinear/newton/cap_correction.hpp"

#include <algorithm>

namespace mixbeam {

Linearization::Linearization(BeamProblem& problem, const EvaluationPoint& point, const Cap& cap,
                             const TangentKind& kind)
    : tangent_(problem.model, point, cap, kind), solver_(problem.take_solver()) {
  try {
    solver_->factorize(tangent_);
  } catch (const LinearSolverError& error) {
    failure_ = error.what();
  }
}

void Linearization::newton_increment(MixedVector& increment) {
  tangent_.condense_residual();
  solve_condensed(increment);
}

void Linearization::solve(const MixedVector& scaled_rhs, MixedVector& increment) {
  tangent_.condense(scaled_rhs);
  solve_condensed(increment);
}

void Linearization::solve_condensed(MixedVector& increment) {
  if (!failure_.empty()) throw LinearSolverError(failure_);
  DofVector& rhs = tangent_.condensed_rows();
  rhs.scale(-1.0);
  solver_->solve(rhs, increment.vertex_dofs());
  tangent_.recover(increment);
}

void Linearization::cap_compliance_rows(const MixedVector& increment, MixedVector& rows) const {
  mixbeam::cap_compliance_rows(tangent_.model(), tangent_.cap(), tangent_.point().scales, increment, rows);
}

namespace {

/// The cap is let be where it leaves less than this fraction of what the next residual holds anyway.
constexpr double kNegligible = 0.1;

}  // namespace

bool remove_cap_compliance_where_it_slows(Linearization& linearization, const MixedVector& residual,
                                          MixedVector& increment) {
  const Tangent& tangent = linearization.tangent();
  const Model& model = tangent.model();
  const Cap& cap = tangent.cap();
  const ResidualScales& scales = tangent.point().scales;
  if (cap.least_ratio == 0.0) return false;
  const double left = largest_cap_compliance_row(model, cap, scales, increment);
  // Strains of the order of the squared rotation are left by the linearisation.
  const double spin = increment.largest_vertex_spin();
  const double from_rotation = spin * spin / scales.rotation;
  if (!(left > kNegligible * std::max(model.options().residual_tolerance, from_rotation))) return false;
  if (!(left > kNegligible * compatibility_norm(model, residual))) return false;
  try {
    return remove_cap_compliance(linearization, cap.least_ratio, increment);
  } catch (const LinearSolverError&) {
    return false;  // the increment is still that of the capped tangent, which only converges more slowly
  }
}

}  // namespace mixbeam
