#include "nonlinear/path/corrector.hpp"

#include "nonlinear/newton/beam_group.hpp"
#include "nonlinear/newton/thresholds.hpp"

#include <LOCA_MultiContinuation_ConstrainedGroup.H>
#include <LOCA_MultiContinuation_ConstraintInterfaceMVDX.H>
#include <LOCA_Parameter_SublistParser.H>
#include <NOX_Abstract_MultiVector.H>
#include <NOX_Solver_Factory.H>
#include <NOX_StatusTest_Combo.H>
#include <NOX_StatusTest_MaxIters.H>

#include <cmath>
#include <stdexcept>

namespace mixbeam {

namespace {

/// Adapter that presents the row to LOCA's constrained group.
class LinearControl : public LOCA::MultiContinuation::ConstraintInterfaceMVDX {
 public:
  using Constraint = LOCA::MultiContinuation::ConstraintInterface;
  using Matrix = NOX::Abstract::MultiVector::DenseMatrix;
  using Status = NOX::Abstract::Group::ReturnType;

  LinearControl(const ControlRow& row, double load_factor)
      : row_(Teuchos::rcp(new ControlRow(row))),
        weights_(BeamVector(row.weights).createMultiVector(1, NOX::DeepCopy)),
        x_(Teuchos::rcp(new BeamVector(row.weights.clone(false)))),
        load_factor_(load_factor) {
    x_->init(0.0);
  }
  LinearControl(const LinearControl& other, NOX::CopyType type)
      : row_(other.row_),
        weights_(other.weights_),
        x_(other.x_->clone(type)),
        load_factor_(other.load_factor_),
        value_(other.value_),
        valid_(other.valid_ && type == NOX::DeepCopy) {}

  void copy(const Constraint& source) override {
    const auto& other = dynamic_cast<const LinearControl&>(source);
    if (this == &other) return;
    row_ = other.row_;
    weights_ = other.weights_;
    *x_ = *other.x_;
    load_factor_ = other.load_factor_;
    value_.assign(other.value_);
    valid_ = other.valid_;
  }
  Teuchos::RCP<Constraint> clone(NOX::CopyType type) const override {
    return Teuchos::rcp(new LinearControl(*this, type));
  }
  int numConstraints() const override { return 1; }
  void setX(const NOX::Abstract::Vector& x) override {
    *x_ = x;
    valid_ = false;
  }
  void setParam(int, double value) override {
    load_factor_ = value;
    valid_ = false;
  }
  void setParams(const std::vector<int>&, const Matrix& values) override { setParam(0, values(0, 0)); }
  Status computeConstraints() override {
    if (!valid_)
      value_(0, 0) =
          (*weights_)[0].innerProduct(*x_) + row_->load_weight * (load_factor_ - row_->load_start) - row_->target;
    valid_ = true;
    return NOX::Abstract::Group::Ok;
  }
  Status computeDX() override { return NOX::Abstract::Group::Ok; }
  Status computeDP(const std::vector<int>&, Matrix& derivatives, bool is_valid_constraint) override {
    if (!is_valid_constraint) {
      computeConstraints();
      derivatives(0, 0) = value_(0, 0);
    }
    derivatives(0, 1) = row_->load_weight;
    return NOX::Abstract::Group::Ok;
  }
  bool isConstraints() const override { return valid_; }
  bool isDX() const override { return true; }
  const Matrix& getConstraints() const override { return value_; }
  bool isDXZero() const override { return false; }
  const NOX::Abstract::MultiVector* getDX() const override { return weights_.get(); }

 private:
  Teuchos::RCP<const ControlRow> row_;
  Teuchos::RCP<NOX::Abstract::MultiVector> weights_;  ///< those of the row
  Teuchos::RCP<NOX::Abstract::Vector> x_;
  double load_factor_ = 0.0;
  Matrix value_{1, 1};
  bool valid_ = false;
};

/// Requires one iteration after a prediction by a capped tangent, whose cap has left out an unknown part.
class AfterOneIteration : public NOX::StatusTest::Generic {
 public:
  explicit AfterOneIteration(const Teuchos::RCP<NOX::StatusTest::Generic>& later) : later_(later) {}
  NOX::StatusTest::StatusType checkStatus(const NOX::Solver::Generic& solver,
                                          NOX::StatusTest::CheckType type) override {
    status_ = later_->checkStatus(solver, type);
    if (solver.getNumIterations() == 0 && status_ == NOX::StatusTest::Converged) status_ = NOX::StatusTest::Unconverged;
    return status_;
  }
  NOX::StatusTest::StatusType getStatus() const override { return status_; }
  std::ostream& print(std::ostream& stream, int indent = 0) const override { return later_->print(stream, indent); }

 private:
  Teuchos::RCP<NOX::StatusTest::Generic> later_;
  NOX::StatusTest::StatusType status_ = NOX::StatusTest::Unevaluated;
};

}  // namespace

Correction Corrector::at_load(const State& from, double load_factor, int most_iterations, const MixedVector* way,
                              bool from_stable) {
  TangentChoice choice;
  choice.may_iterate = from_stable;
  choice.enough = newton_limit.enough_for_increments;  // the next iteration removes the rest
  const auto start = Teuchos::rcp(new BeamGroup(problem_, from, load_factor, choice));
  if (way == nullptr && is_solved(parameters_, record_, purpose_, *start))
    return {true, from, load_factor, BeamVector::of(start->getX()).clone(true), 0, start->getNormF(), {}};
  if (way == nullptr) return solve(start, most_iterations);
  start->computeF();
  const auto group = Teuchos::rcp(new BeamGroup(*start, NOX::DeepCopy));
  step_within_rotation(*group, *start, BeamVector(*way), parameters_.newton.maximum_rotation);
  // If the rate at the start does not represent the whole step (loads by formula), start without the prediction.
  const bool helps = group->getNormF() < start->getNormF() || group->equilibrium_norm() < start->equilibrium_norm();
  return helps ? solve(group, most_iterations, true) : solve(start, most_iterations);
}

Correction Corrector::on_row(const Guess& guess, const ControlRow& row, int most_iterations) {
  const Model& model = problem_->model;
  const bool in_plane = guess.state.in_plane && model.is_in_plane(row.weights) &&
                        (guess.moved == nullptr || model.is_in_plane(*guess.moved));
  const auto group = Teuchos::rcp(new BeamGroup(problem_, guess.state, guess.load_factor, near_critical(!in_plane)));
  const Teuchos::RCP<LOCA::GlobalData>& global = problem_->loca->global;
  const auto lists = Teuchos::rcp(new Teuchos::ParameterList("mixbeam"));
  lists->sublist("LOCA").sublist("Constraints").set("Bordered Solver Method", "Bordering");
  const auto parser = Teuchos::rcp(new LOCA::Parameter::SublistParser(global));
  parser->parseSublists(lists);
  const auto control = Teuchos::rcp(new LinearControl(row, guess.load_factor));
  const std::vector<int> free = {group->getParams().getIndex(kLoadFactor)};
  const auto constrained = Teuchos::rcp(new LOCA::MultiContinuation::ConstrainedGroup(
      global, parser, parser->getSublist("Constraints"), group, control, free));
  if (guess.moved != nullptr) {
    const auto x = constrained->getX().clone(NOX::DeepCopy);
    auto& extended = dynamic_cast<LOCA::MultiContinuation::ExtendedVector&>(*x);
    *extended.getXVec() = BeamVector(*guess.moved);
    constrained->setX(*x);
  }
  return solve(constrained, most_iterations);
}

Correction Corrector::solve(const Teuchos::RCP<NOX::Abstract::Group>& group, int most_iterations,
                            bool from_prediction) {
  using NOX::StatusTest::Combo;
  Teuchos::RCP<NOX::StatusTest::Generic> given = guarded_status_tests(parameters_, *problem_->loca->global->locaUtils);
  if (from_prediction) given = Teuchos::rcp(new AfterOneIteration(given));
  const auto tests = Teuchos::rcp(new Combo(Combo::OR, given));
  tests->addStatusTest(Teuchos::rcp(new NOX::StatusTest::MaxIters(most_iterations)));
  const auto list = Teuchos::rcp(new Teuchos::ParameterList(nox_list(problem_, parameters_, record_, purpose_)));
  problem_->last_failure.clear();
  const auto solver = NOX::Solver::buildSolver(group, tests, list);
  bool converged = false;
  try {
    converged = solver->solve() == NOX::StatusTest::Converged;
  } catch (const std::logic_error&) {  // LOCA throws when a bordered solve meets NaN
    if (purpose_ == NewtonPurpose::step) problem_->attempts.failed(BeamGroup::of(*group), solver->getNumIterations());
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
    result.cause = "the residual is not finite";
  else
    result.cause = "no convergence in " + std::to_string(result.iterations) + " iterations";
  return result;
}

}  // namespace mixbeam
