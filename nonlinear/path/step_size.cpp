#include "nonlinear/path/step_size.hpp"

#include "discretization/scene/scene.hpp"

#include <algorithm>
#include <limits>

namespace mixbeam {

namespace {

/// A prescribed rotation is followed the short way, so one load step may not turn a support by pi or more; the margin
/// leaves room for the rotation limit of Newton's method.
constexpr double kLargestPrescribedTurn = 1.5707963267948966;  // pi / 2

}  // namespace

double StepSizeRule::after_success(double size, int iterations) const {
  if (method == LoadPathMethod::fixed) return size == initial ? size : std::min(success_factor * size, initial);
  const double ease = (most_iterations - iterations) / most_iterations;
  return size * (1.0 + aggressiveness * ease * ease);
}

StepSizeRule step_size_rule(const Scene& scene, const SolverParameters& parameters) {
  const LoadPathParameters& path = parameters.load_path;
  const bool fixed = path.method == LoadPathMethod::fixed;
  const double rotation = largest_prescribed_rotation(scene);
  const double allowed = rotation > 0.0 ? std::min(1.0, kLargestPrescribedTurn / rotation) : 1.0;
  // Rounded steps may add up to a little less than the stage, and the rest would cost one more step: each takes more
  // than the rounding error of one addition on top, and LOCA cuts off the last one at the end of the stage.
  const double equal = 1.0 / path.steps + 2.0 * std::numeric_limits<double>::epsilon() * scene.stages;
  StepSizeRule rule;
  rule.method = path.method;
  rule.aggressiveness = path.aggressiveness;
  rule.most_iterations = parameters.newton.maximum_iterations;
  rule.maximum = std::min(fixed ? equal : path.maximum_step, allowed);
  rule.initial = std::min(fixed ? equal : path.initial_step, rule.maximum);
  rule.minimum = std::min(path.minimum_step, rule.initial);
  return rule;
}

}  // namespace mixbeam
