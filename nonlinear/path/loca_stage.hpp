/// A stage of the load path by LOCA's stepper: steps of the load factor, fixed or adaptive, or whatever the user's list
/// "LOCA" asks for.
#pragma once

#include "nonlinear/path/path_recorder.hpp"
#include "nonlinear/path/step_size.hpp"

namespace mixbeam {

/// Step sizes as fractions of a stage, small enough for prescribed rotations.
StepSizeRule step_size_rule(const Scene& scene, const SolverParameters& parameters);

/// Returns whether the path arrived at the end of the range. `start` is the state at its beginning.
bool follow_stage_with_loca(const Teuchos::RCP<BeamProblem>& problem, const SolverParameters& parameters,
                            const State& start, const StageRange& range, PathRecorder& recorder);

}  // namespace mixbeam
