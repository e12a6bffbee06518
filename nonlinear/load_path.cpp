#include "nonlinear/load_path.hpp"

#include "discretization/errors.hpp"
#include "nonlinear/rotation_limited_line_search.hpp"

#include <LOCA_GlobalData.H>
#include <LOCA_Stepper.H>
#include <NOX_StatusTest_Combo.H>
#include <NOX_StatusTest_Factory.H>
#include <NOX_StatusTest_FiniteValue.H>
#include <NOX_StatusTest_MaxIters.H>
#include <NOX_Observer.hpp>
#include <Teuchos_oblackholestream.hpp>

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

/// Counts Newton iterations, also those of failed attempts.
class IterationCounter : public NOX::Observer {
 public:
  explicit IterationCounter(BeamProblem& problem) : problem_(problem) {}
  void runPreLineSearch(const NOX::Solver::Generic&) override { ++problem_.work.newton_iterations; }

 private:
  BeamProblem& problem_;
};

Teuchos::ParameterList default_status_tests(const NewtonParameters& newton) {
  Teuchos::ParameterList tests("Status Tests");
  tests.set("Test Type", "Combo").set("Combo Type", "OR").set("Number of Tests", 3);
  Teuchos::ParameterList& residual = tests.sublist("Test 0");
  residual.set("Test Type", "NormF").set("Norm Type", "Max Norm").set("Scale Type", "Unscaled");
  residual.set("Tolerance", newton.residual_tolerance);
  tests.sublist("Test 1").set("Test Type", "FiniteValue");
  tests.sublist("Test 2").set("Test Type", "MaxIters").set("Maximum Iterations", newton.maximum_iterations);
  return tests;
}

Teuchos::ParameterList default_nox(const NewtonParameters&) {
  Teuchos::ParameterList nox("NOX");
  nox.set("Nonlinear Solver", "Line Search Based");
  nox.sublist("Direction").set("Method", "Newton");
  nox.sublist("Line Search").set("Method", kRotationLimited);
  // Nothing but what the program itself reports: LOCA prints some messages whatever "Output Information" says.
  const Teuchos::RCP<std::ostream> nowhere = Teuchos::rcp(new Teuchos::oblackholestream);
  nox.sublist("Printing").set("Output Stream", nowhere).set("Error Stream", nowhere);
  return nox;
}

/// The user's list, or the default, with our own objects put where their names stand.
Teuchos::ParameterList nox_list(const Teuchos::RCP<BeamProblem>& problem, const SolverParameters& parameters) {
  Teuchos::ParameterList nox = default_nox(parameters.newton);
  if (!parameters.nox.is_null()) {
    if (parameters.nox->isSublist("Printing")) nox.remove("Printing");
    nox.setParameters(*parameters.nox);
  }
  Teuchos::ParameterList& search = nox.sublist("Line Search");
  if (search.get<std::string>("Method", kRotationLimited) == kRotationLimited) {
    const Teuchos::RCP<NOX::LineSearch::UserDefinedFactory> factory =
        Teuchos::rcp(new RotationLimitedFactory(parameters.newton.maximum_rotation));
    search.set("Method", "User Defined");
    search.set("User Defined Line Search Factory", factory);
  }
  const Teuchos::RCP<NOX::Observer> observer = Teuchos::rcp(new IterationCounter(*problem));
  nox.sublist("Solver Options").set("Observer", observer);
  return nox;
}

/// Step sizes as fractions of a stage, small enough for prescribed rotations.
struct StepSizes {
  double initial, minimum, maximum;
};

StepSizes step_sizes(const Scene& scene, const LoadPathParameters& path) {
  const bool fixed = path.method == LoadPathMethod::fixed;
  const double rotation = largest_prescribed_rotation(scene);
  const double allowed = rotation > 0.0 ? std::min(1.0, kLargestPrescribedTurn / rotation) : 1.0;
  // Rounded steps may add up to a little less than the stage, and the rest would cost one more step: each takes more
  // than the rounding error of one addition on top, and LOCA cuts off the last one at the end of the stage.
  const double equal = 1.0 / path.steps + 2.0 * std::numeric_limits<double>::epsilon() * scene.stages;
  StepSizes sizes{fixed ? equal : path.initial_step, path.minimum_step, fixed ? equal : path.maximum_step};
  sizes.maximum = std::min(sizes.maximum, allowed);
  sizes.initial = std::min(sizes.initial, sizes.maximum);
  sizes.minimum = std::min(sizes.minimum, sizes.initial);
  return sizes;
}

Teuchos::ParameterList loca_list(const Scene& scene, const SolverParameters& parameters, double from, double to,
                                 int steps_left) {
  const LoadPathParameters& path = parameters.load_path;
  const StepSizes sizes = step_sizes(scene, path);
  Teuchos::ParameterList loca("LOCA");
  Teuchos::ParameterList& stepper = loca.sublist("Stepper");
  stepper.set("Continuation Method", "Natural").set("Continuation Parameter", std::string(kLoadFactor));
  stepper.set("Initial Value", from).set("Min Value", from - 1.0).set("Max Value", to);
  stepper.set("Max Steps", steps_left).set("Max Nonlinear Iterations", parameters.newton.maximum_iterations);
  stepper.set("Compute Eigenvalues", false).set("Bordered Solver Method", "Bordering");
  loca.sublist("Predictor").set("Method", "Constant");
  Teuchos::ParameterList& size = loca.sublist("Step Size");
  size.set("Method", path.method == LoadPathMethod::fixed ? "Constant" : "Adaptive");
  size.set("Initial Step Size", sizes.initial).set("Min Step Size", sizes.minimum).set("Max Step Size", sizes.maximum);
  if (path.method == LoadPathMethod::adaptive) size.set("Aggressiveness", path.aggressiveness);
  if (!parameters.loca.is_null()) loca.setParameters(*parameters.loca);
  return loca;
}

/// A user's status tests need not end an iteration that wanders or leaves the numbers; these always do.
Teuchos::RCP<NOX::StatusTest::Generic> with_guards(const Teuchos::RCP<NOX::StatusTest::Generic>& tests) {
  constexpr int kIterationsWithoutEnd = 1000;
  const auto guarded = Teuchos::rcp(new NOX::StatusTest::Combo(NOX::StatusTest::Combo::OR));
  guarded->addStatusTest(tests);
  guarded->addStatusTest(Teuchos::rcp(new NOX::StatusTest::FiniteValue()));
  guarded->addStatusTest(Teuchos::rcp(new NOX::StatusTest::MaxIters(kIterationsWithoutEnd)));
  return guarded;
}

/// What the path knows while LOCA walks along it: the last converged state and the report of each step.
class PathRecorder {
 public:
  PathRecorder(const Teuchos::RCP<BeamProblem>& problem, State& state, const PathObserver& observer,
               LoadPathResult& result)
      : problem_(problem), state_(state), observer_(observer), result_(result) {}

  void converged(const BeamGroup& group, double load_factor) {
    if (started_ && load_factor == result_.load_factor)
      return;  // the start of a later stage is the end of the one before
    state_ = group.state();
    const int done = problem_->work.newton_iterations;
    StepReport report;
    report.step = started_ ? ++result_.steps : 0;
    report.load_factor = result_.load_factor = load_factor;
    report.newton_iterations = done - counted_;
    report.residual = group.isF() ? group.getNormF() : 0.0;
    counted_ = done;
    started_ = true;
    if (observer_) observer_(report, state_);
  }

 private:
  Teuchos::RCP<BeamProblem> problem_;
  State& state_;
  const PathObserver& observer_;
  LoadPathResult& result_;
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

/// One stage: LOCA from load factor `from` to `to`. Returns whether it arrived.
bool follow_stage(const Teuchos::RCP<BeamProblem>& problem, const SolverParameters& parameters, const State& start,
                  double from, double to, int steps_left, PathRecorder& recorder, LoadPathResult& result) {
  const auto top = Teuchos::rcp(new Teuchos::ParameterList("mixbeam"));
  top->sublist("LOCA") = loca_list(problem->assembler.scene(), parameters, from, to, steps_left);
  top->sublist("NOX") = nox_list(problem, parameters);
  Teuchos::ParameterList tests =
      parameters.status_tests.is_null() ? default_status_tests(parameters.newton) : *parameters.status_tests;
  const Teuchos::RCP<LOCA::GlobalData> global = LOCA::createGlobalData(top, Teuchos::null);
  bool arrived = false;
  try {
    const auto status = with_guards(NOX::StatusTest::buildStatusTests(tests, *global->locaUtils));
    const auto observer = [&recorder](const BeamGroup& group, double load_factor) {
      recorder.converged(group, load_factor);
    };
    const auto group = Teuchos::rcp(new BeamGroup(global, problem, start, from, observer));
    LOCA::Stepper stepper(global, group, status, top);
    arrived = stepper.run() == LOCA::Abstract::Iterator::Finished;
    result.failed_steps += stepper.getNumFailedSteps();
  } catch (...) {
    LOCA::destroyGlobalData(global);
    throw;
  }
  LOCA::destroyGlobalData(global);
  return arrived && std::abs(result.load_factor - to) <= 1e-12 * to;
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

}  // namespace

LoadPathResult follow_load_path(const Teuchos::RCP<BeamProblem>& problem, const SolverParameters& parameters,
                                State& state, const PathObserver& observer) {
  LoadPathResult result;
  PathRecorder recorder(problem, state, observer, result);
  const int stages = problem->assembler.scene().stages;
  for (int stage = 1; stage <= stages; ++stage) {
    const int before = problem->work.newton_iterations;
    const bool arrived = follow_stage(problem, parameters, state, stage - 1, stage,
                                      parameters.load_path.maximum_steps - result.steps, recorder, result);
    result.iterations_of_stage.push_back(problem->work.newton_iterations - before);
    result.newton_iterations += result.iterations_of_stage.back();
    if (!arrived) {
      result.failure =
          failure_text(*problem, result, step_sizes(problem->assembler.scene(), parameters.load_path).minimum);
      return result;
    }
    check_end_angles(*problem);
  }
  result.finished = true;
  return result;
}

}  // namespace mixbeam
