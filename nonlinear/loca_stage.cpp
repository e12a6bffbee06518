#include "nonlinear/loca_stage.hpp"

#include "nonlinear/beam_group.hpp"

#include <LOCA_GlobalData.H>
#include <LOCA_Stepper.H>

#include <algorithm>
#include <limits>

namespace mixbeam {

namespace {

/// A prescribed rotation is followed the short way, so one load step may not turn a support by pi or more; the margin
/// leaves room for the rotation limit of Newton's method.
constexpr double kLargestPrescribedTurn = 1.5707963267948966;  // pi / 2

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

Teuchos::RCP<NOX::StatusTest::Generic> status_tests(const SolverParameters& parameters, const StageRange& range,
                                                    const NOX::Utils& utils) {
  const Teuchos::RCP<NOX::StatusTest::Generic> guarded = guarded_status_tests(parameters, utils);
  if (!range.before) return guarded;
  return Teuchos::rcp(new ConvergedBefore(guarded));
}

}  // namespace

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

bool follow_stage_with_loca(const Teuchos::RCP<BeamProblem>& problem, const SolverParameters& parameters,
                            const State& start, const StageRange& range, PathRecorder& recorder) {
  const Scene& scene = problem->assembler.scene();
  const auto top = Teuchos::rcp(new Teuchos::ParameterList("mixbeam"));
  top->sublist("LOCA") = loca_list(scene, parameters, range.from, range.to, range.attempts);
  top->sublist("NOX") = nox_list(problem, parameters, recorder.record());
  const auto sizes = Teuchos::rcp(new StepSizeFactory(step_size_rule(scene, parameters), range.last_step()));
  recorder.enter_stage(range.stage, range.attempts);
  const Teuchos::RCP<LOCA::GlobalData> global = LOCA::createGlobalData(top, sizes);
  bool arrived = false;
  try {
    const auto status = status_tests(parameters, range, *global->locaUtils);
    const auto observer = [&recorder, &sizes](const BeamGroup& group, double load_factor) {
      const StepSizeStrategy* strategy = sizes->strategy();
      if (strategy != nullptr) {
        recorder.set_attempts(strategy->attempts());
        recorder.set_failed_attempts(std::max(0, strategy->attempts() - recorder.successes() - 1));
      }
      ConvergedStep step{group.state(), load_factor, group.isF() ? group.getNormF() : 0.0};
      step.step_size = strategy == nullptr ? 0.0 : strategy->size();
      if (recorder.reports_stability()) step.stability = recorder.counts()->count(group.state(), load_factor);
      recorder.converged(step);
    };
    const auto group = Teuchos::rcp(new BeamGroup(global, problem, start, range.from, observer));
    LOCA::Stepper stepper(global, group, status, top);
    arrived = stepper.run() == LOCA::Abstract::Iterator::Finished;
    recorder.set_failed_attempts(stepper.getNumFailedSteps());
  } catch (const PathInterrupted&) {
    recorder.interrupted();
  } catch (...) {
    LOCA::destroyGlobalData(global);
    throw;
  }
  LOCA::destroyGlobalData(global);
  return arrived && is_end_of_stage(recorder.load_factor(), range.to);
}

}  // namespace mixbeam
