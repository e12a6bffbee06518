/// A load path without tuning: load steps as large as Newton's method takes them, and where one fails or the stability
/// changes within it, the path itself, by its length, through limit points and snap-backs.
///
/// LOCA's stepper serves for steps of the load factor; here its constrained group is used without the stepper, which
/// cannot be resumed exactly when it follows arc length (its scaling depends on all steps so far), does not tell why a
/// step failed, and knows no events between steps such as critical points and branches.
#pragma once

#include "nonlinear/path/path_recorder.hpp"

namespace mixbeam {

/// Returns whether the path arrived at the end of the range. `start` is the state at its beginning.
bool follow_stage_automatically(const Teuchos::RCP<BeamProblem>& problem, const SolverParameters& parameters,
                                const State& start, const StageRange& range, PathRecorder& recorder);

/// Whether the load moves the controlled displacement of the unloaded structure; true where none is controlled or the
/// tangent there is singular. One solve. Collective.
bool load_moves_control(const Teuchos::RCP<BeamProblem>& problem, const SolverParameters& parameters);

}  // namespace mixbeam
