// A stage of the load path by LOCA's stepper: steps of the load factor, fixed or adaptive, or as the user's list "LOCA"
// says.
#include "discretization/state/difference.hpp"
#include "nonlinear/newton/beam_group.hpp"
#include "nonlinear/path/path_recorder.hpp"
#include "nonlinear/path/step_judge.hpp"

#include <LOCA_Abstract_Factory.H>
#include <LOCA_GlobalData.H>
#include <LOCA_MultiContinuation_ExtendedVector.H>
#include <LOCA_Parameter_SublistParser.H>
#include <LOCA_StepSize_AbstractStrategy.H>
#include <LOCA_Stepper.H>
#include <NOX_Solver_Generic.H>

#include <algorithm>

namespace mixbeam {

namespace {

Teuchos::ParameterList loca_list(const Model& model, const SolverParameters& parameters, double from, double to,
                                 int steps_left) {
  const StepSizeRule rule = step_size_rule(model, parameters);
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

/// Adapter of the rule for LOCA's stepper, for continuation in the load factor; arc length keeps LOCA's own rule.
class StepSizes : public LOCA::Abstract::Factory, public LOCA::StepSize::AbstractStrategy {
 public:
  /// `before`: the last step of a resumed path; none: the path, or a stage of it, starts. Must outlive the stepper.
  StepSizes(const StepSizeRule& rule, const std::optional<LastStep>& before) : rule_(rule), before_(before) {}

  void init(const Teuchos::RCP<LOCA::GlobalData>&) override {}
  bool createStepSizeStrategy(const std::string& name, const Teuchos::RCP<LOCA::Parameter::SublistParser>& lists,
                              const Teuchos::RCP<Teuchos::ParameterList>& parameters,
                              Teuchos::RCP<LOCA::StepSize::AbstractStrategy>& strategy) override {
    if (name != "Constant" && name != "Adaptive") return false;
    if (lists->getSublist("Stepper")->get<std::string>("Continuation Method") != "Natural") return false;
    rule_.method = name == "Constant" ? LoadPathMethod::fixed : LoadPathMethod::adaptive;
    rule_.failed_factor = parameters->get("Failed Step Reduction Factor", rule_.failed_factor);
    rule_.success_factor = parameters->get("Successful Step Increase Factor", rule_.success_factor);
    strategy = Teuchos::rcp(this, false);
    return decides_ = true;
  }
  NOX::Abstract::Group::ReturnType computeStepSize(LOCA::MultiContinuation::AbstractStrategy&,
                                                   const LOCA::MultiContinuation::ExtendedVector& predictor,
                                                   const NOX::Solver::Generic& solver,
                                                   const LOCA::Abstract::Iterator::StepStatus& status,
                                                   const LOCA::Abstract::Iterator&, double& size) override {
    if (attempts_ ==
        0) {  // the predictor's share of the load factor is 1 in natural continuation, but LOCA permits others
      const double share = predictor.getScalar(0);
      if (share != 0.0)
        for (double* number : {&rule_.initial, &rule_.minimum, &rule_.maximum}) *number /= share;
      size = before_ ? rule_.after_success(before_->size, before_->iterations) : rule_.initial;
    } else if (status == LOCA::Abstract::Iterator::Unsuccessful) {
      size = rule_.after_failure(size);
    } else {
      previous_ = size;
      size = rule_.after_success(size, solver.getNumIterations());
    }
    ++attempts_;
    const bool too_small = size < rule_.minimum;
    size_ = size = std::clamp(size, rule_.minimum, rule_.maximum);
    return too_small ? NOX::Abstract::Group::Failed : NOX::Abstract::Group::Ok;
  }
  double getPrevStepSize() const override { return previous_; }
  double getStartStepSize() const override { return rule_.initial; }

  bool decides() const { return decides_; }   ///< this rule is in use, not a strategy of LOCA's
  double size() const { return size_; }       ///< of the present attempt
  int attempts() const { return attempts_; }  ///< sizes given so far

 private:
  StepSizeRule rule_;
  std::optional<LastStep> before_;
  double size_ = 0.0, previous_ = 0.0;
  int attempts_ = 0;
  bool decides_ = false;
};

/// Fails a converged step that does not follow the path. LOCA then tries a smaller one.
class StepsAreExamined : public NOX::StatusTest::Generic {
 public:
  /// `begins_converged`: skips the solve at the start of a resumed path, which LOCA requires, because an iteration,
  /// which some status tests would require, would change the state.
  StepsAreExamined(const Teuchos::RCP<BeamProblem>& problem, const Teuchos::RCP<NOX::StatusTest::Generic>& newton,
                   StepJudge& judge, bool begins_converged, bool load_grows)
      : problem_(problem),
        newton_(newton),
        judge_(judge),
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

  /// Accepts the last step, from which the path continues; returns its findings.
  StepFindings accept() {
    problem_->forget_tangents();  // like a resumed path, which has none
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
    problem_->forget_tangents();
    if (!here_) {
      next_ = judge_.station(group.state(), group.load_factor(), nullptr);
      return;
    }
    MixedVector sum = x.clone(true);
    sum.update(-1.0, *moved_to_, 1.0);  // its rounding depends on the start of the stage, unknown to a resumed path
    const PathDirection moved{increment_between(problem_->model, here_->state, group.state(), sum),
                              group.load_factor() - here_->load_factor};
    next_ = judge_.station(group.state(), group.load_factor(), load_grows_ ? nullptr : &moved);
    findings_ = judge_.examine({*here_, moved, *next_}, kExaminedStep);
    problem_->last_failure.clear();
    problem_->objection = findings_.objection;
    if (!findings_.objection.empty()) status_ = NOX::StatusTest::Failed;
  }

  Teuchos::RCP<BeamProblem> problem_;
  Teuchos::RCP<NOX::StatusTest::Generic> newton_;
  StepJudge& judge_;
  bool begins_converged_;
  bool load_grows_;  ///< in each step; false: LOCA follows the path by arc length
  NOX::StatusTest::StatusType status_ = NOX::StatusTest::Unevaluated;
  // Stations, and sums of increments since the start of the stage that belong to them:
  std::optional<Station> here_, next_;
  Teuchos::RCP<MixedVector> moved_to_, next_moved_;
  StepFindings findings_;
};

}  // namespace

bool follow_stage_with_loca(const Teuchos::RCP<BeamProblem>& problem, const SolverParameters& parameters,
                            const State& start, const StageRange& range, PathRecorder& recorder) {
  const Model& model = problem->model;
  const auto top = Teuchos::rcp(new Teuchos::ParameterList("mixbeam"));
  top->sublist("LOCA") = loca_list(model, parameters, range.from, range.to, range.attempts);
  top->sublist("NOX") = nox_list(problem, parameters, recorder.record());
  const auto sizes = Teuchos::rcp(new StepSizes(step_size_rule(model, parameters), range.last_step()));
  recorder.enter_stage(range.stage, range.attempts);
  const Teuchos::RCP<LOCA::GlobalData> global = LOCA::createGlobalData(top, sizes);
  bool arrived = false;
  try {
    StepJudge judge(problem, parameters, recorder.counts(), range.to);
    const bool load_grows =
        top->sublist("LOCA").sublist("Stepper").get<std::string>("Continuation Method") == "Natural";
    const auto status = Teuchos::rcp(new StepsAreExamined(problem, guarded_status_tests(parameters, *global->locaUtils),
                                                          judge, range.before.has_value(), load_grows));
    const auto observer = [&recorder, &sizes, status](const BeamGroup& group, double load_factor) {
      if (sizes->decides()) {
        recorder.set_attempts(sizes->attempts());
        recorder.set_failed_attempts(std::max(0, sizes->attempts() - recorder.successes() - 1));
      }
      ConvergedStep step{group.state(), load_factor, group.isF() ? group.getNormF() : 0.0};
      step.step_size = sizes->decides() ? sizes->size() : 0.0;
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
  return arrived && is_end_of_stage(recorder.parameter(), range.to);
}

}  // namespace mixbeam
