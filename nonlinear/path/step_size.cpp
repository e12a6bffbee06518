#include "nonlinear/path/step_size.hpp"

#include "discretization/constraints/constraint_rows.hpp"
#include "discretization/scene/scene.hpp"
#include "kernels/math/constants.hpp"
#include "nonlinear/path/thresholds.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mixbeam {

double StepSizeRule::after_success(double size, int iterations) const {
  if (method == LoadPathMethod::fixed) return size == initial ? size : std::min(success_factor * size, initial);
  const double ease = (most_iterations - iterations) / most_iterations;
  return size * (1.0 + aggressiveness * ease * ease);
}

StepSizeRule step_size_rule(const Model& model, const SolverParameters& parameters) {
  const Scene& scene = model.scene();
  const LoadPathParameters& path = parameters.load_path;
  const bool fixed = path.method == LoadPathMethod::fixed;
  const LoadClock& clock = model.clock();
  const double rotation = largest_prescribed_rotation(scene, clock);
  const double allowed = rotation > 0.0 ? std::min(1.0, path_limit.largest_prescribed_turn / rotation) : 1.0;
  // Rounded steps may sum to slightly less than the stage, and the rest would cost another step: enlarge each by more
  // than the rounding error of one addition; LOCA cuts off the last one at the end of the stage.
  const double equal = 1.0 / path.steps + 2.0 * std::numeric_limits<double>::epsilon() * scene.stages;
  StepSizeRule rule;
  rule.method = path.method;
  rule.aggressiveness = path.aggressiveness;
  rule.most_iterations = parameters.newton.maximum_iterations;
  rule.maximum = std::min(fixed ? equal : path.maximum_step, allowed);
  rule.initial = std::min(fixed ? equal : path.initial_step, rule.maximum);
  if (const std::optional<LoadPiece>& piece = clock.piece()) {  // each fixed step is a piece
    const double size = piece->to - piece->from;
    rule.maximum = std::min(fixed || piece->is_jump ? 1.0 : std::min(1.0, path.maximum_step / size), allowed);
    rule.initial = std::min(fixed || piece->is_jump ? 1.0 : path.initial_step / size, rule.maximum);
  }
  rule.minimum = std::min(path.minimum_step, rule.initial);
  return rule;
}

double growth_along_path(int iterations, double angle, int closeness) {
  const double aimed =
      closeness > 0 ? std::ldexp(path_limit.aimed_angle_closely, 1 - closeness) : path_limit.aimed_angle;
  const double growth = std::min(path_limit.aimed_iterations / std::max(iterations, 1), aimed / std::max(angle, 1e-9));
  return std::clamp(growth, path_limit.smallest_growth, path_limit.largest_growth);
}

}  // namespace mixbeam
