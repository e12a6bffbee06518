#include "nonlinear/newton/step.hpp"

#include "nonlinear/linear/krylov.hpp"
#include "nonlinear/newton/beam_group.hpp"
#include "nonlinear/newton/thresholds.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace mixbeam {

// The step, in the order in which it happens. BeamGroup: computeF, computeJacobian, computeNewton, computeX.

EvaluationPoint take_residual(BeamProblem& problem, const State& state, double load_factor, MixedVector& rows) {
  if (problem.last_rows && problem.is_last_point(state, load_factor)) {
    rows.assign(*problem.last_rows);
    return *problem.last_point;
  }
  ++problem.work.residuals;
  problem.last_rows.reset();  // so that its arrays are reused
  // scales of the rows -> residual of the elements
  problem.last_point = mixed_residual(problem.model, state, load_factor, rows);
  problem.last_rows = rows.clone(true);
  return *problem.last_point;
}

EvaluationPoint take_point(BeamProblem& problem, const State& state, double load_factor) {
  if (problem.is_last_point(state, load_factor)) return *problem.last_point;
  MixedVector rows = problem.model.create_vector();
  return take_residual(problem, state, load_factor, rows);
}

std::unique_ptr<Linearization> linearize(BeamProblem& problem, const EvaluationPoint& point,
                                         const TangentChoice& choice, const MixedVector* first) {
  ++problem.work.factorizations;
  const Cap cap = cap_for(problem.model, point.scales, choice.cap_raise);
  const TangentKind kind{choice.in_space, choice.counts_interior, {}, first};
  // tangent of the elements, each condensed to its two vertices -> chains eliminated to their ends, and with them the
  // first right-hand side -> junctions factorised
  return std::make_unique<Linearization>(problem, point, cap, kind, choice.may_iterate, choice.vertices_alone);
}

Cap find_increment(BeamProblem& problem, Linearization& here, const MixedVector& rows, const TangentChoice& choice,
                   double enough, MixedVector& increment) {
  try {
    here.newton_increment(increment, enough);  // junctions solved, checked -> chains expanded -> interiors recovered
    if (!choice.keeps_cap && remove_cap_compliance_where_it_slows(here, rows, increment, choice.is_last)) return {};
  } catch (const LinearSolverError& error) {
    // A NaN increment fails the finite-value test of this iteration, and the step is repeated with a smaller size.
    problem.last_failure = error.what();
    increment.fill(std::numeric_limits<double>::quiet_NaN());
  }
  return here.tangent().cap();
}

State moved(const BeamProblem& problem, const State& from, const MixedVector& increment, double share) {
  return problem.model.apply(from, increment, share);  // rotations limited by step_within_rotation() -> state updated
}

Linearization::Linearization(BeamProblem& problem, const EvaluationPoint& point, const Cap& cap,
                             const TangentKind& kind, bool may_iterate, bool vertices_alone)
    : tangent_(problem.model, point, cap, kind), solver_(problem.take_solver()), vertices_alone_(vertices_alone) {
  solver_->allow_iteration(may_iterate);
  DofVector& rows = tangent_.condensed_rows();
  rows.scale(-1.0);
  first_.emplace(problem.model.create_vector());
  try {
    solver_->factorize(tangent_, {&rows, &first_->writable_dofs(false)});
  } catch (const LinearSolverError& error) {
    failure_ = error.what();
  }
}

void Linearization::newton_increment(MixedVector& increment, double enough) {
  const bool is_first = !tangent_.condense_residual();
  solve_condensed(is_first, increment, enough);
}

void Linearization::solve(const MixedVector& scaled_rhs, MixedVector& increment, double enough) {
  const bool is_first = !tangent_.condense(scaled_rhs);
  solve_condensed(is_first, increment, enough);
}

void Linearization::solve_condensed(bool is_first, MixedVector& increment, double enough) {
  if (!failure_.empty()) throw LinearSolverError(failure_);
  DofVector& rhs = tangent_.condensed_rows();
  if (!is_first) rhs.scale(-1.0);
  const std::optional<MixedVector> first = std::exchange(first_, std::nullopt);  // held: no reuse of its address
  solver_->solve(rhs, is_first && first ? increment.share_vertices(*first) : increment.writable_dofs(false), enough);
  if (!vertices_alone_) tangent_.recover_last(increment);
}

void Linearization::cap_compliance_rows(const MixedVector& increment, MixedVector& rows) const {
  mixbeam::cap_compliance_rows(tangent_.model(), tangent_.cap(), tangent_.point().scales, increment, rows);
}

bool feels_cap(const Linearization& linearization, const MixedVector& motion, double enough) {
  const Tangent& tangent = linearization.tangent();
  const LargestParts size = largest_parts(*tangent.model().map()->getComm(), motion.vertex());
  ResidualScales as_moved = tangent.point().scales;
  as_moved.strain = as_moved.rotation = std::max(size.moved / tangent.model().structure().length, size.turned);
  as_moved.displacement_noise = 0.0;
  return !(largest_cap_compliance_row(tangent.model(), tangent.cap(), as_moved, motion) <= enough);
}

// With S = -J_c^-1: d = d_0 + S g and g = D d, so (I - D S) g = D d_0.
bool remove_cap_compliance(Linearization& linearization, double cap_ratio, MixedVector& increment, double reduction) {
  MixedVector left_out = increment.clone(false);
  linearization.cap_compliance_rows(increment, left_out);
  const double beta = norm_of(left_out);
  if (!(beta > 0.0) || !std::isfinite(beta)) return false;
  std::vector<MixedVector> basis, response;
  basis.push_back(std::move(left_out));
  const GmresResult found = gmres(basis, beta, std::max(reduction, newton_limit.reduction), newton_limit.most_vectors,
                                  [&](const MixedVector& of, MixedVector& next) {
                                    response.push_back(increment.clone(false));
                                    linearization.solve(of, response.back());
                                    linearization.cap_compliance_rows(response.back(), next);
                                    next.update(1.0, of, -1.0);
                                    return norm_of(next) > newton_limit.rigid_answer * cap_ratio;
                                  });
  const std::vector<double>& y = found.y;
  if (!(found.left <= newton_limit.worthwhile * beta)) return false;
  if (!std::all_of(y.begin(), y.end(), [](double factor) { return std::isfinite(factor); })) return false;
  for (size_t k = 0; k < y.size(); ++k) increment.update(y[k], response[k], 1.0);
  return true;
}

bool remove_cap_compliance_where_it_slows(Linearization& linearization, const MixedVector& residual,
                                          MixedVector& increment, bool is_last) {
  const Tangent& tangent = linearization.tangent();
  const Model& model = tangent.model();
  const Cap& cap = tangent.cap();
  const ResidualScales& scales = tangent.point().scales;
  if (cap.least_ratio == 0.0) return false;
  const double left = largest_cap_compliance_row(model, cap, scales, increment);
  // The linearisation leaves strains of the order of the squared rotation.
  const double spin = increment.largest_vertex_spin();
  const double from_rotation = spin * spin / scales.rotation;
  const double tolerance = model.options().residual_tolerance, held_anyway = std::max(tolerance, from_rotation);
  if (is_last && left <= tolerance) return false;
  if (!(left > newton_limit.negligible_cap * held_anyway)) return false;
  if (!(left > newton_limit.negligible_cap * compatibility_norm(model, residual))) return false;
  try {
    return remove_cap_compliance(linearization, cap.least_ratio, increment,
                                 newton_limit.negligible_cap * held_anyway / left);
  } catch (const LinearSolverError&) {
    return false;  // the increment is still that of the capped tangent, which only converges more slowly
  }
}

double step_within_rotation(NOX::Abstract::Group& group, const NOX::Abstract::Group& from,
                            const NOX::Abstract::Vector& direction, double largest_rotation) {
  const double spin = BeamVector::of(direction).largest_vertex_spin();
  group.computeX(from, direction, 1.0);
  group.computeF();
  if (spin <= largest_rotation || !std::isfinite(spin)) return 1.0;  // the finite-value test reports the latter
  if (BeamGroup::of(group).equilibrium_norm() <= newton_limit.balance_gain * BeamGroup::of(from).equilibrium_norm())
    return 1.0;
  const double step = largest_rotation / spin;
  group.computeX(from, direction, step);
  group.computeF();
  return step;
}

}  // namespace mixbeam
