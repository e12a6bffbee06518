#include "nonlinear/rotation_limited_line_search.hpp"

#include "nonlinear/beam_group.hpp"

#include <NOX_Solver_Generic.H>

#include <cmath>

namespace mixbeam {

namespace {

/// A full step beyond the rotation limit must reduce the imbalance of forces and moments at least to this fraction.
/// Pure bending reaches round-off, whatever the angle; a step that merely shuffles the imbalance has left the range of
/// the linearisation, and with 0.4 in place of 0.1 the kinked frame and the fork wander off to other equilibria.
constexpr double kBalanceGain = 0.1;

}  // namespace

bool RotationLimitedLineSearch::compute(NOX::Abstract::Group& group, double& step,
                                        const NOX::Abstract::Vector& direction, const NOX::Solver::Generic& solver) {
  const NOX::Abstract::Group& old_group = solver.getPreviousSolutionGroup();
  const double spin = BeamVector::of(direction).largest_vertex_spin();
  step = 1.0;
  group.computeX(old_group, direction, step);
  group.computeF();
  if (spin <= maximum_rotation_ || !std::isfinite(spin)) return true;  // the finite-value test reports the latter
  if (BeamGroup::of(group).equilibrium_norm() <= kBalanceGain * BeamGroup::of(old_group).equilibrium_norm())
    return true;
  step = maximum_rotation_ / spin;
  group.computeX(old_group, direction, step);
  group.computeF();
  return true;
}

}  // namespace mixbeam
