#include "nonlinear/path/load_path.hpp"

#include "discretization/text/message_text.hpp"
#include "kernels/math/constants.hpp"
#include "nonlinear/path/corrector.hpp"
#include "nonlinear/path/path_recorder.hpp"
#include "nonlinear/path/thresholds.hpp"
#include "nonlinear/stability/stability.hpp"

#include <algorithm>
#include <cmath>

namespace mixbeam {

namespace {

/// Names an element that rotates by pi against its vertices at the end of a stage, if any: pi cannot be distinguished
/// from -pi, and a state that converged next to it is unreliable.
std::string problem_of_end_angles(BeamProblem& problem, const State& state, double load_factor) {
  const EndAngle angle = largest_end_angle(problem.model, take_point(problem, state, load_factor));
  if (angle.angle < kPi * (1.0 - path_limit.margin_of_half_turn)) return "";
  return "element " + std::to_string(angle.element) + " of member \"" + excerpt(angle.member) +
         "\" turns by pi against its vertices, where rotations are no longer unique";
}

/// Whether an interrupted path has completed a piece, or is in a later one.
bool is_behind(const LoadPiece& piece, const PathControl& control) {
  if (!control.resume || control.resume->step == 0) return false;
  const PathPoint& stopped = *control.resume;
  if (stopped.piece < 0.0) return !piece.is_plain && stopped.load_factor >= piece.to;
  return stopped.piece > piece.from || (stopped.piece == piece.from && is_end_of_stage(stopped.parameter, piece.end()));
}

/// Remaining range of a piece of a stage for a path at the end of `result`.
StageRange range_of_stage(int stage, const LoadPiece& piece, const BeamProblem& problem,
                          const SolverParameters& parameters, const PathControl& control,
                          const LoadPathResult& result) {
  StageRange range;
  range.stage = stage;
  range.piece = piece;
  range.from = piece.from;
  range.to = piece.end();
  range.attempts = parameters.load_path.most_steps(problem.model.scene().stages) - result.steps;
  const bool inside = control.resume && result.steps == control.resume->step && result.load_factor != range.from;
  if (!inside) return range;
  range.from = control.resume->piece >= 0.0 ? control.resume->parameter : control.resume->load_factor;
  range.attempts = control.resume->attempts_left;
  range.before = control.resume;
  return range;
}

/// Number of stages that a resumed path has completed.
int finished_stages(const PathControl& control) {
  if (!control.resume) return 0;
  const int stage = control.resume->stage;
  const double load_factor = control.resume->load_factor;
  const bool jumps_next = control.resume->piece >= 0.0 && load_factor < stage;
  return control.resume->step > 0 && is_end_of_stage(load_factor, stage) && !jumps_next ? stage : stage - 1;
}

/// Load factors at which states are requested: for modes and, if pieces are divided anyway, for fixed steps.
std::vector<double> ends_asked_for(int stage, bool is_plain, const SolverParameters& parameters) {
  std::vector<double> ends = parameters.analysis.modes.load_factors;
  const bool is_fixed = parameters.load_path.method == LoadPathMethod::fixed && (!is_plain || !ends.empty());
  for (int i = 1; i < parameters.load_path.steps && is_fixed; ++i)
    ends.push_back(stage - 1.0 + static_cast<double>(i) / parameters.load_path.steps);
  std::sort(ends.begin(), ends.end());
  return ends;
}

/// Divides a stage where loads turn back or jump, and where a state is requested.
std::vector<LoadPiece> pieces_of_stage(int stage, const BeamProblem& problem, const SolverParameters& parameters) {
  LoadPiece whole{stage - 1.0, 1.0 * stage};
  whole.is_plain = true;
  std::vector<LoadPiece> pieces{whole};
  if (parameters.analysis.control) return pieces;
  if (problem.model.clock().have_formulas()) pieces = problem.model.clock().pieces(stage);
  const std::vector<double> ends = ends_asked_for(stage, pieces.front().is_plain, parameters);
  if (ends.empty()) return pieces;
  std::vector<LoadPiece> divided;
  for (LoadPiece piece : pieces) {
    const double to = piece.to;
    piece.is_part = piece.is_plain;
    for (const double end : ends) {
      if (piece.is_jump) break;
      if (end <= piece.from * (1.0 + kSameLoadFactor) || end >= to * (1.0 - kSameLoadFactor)) continue;
      piece.to = end;
      divided.push_back(piece);
      piece.from = end;
    }
    piece.to = to;
    divided.push_back(piece);
  }
  return divided;
}

bool follow_stage(const Teuchos::RCP<BeamProblem>& problem, const SolverParameters& parameters, const State& start,
                  const StageRange& range, PathRecorder& recorder) {
  if (range.attempts <= 0) return false;
  LoadClock& clock = problem->model.clock();
  const struct Running {
    LoadClock& clock;
    ~Running() { clock.run(std::nullopt); }
  } running{clock};
  clock.run(range.piece);
  recorder.enter_piece(range.piece);
  problem->forget_tangents();  // like a resumed path
  const bool is_own =
      parameters.analysis.snap == Snap::jump || parameters.load_path.method == LoadPathMethod::automatic;
  const bool arrived = is_own ? follow_stage_automatically(problem, parameters, start, range, recorder)
                              : follow_stage_with_loca(problem, parameters, start, range, recorder);
  recorder.leave_stage();
  return arrived;
}

void give_up(const Teuchos::RCP<BeamProblem>& problem, const SolverParameters& parameters, const State& state,
             LoadPathResult& result) {
  const double minimum = step_size_rule(problem->model, parameters).minimum;
  const int most = parameters.load_path.most_steps(problem->model.scene().stages);
  const bool used_up = result.steps + result.failed_steps >= most;
  result.report =
      report_failure(*problem, parameters, {state, result.steps, result.load_factor, minimum, used_up, result.lost_at});
  result.failure = text_of(*result.report);
}

/// Whether the end of a stage is reliable. A path may be resumed at an end that was not checked before.
bool is_trustworthy(const Teuchos::RCP<BeamProblem>& problem, const State& state, PathRecorder& recorder) {
  const std::string cause = problem_of_end_angles(*problem, state, recorder.load_factor());
  if (!cause.empty()) recorder.rejected(cause, 0);
  recorder.leave_stage();
  return cause.empty();
}

/// Finds the first text parameter with this name anywhere below `list` whose value is among `values`; empty: none.
std::string find_value(const Teuchos::ParameterList& list, const std::string& name,
                       const std::vector<std::string>& values) {
  for (auto it = list.begin(); it != list.end(); ++it) {
    const Teuchos::ParameterEntry& entry = list.entry(it);
    if (entry.isList()) {
      const std::string found = find_value(list.sublist(list.name(it)), name, values);
      if (!found.empty()) return found;
    } else if (list.name(it) == name && entry.isType<std::string>()) {
      for (const std::string& value : values)
        if (Teuchos::getValue<std::string>(entry) == value) return value;
    }
  }
  return "";
}

bool is_switched_on(const Teuchos::ParameterList& list, const std::string& name) {
  return list.isType<bool>(name) && list.get<bool>(name);
}

}  // namespace

LoadPathResult settle_at_end(const Teuchos::RCP<BeamProblem>& problem, const SolverParameters& parameters, State& state,
                             const PathObserver& observer) {
  const int end = problem->model.scene().stages, before = problem->work.newton_iterations;
  LoadPathResult result;
  PathControl control;
  control.resume.emplace();  // makes the reported step the first one, not the start of a path
  PathRecorder recorder(problem, parameters, state, observer, control, result);
  problem->attempts.start_path(0, {});
  recorder.enter_stage(end, 1);
  Corrector corrector(problem, parameters, recorder.record());
  const Correction found = corrector.at_load(state, static_cast<double>(end), path_limit.most_iterations_of_easy_solve);
  result.newton_iterations = problem->work.newton_iterations - before;
  if (!found.converged || !problem_of_end_angles(*problem, found.state, end).empty()) {
    result.failure = found.converged ? "an element turns too far" : found.cause;
    return result;
  }
  ConvergedStep step{found.state, found.load_factor, found.residual};
  if (recorder.reports_stability())
    step.stability = recorder.counts()->try_ask({found.state, found.load_factor}, How::inertia);
  recorder.converged(step);
  result.finished = true;
  return result;
}

LoadPathResult follow_load_path(const Teuchos::RCP<BeamProblem>& problem, const SolverParameters& parameters,
                                State& state, const PathObserver& observer, const PathControl& control) {
  LoadPathResult result;
  PathRecorder recorder(problem, parameters, state, observer, control, result);
  problem->attempts.start_path(result.steps, control.step_failed);
  const struct Interruption {
    BeamProblem& problem;
    ~Interruption() { problem.leave_if_asked = {}; }
  } interruption{*problem};
  problem->leave_if_asked = [&control] {
    if (control.stop && control.stop()) throw PathInterrupted();
  };
  const int stages = problem->model.scene().stages, finished = finished_stages(control);
  bool goes_on = finished == 0 || is_trustworthy(problem, state, recorder);
  for (int stage = finished + 1; goes_on && stage <= stages; ++stage) {
    const int before = problem->work.newton_iterations;
    bool arrived = true;
    for (const LoadPiece& piece : pieces_of_stage(stage, *problem, parameters)) {
      if (!arrived || is_behind(piece, control)) continue;
      arrived = follow_stage(problem, parameters, state,
                             range_of_stage(stage, piece, *problem, parameters, control, result), recorder);
    }
    result.iterations_of_stage.push_back(problem->work.newton_iterations - before);
    result.newton_iterations += result.iterations_of_stage.back();
    if (result.interrupted) return result;
    goes_on = arrived && is_trustworthy(problem, state, recorder);
  }
  result.finished = goes_on;
  if (!goes_on) give_up(problem, parameters, state, result);
  return result;
}

std::string obstacle_to_resuming(const SolverParameters& parameters) {
  if (!parameters.loca.is_null()) {
    const Teuchos::ParameterList& loca = *parameters.loca;
    if (!find_value(loca, "Continuation Method", {"Arc Length"}).empty())
      return "arc length continuation (\"Solver / LOCA / Stepper\") scales its steps by what happened since its start";
    if (!find_value(loca, "Method", {"Secant", "Tangent"}).empty())
      return "the predictor of \"Solver / LOCA / Predictor\" extrapolates from steps before the last one";
    if (loca.isSublist("Stepper") && is_switched_on(loca.sublist("Stepper"), "Enable Tangent Factor Step Size Scaling"))
      return "the step sizes depend on the tangents of steps before the last one (\"Solver / LOCA / Stepper\")";
  }
  if (parameters.status_tests.is_null()) return "";
  const std::string test =
      find_value(*parameters.status_tests, "Test Type", {"NormUpdate", "NormWRMS", "User Defined"});
  if (test.empty()) return "";
  return "the test \"" + test + "\" of \"Solver / Status Tests\" measures all displacements since the start of a stage";
}

}  // namespace mixbeam
