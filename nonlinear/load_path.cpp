#include "nonlinear/load_path.hpp"

#include "discretization/errors.hpp"
#include "nonlinear/automatic_stage.hpp"
#include "nonlinear/newton_setup.hpp"
#include "nonlinear/step_size.hpp"

#include <LOCA_GlobalData.H>
#include <LOCA_Stepper.H>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

namespace mixbeam {

namespace {

constexpr double kPi = 3.14159265358979323846;

/// A prescribed rotation is followed the short way, so one load step may not turn a support by pi or more; the margin
/// leaves room for the rotation limit of Newton's method.
constexpr double kLargestPrescribedTurn = 0.5 * kPi;

/// Step sizes as fractions of a stage, small enough for prescribed rotations.
StepSizeRule step_size_rule(const Scene& scene, const SolverParameters& parameters) {
  const LoadPathParameters& path = parameters.load_path;
  const bool fixed = path.method == LoadPathMethod::fixed;
  const double rotation = largest_prescribed_rotation(scene);
  const double allowed = rotation > 0.0 ? std::min(1.0, kLargestPrescribedTurn / rotation) : 1.0;
  // Rounded steps may add up to a little less than the stage, and the rest would cost one more step: each takes more
  // than the rounding error of one addition on top, and LOCA cuts off the last one at the end of the stage.
  const double equal = 1.0 / path.steps + 2.0 * std::numeric_limits<double>::epsilon() * scene.stages;
  StepSizeRule rule;
  rule.method = path.method;
  rule.aggressiveness = path.aggressiveness;
  rule.most_iterations = parameters.newton.maximum_iterations;
  rule.maximum = std::min(fixed ? equal : path.maximum_step, allowed);
  rule.initial = std::min(fixed ? equal : path.initial_step, rule.maximum);
  rule.minimum = std::min(path.minimum_step, rule.initial);
  return rule;
}

Teuchos::ParameterList loca_list(const Scene& scene, const SolverParameters& parameters, double from, double to,
                                 int steps_left) {
  const StepSizeRule rule = step_size_rule(scene, parameters);
  Teuchos::ParameterList loca("LOCA");
  Teuchos::ParameterList& stepper = loca.sublist("Stepper");
  stepper.set("Continuation Method", "Natural").set("Continuation Parameter", std::string(kLoadFactor));
  stepper.set("Initial Value", from).set("Min Value", from - 1.0).set("Max Value", to);
  stepper.set("Max Steps", steps_left).set("Max Nonlinear Iterations", parameters.newton.maximum_iterations);
  stepper.set("Compute Eigenvalues", false).set("Bordered Solver Method", "Bordering");
  loca.sublist("Predictor").set("Method", "Constant");
  Teuchos::ParameterList& size = loca.sublist("Step Size");
  size.set("Method", rule.method == LoadPathMethod::fixed ? "Constant" : "Adaptive");
  size.set("Initial Step Size", rule.initial).set("Min Step Size", rule.minimum).set("Max Step Size", rule.maximum);
  if (rule.method == LoadPathMethod::adaptive) size.set("Aggressiveness", rule.aggressiveness);
  if (!parameters.loca.is_null()) loca.setParameters(*parameters.loca);
  return loca;
}

/// LOCA solves once where it starts. Where a path is resumed that has been done: another iteration, which some status
/// tests would ask for, would change the state.
class ConvergedBefore : public NOX::StatusTest::Generic {
 public:
  explicit ConvergedBefore(const Teuchos::RCP<NOX::StatusTest::Generic>& later) : later_(later) {}
  NOX::StatusTest::StatusType checkStatus(const NOX::Solver::Generic& solver,
                                          NOX::StatusTest::CheckType type) override {
    if (!started_) {
      started_ = true;
      return NOX::StatusTest::Converged;
    }
    asked_ = true;
    return later_->checkStatus(solver, type);
  }
  NOX::StatusTest::StatusType getStatus() const override {
    return asked_ ? later_->getStatus() : NOX::StatusTest::Converged;
  }
  std::ostream& print(std::ostream& stream, int indent = 0) const override { return later_->print(stream, indent); }

 private:
  Teuchos::RCP<NOX::StatusTest::Generic> later_;
  bool started_ = false, asked_ = false;
};

/// Leaves LOCA's stepper, which cannot be stopped otherwise.
struct PathInterrupted {};

/// What the path knows while LOCA walks along it: the last converged state and the report of each step.
class PathRecorder {
 public:
  PathRecorder(const Teuchos::RCP<BeamProblem>& problem, State& state, const PathObserver& observer,
               const PathControl& control, LoadPathResult& result)
      : problem_(problem), state_(state), observer_(observer), control_(control), result_(result) {
    if (!control.resume) return;
    started_ = true;
    result.steps = control.resume->step;
    result.load_factor = control.resume->load_factor;
    result.failed_steps = control.resume->failed_steps;
    result.newton_iterations = control.resume->newton_iterations;
  }

  SolveRecord& record() { return record_; }

  /// `sizes` may become known later; attempts are those that LOCA may make.
  void enter_stage(const StepSizeFactory& sizes, int attempts) {
    sizes_ = &sizes;
    attempts_ = attempts;
    successes_ = 0;
  }

  void converged(const BeamGroup& group, double load_factor) {
    converged(group.state(), load_factor, group.isF() ? group.getNormF() : 0.0);
  }

  void converged(const State& state, double load_factor, double residual) {
    if (started_ && load_factor == result_.load_factor) {  // the start of a later stage is the end of the one before
      record_.clear();
      return;
    }
    state_ = state;
    if (started_) ++successes_;
    StepReport report;
    report.step = started_ ? ++result_.steps : 0;
    report.load_factor = result_.load_factor = load_factor;
    report.newton_iterations = problem_->work.newton_iterations - counted_;
    report.residual = residual;
    report.point = point();
    report.history = record_.history;
    counted_ = problem_->work.newton_iterations;
    started_ = true;
    record_.clear();
    if (observer_) observer_(report, state_);
    const bool at_end = load_factor >= problem_->assembler.scene().stages;
    if (!at_end && control_.stop && control_.stop()) throw PathInterrupted();
  }

 private:
  PathPoint point() const {
    const StepSizeStrategy* strategy = sizes_->strategy();
    const int attempts = strategy == nullptr ? successes_ : strategy->attempts();
    const int iterations_before = control_.resume ? control_.resume->newton_iterations : 0;
    PathPoint point;
    point.step = result_.steps;
    point.load_factor = result_.load_factor;
    point.step_size = strategy == nullptr ? 0.0 : strategy->size();
    point.iterations = record_.iterations;
    point.attempts_left = attempts_ - attempts;
    point.failed_steps = result_.failed_steps + attempts - successes_;
    point.newton_iterations = iterations_before + problem_->work.newton_iterations;
    return point;
  }

  Teuchos::RCP<BeamProblem> problem_;
  State& state_;
  const PathObserver& observer_;
  const PathControl& control_;
  LoadPathResult& result_;
  SolveRecord record_;
  const StepSizeFactory* sizes_ = nullptr;
  int attempts_ = 0, successes_ = 0;
  int counted_ = 0;
  bool started_ = false;
};

std::string failure_text(const BeamProblem& problem, const LoadPathResult& result, double smallest_step) {
  std::ostringstream text;
  text << "no equilibrium was found beyond load factor " << result.load_factor
       << ": the step was reduced to its minimum of " << smallest_step << ".";
  if (!problem.last_failure.empty()) text << " Last linear solve: " << problem.last_failure << ".";
  const Assembler::EndAngle angle = problem.assembler.largest_end_angle();
  text << " Largest rotation between an element and its vertices: " << angle.angle << " rad (member \"" << angle.member
       << "\", element " << angle.element << "; must stay below pi).";
  text << " What to try: a smaller \"Minimum Step\" or \"Initial Step\" in \"Load Path\", a larger \"Maximum "
          "Iterations\" or a "
          "smaller \"Maximum Rotation\" in \"Newton\", more elements; if the tangent is singular here, the load has "
          "reached a "
          "limit point.";
  return text.str();
}

/// Load factors are sums of rounded steps.
bool is_end_of_stage(double load_factor, double end) { return std::abs(load_factor - end) <= 1e-12 * end; }

/// A stage, or the rest of one.
struct StageRange {
  double from = 0.0, to = 1.0;
  int attempts = 0;                  ///< steps that may be tried
  std::optional<LastStep> before{};  ///< the step that led to `from` when the stage is resumed there
};

Teuchos::RCP<NOX::StatusTest::Generic> status_tests(const SolverParameters& parameters, const StageRange& range,
                                                    const NOX::Utils& utils) {
  const Teuchos::RCP<NOX::StatusTest::Generic> guarded = guarded_status_tests(parameters, utils);
  if (!range.before) return guarded;
  return Teuchos::rcp(new ConvergedBefore(guarded));
}

/// LOCA from one load factor to another. Returns whether it arrived.
bool follow_stage(const Teuchos::RCP<BeamProblem>& problem, const SolverParameters& parameters, const State& start,
                  const StageRange& range, PathRecorder& recorder, LoadPathResult& result) {
  if (range.attempts <= 0) return false;
  const Scene& scene = problem->assembler.scene();
  if (std::getenv("AUTO")) {
    const auto sizes = Teuchos::rcp(new StepSizeFactory(step_size_rule(scene, parameters), range.before));
    recorder.enter_stage(*sizes, range.attempts);
    StageCallbacks callbacks{[&](const Correction& c) { recorder.converged(c.state, c.load_factor, c.residual); }};
    State state = start;
    return follow_automatically(problem, parameters, recorder.record(), callbacks, state, range.from, range.to);
  }
  const auto top = Teuchos::rcp(new Teuchos::ParameterList("mixbeam"));
  top->sublist("LOCA") = loca_list(scene, parameters, range.from, range.to, range.attempts);
  top->sublist("NOX") = nox_list(problem, parameters, recorder.record());
  const auto sizes = Teuchos::rcp(new StepSizeFactory(step_size_rule(scene, parameters), range.before));
  recorder.enter_stage(*sizes, range.attempts);
  const Teuchos::RCP<LOCA::GlobalData> global = LOCA::createGlobalData(top, sizes);
  bool arrived = false;
  try {
    const auto status = status_tests(parameters, range, *global->locaUtils);
    const auto observer = [&recorder](const BeamGroup& group, double load_factor) {
      recorder.converged(group, load_factor);
    };
    const auto group = Teuchos::rcp(new BeamGroup(global, problem, start, range.from, observer));
    LOCA::Stepper stepper(global, group, status, top);
    arrived = stepper.run() == LOCA::Abstract::Iterator::Finished;
    result.failed_steps += stepper.getNumFailedSteps();
  } catch (const PathInterrupted&) {
    result.interrupted = true;
  } catch (...) {
    LOCA::destroyGlobalData(global);
    throw;
  }
  LOCA::destroyGlobalData(global);
  return arrived && is_end_of_stage(result.load_factor, range.to);
}

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
  range.from = stage - 1;
  range.to = stage;
  range.attempts = parameters.load_path.maximum_steps - result.steps;
  const bool inside = control.resume && result.steps == control.resume->step && result.load_factor > range.from;
  if (!inside) return range;
  range.from = control.resume->load_factor;
  range.attempts = control.resume->attempts_left;
  range.before = LastStep{control.resume->step_size, control.resume->iterations};
  return range;
}

/// Stages that are behind a path when it is resumed. The last one may have ended without the check that follows it.
int finished_stages(const Teuchos::RCP<BeamProblem>& problem, const State& state, const PathControl& control) {
  if (!control.resume) return 0;
  const int stage = static_cast<int>(std::lround(control.resume->load_factor));
  const bool at_end = stage > 0 && is_end_of_stage(control.resume->load_factor, stage);
  if (!at_end) return static_cast<int>(std::floor(control.resume->load_factor));
  MixedVector residual = problem->assembler.create_vector();
  problem->assembler.residual(state, control.resume->load_factor, residual);
  check_end_angles(*problem);
  return stage;
}

}  // namespace

LoadPathResult follow_load_path(const Teuchos::RCP<BeamProblem>& problem, const SolverParameters& parameters,
                                State& state, const PathObserver& observer, const PathControl& control) {
  LoadPathResult result;
  PathRecorder recorder(problem, state, observer, control, result);
  const int stages = problem->assembler.scene().stages;
  for (int stage = finished_stages(problem, state, control) + 1; stage <= stages; ++stage) {
    const int before = problem->work.newton_iterations;
    const bool arrived =
        follow_stage(problem, parameters, state, range_of_stage(stage, parameters, control, result), recorder, result);
    result.iterations_of_stage.push_back(problem->work.newton_iterations - before);
    result.newton_iterations += result.iterations_of_stage.back();
    if (result.interrupted) return result;
    if (!arrived) {
      result.failure = failure_text(*problem, result, step_size_rule(problem->assembler.scene(), parameters).minimum);
      return result;
    }
    check_end_angles(*problem);
  }
  result.finished = true;
  return result;
}

}  // namespace mixbeam
