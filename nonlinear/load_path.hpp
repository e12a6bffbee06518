/// Load continuation: from the present state along the load factor, by LOCA's stepper, stage after stage.
#pragma once

#include "nonlinear/beam_group.hpp"
#include "nonlinear/solver_parameters.hpp"

#include <functional>
#include <string>
#include <vector>

namespace mixbeam {

/// One attempted load step.
struct StepReport {
  int step = 0;  ///< number of the step, 0: the state at the start of the path
  double load_factor = 0.0;
  int newton_iterations = 0;  ///< since the last converged step, failed attempts included
  double residual = 0.0;      ///< scaled maximum norm
  bool converged = true;
};

struct LoadPathResult {
  bool finished = false;
  double load_factor = 0.0;  ///< last converged
  int steps = 0, failed_steps = 0, newton_iterations = 0;
  std::vector<int> iterations_of_stage;
  std::string failure;  ///< why the path ended early, and what to try
};

/// Called for the starting state and for each converged step; the state is that of the step.
using PathObserver = std::function<void(const StepReport& report, const State& state)>;

/// Follows the load factor from 0 to the number of stages of the scene, starting at `state`, which ends as the last
/// converged state. Throws InputError for NOX or LOCA parameters that these libraries refuse.
LoadPathResult follow_load_path(const Teuchos::RCP<BeamProblem>& problem, const SolverParameters& parameters,
                                State& state, const PathObserver& observer);

}  // namespace mixbeam
