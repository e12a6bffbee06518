#include "nonlinear/corrector.hpp"

#include "nonlinear/beam_group.hpp"

#include <LOCA_MultiContinuation_ConstrainedGroup.H>
#include <LOCA_Parameter_SublistParser.H>
#include <NOX_Solver_Factory.H>
#include <NOX_StatusTest_Combo.H>
#include <NOX_StatusTest_MaxIters.H>

#include <cmath>
#include <stdexcept>

namespace mixbeam {

Corrector::Corrector(const Teuchos::RCP<BeamProblem>& problem, const SolverParameters& parameters, SolveRecord& record)
    : problem_(problem), parameters_(parameters), record_(record) {
  lists_ = Teuchos::rcp(new Teuchos::ParameterList("mixbeam"));
  lists_->sublist("NOX") = nox_list(problem, parameters, record);
  lists_->sublist("LOCA").sublist("Stepper");
  lists_->sublist("LOCA").sublist("Constraints").set("Bordered Solver Method", "Bordering");
  global_ = LOCA::createGlobalData(lists_);
}

Corrector::~Corrector() { LOCA::destroyGlobalData(global_); }

namespace {

/// Next to a critical point the cap of the tangent is felt more, and with the usual one Newton's method comes to a
/// stop at 1e-8; the condition of the tangent, which limits the first increments only, is of less importance there.
constexpr double kCapRaise = 100.0;

/// Raises the cap and keeps it in all increments, for as long as this lives, whatever is thrown meanwhile.
class RaisedCap {
 public:
  explicit RaisedCap(BeamProblem& problem) : problem_(problem) {
    problem_.keeps_cap = true;
    problem_.assembler.raise_cap(kCapRaise);
  }
  ~RaisedCap() {
    problem_.assembler.raise_cap(1.0);
    problem_.keeps_cap = false;
  }
  RaisedCap(const RaisedCap&) = delete;
  RaisedCap& operator=(const RaisedCap&) = delete;

 private:
  BeamProblem& problem_;
};

Teuchos::RCP<BeamGroup> group_at(const Teuchos::RCP<LOCA::GlobalData>& global, const Teuchos::RCP<BeamProblem>& problem,
                                 const Guess& guess) {
  return Teuchos::rcp(new BeamGroup(global, problem, guess.state, guess.load_factor, {}));
}

}  // namespace

Correction Corrector::at_load(const Guess& guess, int most_iterations) {
  const auto group = group_at(global_, problem_, guess);
  if (guess.moved != nullptr) group->setX(BeamVector(*guess.moved));
  return solve(group, most_iterations);
}

Correction Corrector::on_row(const Guess& guess, const ControlRow& row, int most_iterations) {
  const auto group = group_at(global_, problem_, guess);
  const auto parser = Teuchos::rcp(new LOCA::Parameter::SublistParser(global_));
  parser->parseSublists(lists_);
  const auto control = Teuchos::rcp(new LinearControl(row, guess.load_factor));
  const std::vector<int> free = {group->getParams().getIndex(kLoadFactor)};
  const auto constrained = Teuchos::rcp(new LOCA::MultiContinuation::ConstrainedGroup(
      global_, parser, parser->getSublist("Constraints"), group, control, free));
  if (guess.moved != nullptr) {
    const auto x = constrained->getX().clone(NOX::DeepCopy);
    auto& extended = dynamic_cast<LOCA::MultiContinuation::ExtendedVector&>(*x);
    *extended.getXVec() = BeamVector(*guess.moved);
    constrained->setX(*x);
  }
  const RaisedCap raised(*problem_);
  return solve(constrained, most_iterations);
}

Correction Corrector::solve(const Teuchos::RCP<NOX::Abstract::Group>& group, int most_iterations) {
  using NOX::StatusTest::Combo;
  const auto tests = Teuchos::rcp(new Combo(Combo::OR, guarded_status_tests(parameters_, *global_->locaUtils)));
  tests->addStatusTest(Teuchos::rcp(new NOX::StatusTest::MaxIters(most_iterations)));
  const auto list = Teuchos::rcp(new Teuchos::ParameterList(lists_->sublist("NOX")));
  problem_->last_failure.clear();
  const auto solver = NOX::Solver::buildSolver(group, tests, list);
  bool converged = false;
  try {
    converged = solver->solve() == NOX::StatusTest::Converged;
  } catch (const std::logic_error&) {  // LOCA's bordering does not go on with numbers that are none
    problem_->attempts.failed(BeamGroup::of(*group), solver->getNumIterations());
  }
  const BeamGroup& last = BeamGroup::of(solver->getSolutionGroup());
  Correction result{converged,
                    last.state(),
                    last.load_factor(),
                    BeamVector::of(last.getX()).clone(true),
                    solver->getNumIterations(),
                    last.isF() ? last.getNormF() : 0.0,
                    {}};
  if (converged) return result;
  if (!problem_->last_failure.empty())
    result.cause = problem_->last_failure;
  else if (!std::isfinite(result.residual))
    result.cause = "numbers left the range of double precision";
  else
    result.cause = "no convergence in " + std::to_string(result.iterations) + " iterations";
  return result;
}

}  // namespace mixbeam
