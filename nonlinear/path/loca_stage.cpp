#include "nonlinear/path/loca_stage.hpp"

#include "nonlinear/newton/beam_group.hpp"
#include "nonlinear/path/step_examiner.hpp"

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

/// Cosines as of all steps of the load; critical points inside are looked for, since no other method follows.
constexpr StepTest kExamined{0.5, -0.5, true, false, true};

/// What Newton's method finds is a step only if it follows the path. LOCA takes any other for one that has failed and
/// tries a smaller one.
class StepsAreExamined : public NOX::StatusTest::Generic {
 public:
  /// LOCA solves once where it starts. Where a path is resumed that has been done: another iteration, which some status
  /// tests would ask for, would change the state.
  StepsAreExamined(const Teuchos::RCP<BeamProblem>& problem, const Teuchos::RCP<NOX::StatusTest::Generic>& newton,
                   StepExaminer& examiner, bool begins_converged, bool load_grows)
      : problem_(problem),
        newton_(newton),
        examiner_(examiner),
        begins_converged_(begins_converged),
        load_grows_(load_grows) {}

  NOX::StatusTest::StatusType checkStatus(const NOX::Solver::Generic& solver,
                                          NOX::StatusTest::CheckType type) override {
    const bool stays = begins_converged_ && !here_;
    status_ = stays ? NOX::StatusTest::Converged : newton_->checkStatus(solver, type);
    if (status_ == NOX::StatusTest::Converged) examine(solver.getSolutionGroup());
    return status_;
  }
  NOX::StatusTest::StatusType getStatus() const override { return status_; }
  std::ostream& print(std::ostream& stream, int indent = 0) const override { return newton_->print(stream, indent); }

  /// What the last step has led to: the path goes on from there.
  StepFindings accept() {
    here_ = std::move(next_);
    moved_to_ = Teuchos::rcp(new MixedVector(next_moved_->clone(true)));
    return std::move(findings_);
  }
  const Station& here() const { return *here_; }

 private:
  void examine(const NOX::Abstract::Group& solution) {
    const BeamGroup& group = BeamGroup::of(solution);
    const MixedVector& x = BeamVector::of(group.getX());
    next_moved_ = Teuchos::rcp(new MixedVector(x.clone(true)));
    findings_ = {};
    if (!here_) {
      next_ = examiner_.station(group.state(), group.load_factor(), nullptr);
      return;
    }
    PathDirection moved{x.clone(true), group.load_factor() - here_->load_factor};
    moved.x.update(-1.0, *moved_to_, 1.0);
    next_ = examiner_.station(group.state(), group.load_factor(), load_grows_ ? nullptr : &moved);
    findings_ = examiner_.examine({*here_, moved, *next_}, kExamined);
    problem_->last_failure.clear();
    problem_->objection = findings_.objection;
    if (!findings_.objection.empty()) status_ = NOX::StatusTest::Failed;
  }

  Teuchos::RCP<BeamProblem> problem_;
  Teuchos::RCP<NOX::StatusTest::Generic> newton_;
  StepExaminer& examiner_;
  bool begins_converged_;
  bool load_grows_;  ///< in each step; else LOCA follows the path by its length
  NOX::StatusTest::StatusType status_ = NOX::StatusTest::Unevaluated;
  // Sums of increments since the stage began belong to the stations:
  std::optional<Station> here_, next_;
  Teuchos::RCP<MixedVector> moved_to_, next_moved_;
  StepFindings findings_;
};

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
  const Scene& scene = problem->model.scene();
  const auto top = Teuchos::rcp(new Teuchos::ParameterList("mixbeam"));
  top->sublist("LOCA") = loca_list(scene, parameters, range.from, range.to, range.attempts);
  top->sublist("NOX") = nox_list(problem, parameters, recorder.record());
  const auto sizes = Teuchos::rcp(new StepSizeFactory(step_size_rule(scene, parameters), range.last_step()));
  recorder.enter_stage(range.stage, range.attempts);
  const Teuchos::RCP<LOCA::GlobalData> global = LOCA::createGlobalData(top, sizes);
  bool arrived = false;
  try {
    StepExaminer examiner(problem, parameters, recorder.counts(), range.to);
    const bool load_grows =
        top->sublist("LOCA").sublist("Stepper").get<std::string>("Continuation Method") == "Natural";
    const auto status = Teuchos::rcp(new StepsAreExamined(problem, guarded_status_tests(parameters, *global->locaUtils),
                                                          examiner, range.before.has_value(), load_grows));
    const auto observer = [&recorder, &sizes, status](const BeamGroup& group, double load_factor) {
      const StepSizeStrategy* strategy = sizes->strategy();
      if (strategy != nullptr) {
        recorder.set_attempts(strategy->attempts());
        recorder.set_failed_attempts(std::max(0, strategy->attempts() - recorder.successes() - 1));
      }
      ConvergedStep step{group.state(), load_factor, group.isF() ? group.getNormF() : 0.0};
      step.step_size = strategy == nullptr ? 0.0 : strategy->size();
      step.critical_points = status->accept().passed;
      step.stability = status->here().stability;
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
