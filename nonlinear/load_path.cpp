#include "nonlinear/load_path.hpp"

#include "discretization/errors.hpp"
#include "nonlinear/automatic_path.hpp"
#include "nonlinear/loca_stage.hpp"

#include <cmath>

namespace mixbeam {

namespace {

constexpr double kPi = 3.14159265358979323846;

/// A relative rotation of pi cannot be told from one of -pi; what converged next to it is not to be trusted.
void check_end_angles(const BeamProblem& problem) {
  constexpr double kMargin = 1e-9;
  const Assembler::EndAngle angle = problem.assembler.largest_end_angle();
  if (angle.angle < kPi * (1.0 - kMargin)) return;
  throw ConvergenceError(
      "element " + std::to_string(angle.element) + " of member \"" + angle.member +
      "\" turns by pi against its vertices, where rotations are no longer unique: use more elements there");
}

/// What is left of a stage for a path that stands at the end of `result`.
StageRange range_of_stage(int stage, const SolverParameters& parameters, const PathControl& control,
                          const LoadPathResult& result) {
  StageRange range;
  range.stage = stage;
  range.from = stage - 1;
  range.to = stage;
  range.attempts = parameters.load_path.maximum_steps - result.steps;
  const bool inside = control.resume && result.steps == control.resume->step && result.load_factor != range.from;
  if (!inside) return range;
  range.from = control.resume->load_factor;
  range.attempts = control.resume->attempts_left;
  range.before = control.resume;
  return range;
}

/// Stages that are behind a path when it is resumed. The last one may have ended without the check that follows it.
int finished_stages(const Teuchos::RCP<BeamProblem>& problem, const State& state, const PathControl& control) {
  if (!control.resume) return 0;
  const int stage = control.resume->stage;
  if (control.resume->step == 0 || !is_end_of_stage(control.resume->load_factor, stage)) return stage - 1;
  MixedVector residual = problem->assembler.create_vector();
  problem->assembler.residual(state, control.resume->load_factor, residual);
  check_end_angles(*problem);
  return stage;
}

bool follow_stage(const Teuchos::RCP<BeamProblem>& problem, const SolverParameters& parameters, const State& start,
                  const StageRange& range, PathRecorder& recorder) {
  if (range.attempts <= 0) return false;
  const bool automatic = parameters.load_path.method == LoadPathMethod::automatic;
  const bool arrived = automatic ? follow_stage_automatically(problem, parameters, start, range, recorder)
                                 : follow_stage_with_loca(problem, parameters, start, range, recorder);
  recorder.leave_stage();
  return arrived;
}

}  // namespace

LoadPathResult follow_load_path(const Teuchos::RCP<BeamProblem>& problem, const SolverParameters& parameters,
                                State& state, const PathObserver& observer, const PathControl& control) {
  LoadPathResult result;
  PathRecorder recorder(problem, parameters, state, observer, control, result);
  problem->attempts.start_path(result.steps, control.step_failed);
  const int stages = problem->assembler.scene().stages;
  for (int stage = finished_stages(problem, state, control) + 1; stage <= stages; ++stage) {
    const int before = problem->work.newton_iterations;
    const bool arrived =
        follow_stage(problem, parameters, state, range_of_stage(stage, parameters, control, result), recorder);
    result.iterations_of_stage.push_back(problem->work.newton_iterations - before);
    result.newton_iterations += result.iterations_of_stage.back();
    if (result.interrupted) return result;
    if (!arrived) {
      const double minimum = step_size_rule(problem->assembler.scene(), parameters).minimum;
      const bool used_up = result.steps + result.failed_steps >= parameters.load_path.maximum_steps;
      result.report = report_failure(*problem, parameters, {state, result.steps, result.load_factor, minimum, used_up});
      result.failure = text_of(*result.report);
      return result;
    }
    check_end_angles(*problem);
  }
  result.finished = true;
  return result;
}

}  // namespace mixbeam
