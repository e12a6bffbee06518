/// Sizes of load steps: pure functions of the last step, so that a path resumed from any completed step continues with
/// the same sizes.
#pragma once

#include "discretization/assembly/model.hpp"
#include "nonlinear/parameters/solver_parameters.hpp"

namespace mixbeam {

/// Sizes are changes of the load factor. The rules are those of LOCA's strategies "Constant" and "Adaptive".
struct StepSizeRule {
  LoadPathMethod method = LoadPathMethod::adaptive;
  double initial = 1.0, minimum = 1e-4, maximum = 1.0;
  double aggressiveness = 0.5;
  double most_iterations = 50.0;  ///< adaptive: number of iterations after which steps do not grow
  double failed_factor = 0.5;     ///< after a failed attempt
  double success_factor = 1.26;   ///< fixed: after a success with a reduced size

  double after_success(double size, int iterations) const;
  double after_failure(double size) const { return failed_factor * size; }
};

/// The step that led to the present point of a path.
struct LastStep {
  double size = 0.0;
  int iterations = 0;
};

/// Rule for the present piece of a stage, or for stages: fractions of it, small enough for prescribed rotations.
StepSizeRule step_size_rule(const Model& model, const SolverParameters& parameters);

/// Growth factor for the length of the next step along a path. `angle`: between the tangents before and after the last
/// step [rad]; `closeness`: above 0 the path itself is of interest, and each further level halves the angle.
double growth_along_path(int iterations, double angle, int closeness);

}  // namespace mixbeam
