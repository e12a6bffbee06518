#include "nonlinear/newton/line_search.hpp"

#include "nonlinear/newton/beam_group.hpp"

#include <NOX_Solver_Generic.H>

#include <cmath>

namespace mixbeam {

namespace {

/// A full step beyond the rotation limit must reduce the imbalance of forces and moments at least to this fraction.
/// Pure bending reaches round-off, whatever the angle; a step that merely shuffles the imbalance has left the range of
/// the linearisation, and with 0.4 in place of 0.1 the kinked frame and the fork wander off to other equilibria.
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

bool RotationLimitedLineSearch::compute(NOX::Abstract::Group& group, double& step,
                                        const NOX::Abstract::Vector& direction, const NOX::Solver::Generic& solver) {
  step = step_within_rotation(group, solver.getPreviousSolutionGroup(), direction, maximum_rotation_);
  return true;
}

}  // namespace mixbeam
