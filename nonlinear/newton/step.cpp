#include "nonlinear/newton/step.hpp"

#include "nonlinear/linear/krylov.hpp"
#include "nonlinear/newton/beam_group.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

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

void Linearization::newton_increment(MixedVector& increment, double enough) {
  tangent_.condense_residual();
  solve_condensed(increment, enough);
}

void Linearization::solve(const MixedVector& scaled_rhs, MixedVector& increment, double enough) {
  tangent_.condense(scaled_rhs);
  solve_condensed(increment, enough);
}

void Linearization::solve_condensed(MixedVector& increment, double enough) {
  if (!failure_.empty()) throw LinearSolverError(failure_);
  DofVector& rhs = tangent_.condensed_rows();
  rhs.scale(-1.0);
  solver_->solve(rhs, increment.vertex_dofs(), enough);
  tangent_.recover(increment);
}

void Linearization::cap_compliance_rows(const MixedVector& increment, MixedVector& rows) const {
  mixbeam::cap_compliance_rows(tangent_.model(), tangent_.cap(), tangent_.point().scales, increment, rows);
}

namespace {

/// Iterations, and vectors that are kept. Newton's method goes on with what is left.
constexpr int kMostVectors = 20;

/// Where to stop: what was left out need not be known better than the increment itself, which the rounding errors of
/// the condensed equations disturb in the fifth digit where the cap is reached.
constexpr double kReduction = 1e-6;

/// Of the cap ratio: no stress shared by finite stiffness answers a unit vector with less.
constexpr double kRigidAnswer = 0.1;

/// A smaller gain is not worth a change.
constexpr double kWorthwhile = 0.5;

}  // namespace

// With S = J_c^-1 (-.): d = d_0 + S g and g = D d, so (I - D S) g = D d_0.
bool remove_cap_compliance(Linearization& linearization, double cap_ratio, MixedVector& increment) {
  MixedVector left_out = increment.clone(false);
  linearization.cap_compliance_rows(increment, left_out);
  const double beta = norm_of(left_out);
  if (!(beta > 0.0) || !std::isfinite(beta)) return false;
  std::vector<MixedVector> basis, response;
  basis.push_back(std::move(left_out));
  const GmresResult found = gmres(basis, beta, kReduction, kMostVectors, [&](const MixedVector& of, MixedVector& next) {
    response.push_back(increment.clone(false));
    linearization.solve(of, response.back());
    linearization.cap_compliance_rows(response.back(), next);
    next.update(1.0, of, -1.0);
    return norm_of(next) > kRigidAnswer * cap_ratio;
  });
  const std::vector<double>& y = found.y;
  if (!(found.left <= kWorthwhile * beta)) return false;
  if (!std::all_of(y.begin(), y.end(), [](double factor) { return std::isfinite(factor); })) return false;
  for (size_t k = 0; k < y.size(); ++k) increment.update(y[k], response[k], 1.0);
  return true;
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

namespace {

/// A full step beyond the rotation limit must reduce the imbalance of forces and moments at least to this fraction.
/// Pure bending reaches round-off, whatever the angle; a step that merely shuffles the imbalance has left the range of
/// the linearisation, and with 0.4 in place of 0.1 the kinked frame and the fork converge to other equilibria.
constexpr double kBalanceGain = 0.1;

}  // namespace

double step_within_rotation(NOX::Abstract::Group& group, const NOX::Abstract::Group& from,
                            const NOX::Abstract::Vector& direction, double largest_rotation) {
  const double spin = BeamVector::of(direction).largest_vertex_spin();
  group.computeX(from, direction, 1.0);
  group.computeF();
  if (spin <= largest_rotation || !std::isfinite(spin)) return 1.0;  // the finite-value test reports the latter
  if (BeamGroup::of(group).equilibrium_norm() <= kBalanceGain * BeamGroup::of(from).equilibrium_norm()) return 1.0;
  const double step = largest_rotation / spin;
  group.computeX(from, direction, step);
  group.computeF();
  return step;
}

}  // namespace mixbeam
