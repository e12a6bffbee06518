#include "nonlinear/newton/newton_setup.hpp"

#include "nonlinear/newton/beam_group.hpp"
#include "nonlinear/newton/thresholds.hpp"

#include <LOCA_ErrorCheck.H>
#include <LOCA_Factory.H>
#include <LOCA_Parameter_SublistParser.H>
#include <NOX_LineSearch_Generic.H>
#include <NOX_LineSearch_UserDefinedFactory.H>
#include <NOX_Solver_Generic.H>
#include <NOX_StatusTest_Combo.H>
#include <NOX_StatusTest_Factory.H>
#include <NOX_StatusTest_FiniteValue.H>
#include <NOX_StatusTest_MaxIters.H>
#include <NOX_StatusTest_NormF.H>
#include <NOX_Observer.hpp>
#include <Teuchos_oblackholestream.hpp>

#include <ostream>
#include <string>

namespace mixbeam {

namespace {

/// Adapter that presents step_within_rotation() to NOX as a line search.
class RotationLimitedLineSearch : public NOX::LineSearch::Generic {
 public:
  explicit RotationLimitedLineSearch(double maximum_rotation) : maximum_rotation_(maximum_rotation) {}
  bool compute(NOX::Abstract::Group& group, double& step, const NOX::Abstract::Vector& direction,
               const NOX::Solver::Generic& solver) override {
    step = step_within_rotation(group, solver.getPreviousSolutionGroup(), direction, maximum_rotation_);
    return true;
  }

 private:
  double maximum_rotation_;
};

struct RotationLimitedFactory : NOX::LineSearch::UserDefinedFactory {
  explicit RotationLimitedFactory(double maximum_rotation) : maximum_rotation_(maximum_rotation) {}
  Teuchos::RCP<NOX::LineSearch::Generic> buildLineSearch(const Teuchos::RCP<NOX::GlobalData>&,
                                                         Teuchos::ParameterList&) const override {
    return Teuchos::rcp(new RotationLimitedLineSearch(maximum_rotation_));
  }
  double maximum_rotation_;
};

/// Test that the cap of the tangent left a negligible part out of the last step; combine it by AND with a test of the
/// residual.
///
/// It is needed for tiny loads: residuals of compatibility allow for the rounding errors of strains, which are
/// differences of numbers of size one. Where these errors do not arise (members along an axis), the residual cannot
/// distinguish the first increment of a capped tangent from an equilibrium, although it misses some 1e-5 of the motion.
class CapStatusTest : public NOX::StatusTest::Generic {
 public:
  NOX::StatusTest::StatusType checkStatus(const NOX::Solver::Generic& solver,
                                          NOX::StatusTest::CheckType type) override {
    using namespace NOX::StatusTest;
    if (solver.getNumIterations() == 0) refusals_ = 0;
    status_ = Converged;
    if (type == None) {
      status_ = Unevaluated;
    } else if (solver.getNumIterations() > 0 && refusals_ < newton_limit.most_refusals) {
      const BeamGroup& before = BeamGroup::of(solver.getPreviousSolutionGroup());
      if (BeamGroup::of(solver.getSolutionGroup()).left_out_since(before) > newton_limit.negligible_cap_motion)
        status_ = Unconverged;
      refusals_ += status_ == Unconverged ? 1 : 0;
    }
    return status_;
  }
  NOX::StatusTest::StatusType getStatus() const override { return status_; }
  std::ostream& print(std::ostream& stream, int indent = 0) const override {
    return stream << std::string(static_cast<std::size_t>(indent), ' ') << status_ << "the cap of the tangent\n";
  }

 private:
  NOX::StatusTest::StatusType status_ = NOX::StatusTest::Unevaluated;
  int refusals_ = 0;  ///< in the present solve
};

/// Counts Newton iterations, also those of failed attempts, and keeps the norm of each.
class IterationRecorder : public NOX::Observer {
 public:
  IterationRecorder(BeamProblem& problem, SolveRecord& record, NewtonPurpose purpose)
      : problem_(problem), record_(record), is_check_(purpose == NewtonPurpose::check) {}
  void start() {
    ++record_.attempt;
    record_.iterations = 0;
    problem_.last_failure.clear();
    problem_.objection.clear();
    if (!is_check_) problem_.attempts.start_attempt();
  }
  /// `before`: null before the first iteration.
  void iterated(const NOX::Abstract::Group& now, const NOX::Abstract::Group* before, int iterations) {
    if (is_check_) return;
    record_.iterations = iterations;
    if (iterations == 1) add(0, *before);
    add(iterations, now);
    problem_.attempts.iterated(BeamGroup::of(now), before == nullptr ? nullptr : &BeamGroup::of(*before), iterations);
  }
  void runPreSolve(const NOX::Solver::Generic&) override { start(); }
  void runPreIterate(const NOX::Solver::Generic&) override {
    if (problem_.leave_if_asked) problem_.leave_if_asked();
  }
  void runPreLineSearch(const NOX::Solver::Generic&) override {
    ++(is_check_ ? problem_.work.check_iterations : problem_.work.newton_iterations);
  }
  void runPostIterate(const NOX::Solver::Generic& solver) override {
    const int iterations = solver.getNumIterations();
    iterated(solver.getSolutionGroup(), iterations > 0 ? &solver.getPreviousSolutionGroup() : nullptr, iterations);
  }
  void runPostSolve(const NOX::Solver::Generic& solver) override {
    if (is_check_ || solver.getStatus() != NOX::StatusTest::Failed) return;
    problem_.attempts.failed(BeamGroup::of(solver.getSolutionGroup()), solver.getNumIterations());
  }

 private:
  void add(int iteration, const NOX::Abstract::Group& group) {
    const BeamGroup& beam = BeamGroup::of(group);
    if (beam.isF()) record_.history.push_back({record_.attempt, iteration, beam.getNormF()});
  }

  BeamProblem& problem_;
  SolveRecord& record_;
  bool is_check_;
};

/// Tests the norm that the other tests use too, in which NaN counts as infinity.
Teuchos::RCP<NOX::StatusTest::Generic> finite_residual() {
  using NOX::StatusTest::FiniteValue;
  return Teuchos::rcp(new FiniteValue(FiniteValue::FVector, NOX::Abstract::Vector::MaxNorm));
}

Teuchos::RCP<NOX::StatusTest::Generic> default_status_tests(const NewtonParameters& newton) {
  namespace Test = NOX::StatusTest;
  const auto converged = Teuchos::rcp(new Test::Combo(Test::Combo::AND));
  converged->addStatusTest(
      Teuchos::rcp(new Test::NormF(newton.residual_tolerance, NOX::Abstract::Vector::MaxNorm, Test::NormF::Unscaled)));
  converged->addStatusTest(Teuchos::rcp(new CapStatusTest()));
  const auto tests = Teuchos::rcp(new Test::Combo(Test::Combo::OR, converged));
  tests->addStatusTest(finite_residual());
  tests->addStatusTest(Teuchos::rcp(new Test::MaxIters(newton.maximum_iterations)));
  return tests;
}

/// Sets the user's list. By default silences NOX, for the program reports by itself: LOCA prints some messages whatever
/// "Output Information" says, and messages that are let through cost text and norms although nobody reads them.
void set_printing(const SolverParameters& parameters, Teuchos::ParameterList& printing) {
  if (!parameters.nox.is_null() && parameters.nox->isSublist("Printing")) {
    printing = parameters.nox->sublist("Printing");
    return;
  }
  const Teuchos::RCP<std::ostream> nowhere = Teuchos::rcp(new Teuchos::oblackholestream);
  printing.set("Output Stream", nowhere).set("Error Stream", nowhere);
  printing.set("Output Information", static_cast<int>(NOX::Utils::Error));
}

/// A user's status tests need not end an iteration that diverges or whose residual is NaN; these always do.
Teuchos::RCP<NOX::StatusTest::Generic> with_guards(const Teuchos::RCP<NOX::StatusTest::Generic>& tests) {
  const auto guarded = Teuchos::rcp(new NOX::StatusTest::Combo(NOX::StatusTest::Combo::OR));
  guarded->addStatusTest(tests);
  guarded->addStatusTest(finite_residual());
  guarded->addStatusTest(Teuchos::rcp(new NOX::StatusTest::MaxIters(newton_limit.iterations_without_end)));
  return guarded;
}

}  // namespace

LocaData::LocaData(const SolverParameters& parameters) {
  Teuchos::ParameterList printing;
  set_printing(parameters, printing);
  // as LOCA::createGlobalData(), without its parsed lists, which nobody reads
  global = Teuchos::rcp(new LOCA::GlobalData(Teuchos::rcp(new NOX::Utils(printing)), Teuchos::null, Teuchos::null));
  global->locaErrorCheck = Teuchos::rcp(new LOCA::ErrorCheck(global));
  global->locaFactory = Teuchos::rcp(new LOCA::Factory(global));
}

bool is_solved(const SolverParameters& parameters, SolveRecord& record, NewtonPurpose purpose, BeamGroup& group) {
  if (!parameters.nox.is_null() || !parameters.status_tests.is_null()) return false;
  group.computeF();
  if (!(group.getNormF() < parameters.newton.residual_tolerance)) return false;
  IterationRecorder recorder(group.problem(), record, purpose);
  recorder.start();
  if (group.problem().leave_if_asked) group.problem().leave_if_asked();
  recorder.iterated(group, nullptr, 0);
  return true;
}

Teuchos::ParameterList nox_list(const Teuchos::RCP<BeamProblem>& problem, const SolverParameters& parameters,
                                SolveRecord& record, NewtonPurpose purpose) {
  Teuchos::ParameterList nox("NOX");
  nox.set("Nonlinear Solver", "Line Search Based");
  nox.sublist("Direction").set("Method", "Newton");
  nox.sublist("Line Search").set("Method", kRotationLimited);
  if (!parameters.nox.is_null()) nox.setParameters(*parameters.nox);
  set_printing(parameters, nox.sublist("Printing"));
  Teuchos::ParameterList& search = nox.sublist("Line Search");
  if (search.get<std::string>("Method", kRotationLimited) == kRotationLimited) {
    const Teuchos::RCP<NOX::LineSearch::UserDefinedFactory> factory =
        Teuchos::rcp(new RotationLimitedFactory(parameters.newton.maximum_rotation));
    search.set("Method", "User Defined");
    search.set("User Defined Line Search Factory", factory);
  }
  const Teuchos::RCP<NOX::Observer> observer = Teuchos::rcp(new IterationRecorder(*problem, record, purpose));
  nox.sublist("Solver Options").set("Observer", observer);
  return nox;
}

Teuchos::RCP<NOX::StatusTest::Generic> guarded_status_tests(const SolverParameters& parameters,
                                                            const NOX::Utils& utils) {
  if (parameters.status_tests.is_null()) return with_guards(default_status_tests(parameters.newton));
  Teuchos::ParameterList tests = *parameters.status_tests;
  return with_guards(NOX::StatusTest::buildStatusTests(tests, utils));
}

}  // namespace mixbeam
