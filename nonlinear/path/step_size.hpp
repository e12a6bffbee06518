/// Sizes of load steps: a pure function of the step before, so that a path can go on from any completed step with the
/// same sizes as if it had never stopped.
#pragma once

#include "discretization/assembly/model.hpp"
#include "nonlinear/parameters/solver_parameters.hpp"

namespace mixbeam {

/// Sizes are changes of the load factor. The rules are those of LOCA's strategies "Constant" and "Adaptive".
struct StepSizeRule {
  LoadPathMethod method = LoadPathMethod::adaptive;
  double initial = 1.0, minimum = 1e-4, maximum = 1.0;
  double aggressiveness = 0.5;
  double most_iterations = 50.0;  ///< with which a step of an adaptive path does not grow at all
  double failed_factor = 0.5;     ///< after a failed attempt
  double success_factor = 1.26;   ///< fixed: after a success with a reduced size

  double after_success(double size, int iterations) const;
  double after_failure(double size) const { return failed_factor * size; }
};

/// The step that led to where a path stands.
struct LastStep {
  double size = 0.0;
  int iterations = 0;
};

/// Of the present piece of a stage, or of stages: fractions of it, small enough for prescribed rotations.
StepSizeRule step_size_rule(const Model& model, const SolverParameters& parameters);

/// Factor of the length of the next step along a path. `angle`: between the tangents of the step before and after it
/// [rad]; `closeness`: above 0, the path itself is asked for, not only its end; each one more halves the angle.
double growth_along_path(int iterations, double angle, int closeness);

}  // namespace mixbeam
