#include "nonlinear/path/path_recorder.hpp"

#include "discretization/text/number_text.hpp"

#include <cmath>
#include <utility>

namespace mixbeam {

PathRecorder::PathRecorder(const Teuchos::RCP<BeamProblem>& problem, const SolverParameters& parameters, State& state,
                           const PathObserver& observer, const PathControl& control, LoadPathResult& result)
    : problem_(problem), state_(state), observer_(observer), control_(control), result_(result) {
  is_controlled_ = parameters.analysis.control.has_value();
  const int vertices = problem->model.mesh().vertices();
  const bool looks = looks_at_stability(parameters.analysis, vertices);
  reports_stability_ = looks && !problem->iterates();
  looks_at_end_ = looks && problem->iterates();
  if (!problem->iterates() && (reports_stability_ || vertices <= kVerticesForStability))
    stability_ = std::make_unique<Stability>(*problem);
  if (parameters.analysis.modes.number > 0 && may_flutter(problem->model.scene()))
    flutter_ = std::make_unique<FlutterFinder>(problem, parameters);
  if (!control.resume) return;
  started_ = true;
  result.steps = control.resume->step;
  result.load_factor = control.resume->load_factor;
  branched_ = control.resume->branched;
  result.failed_steps = control.resume->failed_steps;
  result.newton_iterations = control.resume->newton_iterations;
  critical_points_ = control.resume->critical_points;
  jumps_ = control.resume->jumps;
}

void PathRecorder::enter_stage(int stage, int attempts) {
  stage_ = stage;
  attempts_ = attempts;
  attempts_made_ = successes_ = failed_in_stage_ = 0;
}

void PathRecorder::leave_stage() {
  result_.failed_steps += failed_in_stage_;
  failed_in_stage_ = 0;
}

/// Keeps critical points and jumps of a step until it is reported, converted to load factors.
void PathRecorder::keep(const ConvergedStep& step) {
  const LoadClock& clock = problem_->model.clock();
  if (started_) ++successes_;
  for (const CriticalPoint& point : step.critical_points) {
    passed_.push_back(point);
    const bool is_loss = result_.lost_at.empty() && point.negative_before == 0 && point.negative_after > 0;
    if (is_loss)
      result_.lost_at =
          std::string(name_of(point.kind)) + " at load factor " + rounded(clock.load_factor(point.load_factor), 6);
    if (!clock.piece()) continue;
    const double low = clock.load_factor(point.load_factor - point.error),
                 high = clock.load_factor(point.load_factor + point.error);
    passed_.back().load_factor = clock.load_factor(point.load_factor);
    passed_.back().error = 0.5 * std::abs(high - low);
  }
  if (!step.jump) return;
  RecordedJump jump = *step.jump;
  jump.from = clock.load_factor(jump.from);
  jump.to = clock.load_factor(jump.to);
  if (jump_) {
    jump.from = jump_->from;
    jump.released += jump_->released;
    jump.motion += jump_->motion;
    jump.factorizations += jump_->factorizations;
  }
  jump_ = std::move(jump);
}

void PathRecorder::converged(const ConvergedStep& step) {
  if (started_ && step.load_factor == result_.load_factor && step.critical_points.empty() && successes_ == 0) {
    record_.clear();  // the start of a later stage is the end of the previous one, which was reported
    return;
  }
  LoadClock& clock = problem_->model.clock();
  parameter_ = step.load_factor;
  keep(step);
  // No load factor represents loads on the way of a jump, or beyond the range of their formulas: do not report these.
  if (clock.piece() && clock.at(step.load_factor).beyond != 0.0) return;
  StepReport report;
  report.load_factor = clock.load_factor(step.load_factor);
  const std::optional<LoadPiece> piece = clock.run(std::nullopt);
  state_ = step.state;
  report.step = started_ ? ++result_.steps : 0;
  result_.load_factor = report.load_factor;
  report.newton_iterations = problem_->work.newton_iterations - counted_;
  report.residual = step.residual;
  if (reports_stability_) {
    report.stability = step.stability;
    report.held_stability = step.held_stability;
    report.critical_points = std::move(passed_);
  }
  passed_.clear();
  if (flutter_) add_flutter(report);
  critical_points_ += static_cast<int>(report.critical_points.size());
  report.jump = std::exchange(jump_, std::nullopt);
  jumps_ += report.jump ? 1 : 0;
  if (looks_at_end_ && is_end_of_stage(report.load_factor, stage_))
    report.stability = Stability(*problem_).try_ask({step.state, report.load_factor}, How::iteration);
  report.point = point(step, report.stability);
  if (piece || part_ != kNoPart) {
    report.point.piece = piece ? piece->from : part_;
    report.point.parameter = step.load_factor;
  }
  report.history = record_.history;
  counted_ = problem_->work.newton_iterations;
  started_ = true;
  branched_ = step.branched;
  record_.clear();
  problem_->attempts.step_completed(result_.steps);
  if (observer_) observer_(report, state_);
  const bool at_end = !is_controlled_ && report.load_factor >= problem_->model.scene().stages;
  if (!at_end && control_.stop && control_.stop()) throw PathInterrupted();
  clock.run(piece);
}

void PathRecorder::add_flutter(StepReport& report) {
  const bool held = report.stability && report.stability->verdict() == Verdict::stable;
  for (CriticalPoint& point : flutter_->passed(state_, report.load_factor, held)) {
    if (result_.lost_at.empty() && point.negative_before == 0)
      result_.lost_at = std::string(name_of(point.kind)) + " at load factor " + rounded(point.load_factor, 6);
    report.critical_points.push_back(std::move(point));
  }
}

void PathRecorder::rejected(const std::string& cause, int iterations) {
  ++failed_in_stage_;
  problem_->attempts.refused(result_.load_factor, cause);
  if (control_.step_failed) control_.step_failed({result_.steps + 1, result_.load_factor, iterations, cause});
}

PathPoint PathRecorder::point(const ConvergedStep& step, const std::optional<StabilityResult>& stability) const {
  const int iterations_before = control_.resume ? control_.resume->newton_iterations : 0;
  PathPoint point;
  point.step = result_.steps;
  point.stage = stage_;
  point.load_factor = result_.load_factor;
  point.step_size = step.step_size;
  point.iterations = record_.iterations;
  point.attempts_left = attempts_ - attempts_made_;
  point.failed_steps = result_.failed_steps + failed_in_stage_;
  point.newton_iterations = iterations_before + problem_->work.newton_iterations;
  point.path_length = step.path_length;
  point.direction = step.direction;
  point.negative = stability ? stability->negative : -1;
  point.branched = step.branched;
  point.critical_points = critical_points_;
  point.jumps = jumps_;
  return point;
}

}  // namespace mixbeam
