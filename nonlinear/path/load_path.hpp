/// Load continuation: from the present state along the load factor, stage by stage.
#pragma once

#include "discretization/state/member_samples.hpp"
#include "nonlinear/diagnosis/failure_report.hpp"
#include "nonlinear/parameters/solver_parameters.hpp"
#include "nonlinear/stability/stability.hpp"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace mixbeam {

/// One completed load step.
struct StepReport {
  int step = 0;  ///< number of the step, 0: the state at the start of the path
  double load_factor = 0.0;
  int newton_iterations = 0;  ///< since the last converged step, failed attempts included
  double residual = 0.0;      ///< scaled maximum norm
  bool converged = true;
  PathPoint point{};
  std::optional<StabilityResult> stability{};  ///< of the state under its loads; none: not requested
  /// Displacement control: stability with that displacement held instead of the load. None: unknown.
  std::optional<StabilityResult> held_stability{};
  std::vector<CriticalPoint> critical_points{};  ///< passed since the last step, in the order of the path
  std::optional<RecordedJump> jump{};            ///< jump that made the step; none: it follows the path
  std::vector<NewtonIteration> history{};        ///< of all attempts since the last converged step, in their order
};

/// Progress of the search for a stable state.
struct DescentProgress {
  double load_factor = 0.0, potential = 0.0;  ///< total potential at that load factor
  int factorizations = 0;                     ///< so far
};

/// Start and interruption of a path from outside.
struct PathControl {
  std::optional<PathPoint> resume{};  ///< point to which the given state belongs; none: the path starts
  std::function<bool()> stop{};       ///< asked after each completed step; must answer the same on every rank
  std::function<void(const StepFailure&)> step_failed{};   ///< called for each failed attempt, on every rank
  std::function<void(const DescentProgress&)> descends{};  ///< called for each step of a jump, on every rank
};

struct LoadPathResult {
  bool finished = false;
  bool interrupted = false;  ///< stopped from outside before the end
  bool returned = false;     ///< the path led back to an earlier state; follow it again, more closely
  double load_factor = 0.0;  ///< of the last converged state
  int steps = 0, failed_steps = 0, newton_iterations = 0;
  std::vector<int> iterations_of_stage;
  std::string lost_at{};                  ///< kind and load factor of the first point where the path became unstable
  std::optional<FailureReport> report{};  ///< why the path ended early, and what to try
  std::string failure;                    ///< the report as a page of text; empty if there is none
};

/// Called for the starting state and for each converged step, with its state.
using PathObserver = std::function<void(const StepReport& report, const State& state)>;

/// Follows the load factor from 0, or from the point at which a path is resumed, to the number of stages of the scene,
/// starting at `state`, which becomes the last converged state. A resumed path takes bitwise the same steps as without
/// the interruption. Throws InputError for NOX or LOCA parameters that these libraries refuse.
LoadPathResult follow_load_path(const Teuchos::RCP<BeamProblem>& problem, const SolverParameters& parameters,
                                State& state, const PathObserver& observer, const PathControl& control = {});

/// Runs Newton's method at the end of the path instead of following it: `state` is close to equilibrium there and
/// becomes that. The result is that of a path of one step; if Newton's method fails, not finished, and `state` stays.
LoadPathResult settle_at_end(const Teuchos::RCP<BeamProblem>& problem, const SolverParameters& parameters, State& state,
                             const PathObserver& observer);

/// Reason why a path with these parameters cannot be resumed exactly, empty if it can: some methods in the lists "LOCA"
/// and "Status Tests" depend on more than the last step.
std::string obstacle_to_resuming(const SolverParameters& parameters);

}  // namespace mixbeam
