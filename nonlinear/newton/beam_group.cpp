#include "nonlinear/newton/beam_group.hpp"

#include "nonlinear/newton/cap_correction.hpp"

#include <LOCA_Extended_MultiAbstractGroup.H>

#include <cmath>
#include <limits>
#include <stdexcept>

namespace mixbeam {

BeamGroup::BeamGroup(const Teuchos::RCP<LOCA::GlobalData>& global, const Teuchos::RCP<BeamProblem>& problem,
                     const State& initial, double load_factor, StepObserver observer)
    : LOCA::Abstract::Group(global),
      global_(global),
      problem_(problem),
      state_(initial),
      x_(Teuchos::rcp(new BeamVector(problem->assembler.create_vector()))),
      f_(Teuchos::rcp(new BeamVector(problem->assembler.create_vector()))),
      newton_(Teuchos::rcp(new BeamVector(problem->assembler.create_vector()))),
      observer_(std::move(observer)) {
  parameters_.addParameter(kLoadFactor, load_factor);
}

BeamGroup::BeamGroup(const BeamGroup& other, NOX::CopyType type)
    : LOCA::Abstract::Group(other, type),
      global_(other.global_),
      problem_(other.problem_),
      parameters_(other.parameters_),
      state_(other.state_),
      x_(Teuchos::rcp(new BeamVector(*other.x_, type))),
      f_(Teuchos::rcp(new BeamVector(*other.f_, type))),
      newton_(Teuchos::rcp(new BeamVector(*other.newton_, type))),
      scales_(other.scales_),
      observer_(other.observer_) {
  if (type == NOX::DeepCopy) {
    valid_f_ = other.valid_f_;
    valid_newton_ = other.valid_newton_;
    softened_ = other.softened_;
  }
}

BeamGroup& BeamGroup::operator=(const BeamGroup& source) {
  copy(source);
  return *this;
}

NOX::Abstract::Group& BeamGroup::operator=(const NOX::Abstract::Group& source) {
  copy(source);
  return *this;
}

void BeamGroup::copy(const NOX::Abstract::Group& source) {
  const BeamGroup& other = of(source);
  if (this == &other) return;
  LOCA::Abstract::Group::copy(source);
  parameters_ = other.parameters_;
  state_ = other.state_;
  *x_ = *other.x_;
  reset();
  if (other.valid_f_) {
    *f_ = *other.f_;
    scales_ = other.scales_;
    valid_f_ = true;
  }
  if (other.valid_newton_) {
    *newton_ = *other.newton_;
    softened_ = other.softened_;
    valid_newton_ = true;
  }
}

const BeamGroup& BeamGroup::of(const NOX::Abstract::Group& group) {
  if (const auto* beam = dynamic_cast<const BeamGroup*>(&group)) return *beam;
  if (const auto* extended = dynamic_cast<const LOCA::Extended::MultiAbstractGroup*>(&group))
    return of(*extended->getUnderlyingGroup());
  throw std::logic_error("a group that holds no beam group reached the beam solver");
}

Teuchos::RCP<NOX::Abstract::Group> BeamGroup::clone(NOX::CopyType type) const {
  return Teuchos::rcp(new BeamGroup(*this, type));
}

void BeamGroup::setX(const NOX::Abstract::Vector& y) {
  MixedVector difference = BeamVector::of(y).clone(true);
  difference.update(-1.0, x_->values(), 1.0);
  if (difference.maximum_norm() == 0.0) return;
  state_ = problem_->assembler.apply(state_, difference, 1.0);
  *x_ = y;
  reset();
}

void BeamGroup::computeX(const NOX::Abstract::Group& from, const NOX::Abstract::Vector& direction, double step) {
  const BeamGroup& source = of(from);
  const MixedVector& d = BeamVector::of(direction);
  reset();
  state_ = problem_->assembler.apply(source.state_, d, step);
  x_->values().update(1.0, source.x_->values(), step, d, 0.0);
}

NOX::Abstract::Group::ReturnType BeamGroup::computeF() {
  if (valid_f_) return Ok;
  problem_->assembler.residual(state_, load_factor(), f_->values());
  scales_ = problem_->assembler.scales();
  ++problem_->work.residuals;
  valid_f_ = true;
  return Ok;
}

NOX::Abstract::Group::ReturnType BeamGroup::computeJacobian() {
  if (isJacobian()) return Ok;
  computeF();
  ++problem_->work.tangents;
  problem_->last_failure.clear();
  try {
    // borders may leave the plane, and all solves are to be with the same tangent
    take_tangent(problem_->leaves_plane);
  } catch (const LinearSolverError& error) {
    problem_->last_failure = error.what();
  }
  // The condensed residual now in the assembler belongs to F: the Newton increment costs one solve, and no later
  // right-hand side can spoil it.
  return solve_newton();
}

void BeamGroup::take_tangent(bool in_space) const {
  problem_->assembler.use_scales(scales_);
  problem_->assembler.newton_tangent(state_, load_factor(), in_space);
  tangent_ = problem_->assembler.tangent_number();
  ++problem_->work.factorizations;
  problem_->linear_solver->factorize();
}

void BeamGroup::condense(const MixedVector& rhs) const {
  problem_->assembler.use_scales(scales_);
  problem_->assembler.condense(state_, load_factor(), rhs);
}

NOX::Abstract::Group::ReturnType BeamGroup::solve_newton() {
  try {
    if (!problem_->last_failure.empty()) throw LinearSolverError(problem_->last_failure);
    solve_condensed(newton_->values());
    correct_newton();
  } catch (const LinearSolverError& error) {
    // an increment without numbers fails the finite-value test of this very iteration, and the step is repeated smaller
    problem_->last_failure = error.what();
    newton_->init(std::numeric_limits<double>::quiet_NaN());
  }
  valid_newton_ = true;
  return Ok;
}

void BeamGroup::solve_condensed(MixedVector& increment) const {
  DofVector& rhs = problem_->assembler.condensed_residual();
  rhs.scale(-1.0);
  problem_->linear_solver->solve(rhs, increment.vertex_dofs());
  problem_->assembler.recover(state_, increment);
}

namespace {

/// The cap is let be where it leaves less than this fraction of what the next residual holds anyway.
constexpr double kNegligible = 0.1;

}  // namespace

void BeamGroup::correct_newton() {
  softened_ = true;
  const double cap_ratio = problem_->assembler.least_cap_ratio();
  if (cap_ratio == 0.0 || problem_->keeps_cap) return;
  Assembler& assembler = problem_->assembler;
  const double left = assembler.largest_softening_row(newton_->values());
  // Strains of the order of the squared rotation are left by the linearisation.
  const double spin = newton_->values().largest_vertex_spin();
  const double from_turning = spin * spin / scales_.rotation;
  if (!(left > kNegligible * std::max(assembler.residual_tolerance(), from_turning))) return;
  if (!(left > kNegligible * assembler.compatibility_norm(f_->values()))) return;
  MixedVector left_out = assembler.create_vector();
  assembler.softening_rows(newton_->values(), left_out);
  try {
    softened_ = !remove_softening(softening_operators(), left_out, cap_ratio, newton_->values());
  } catch (const LinearSolverError&) {
    // the increment is still that of the capped tangent, which only converges more slowly
  }
}

SofteningOperators BeamGroup::softening_operators() const {
  return {
      [this](const MixedVector& rhs, MixedVector& increment) {
        condense(rhs);
        solve_condensed(increment);
      },
      [this](const MixedVector& increment, MixedVector& rows) { problem_->assembler.softening_rows(increment, rows); }};
}

NOX::Abstract::Group::ReturnType BeamGroup::computeNewton(Teuchos::ParameterList&) {
  if (valid_newton_) return Ok;
  return computeJacobian();
}

namespace {

/// Where every stiffness that is cut off is infinite, in place of the ratio to the largest finite one: an increment
/// that equilibrium determines loses all of what the cap adds, one that closed rigid frames share stays as it is.
constexpr double kRigidRatio = 1e-2;

}  // namespace

NOX::Abstract::Group::ReturnType BeamGroup::applyJacobian(const NOX::Abstract::Vector& input,
                                                          NOX::Abstract::Vector& result) const {
  if (!valid_newton_ || !valid_f_ || !BeamVector::of(input).same_values(newton_->values())) return NotDefined;
  result.update(-1.0, *f_, 0.0);
  return Ok;
}

NOX::Abstract::Group::ReturnType BeamGroup::applyJacobianInverse(Teuchos::ParameterList&,
                                                                 const NOX::Abstract::Vector& input,
                                                                 NOX::Abstract::Vector& result) const {
  if (!isJacobian()) return BadDependency;
  const MixedVector& rhs = BeamVector::of(input);
  if (valid_newton_ && rhs.same_values(f_->values())) {  // what LOCA asks for in every Newton iteration
    result.update(-1.0, *newton_, 0.0);
    return Ok;
  }
  BeamVector increment(problem_->assembler.create_vector());
  try {
    if (!problem_->last_failure.empty()) throw LinearSolverError(problem_->last_failure);
    if (problem_->assembler.has_planar_tangent() && !problem_->assembler.is_in_plane(rhs)) take_tangent(true);
    condense(rhs);
    solve_condensed(increment.values());
    if (!problem_->keeps_cap) {
      MixedVector left_out = problem_->assembler.create_vector();
      problem_->assembler.softening_rows(increment.values(), left_out);
      const double cap_ratio = problem_->assembler.least_cap_ratio();
      remove_softening(softening_operators(), left_out, cap_ratio > 0.0 ? cap_ratio : kRigidRatio, increment.values());
    }
  } catch (const LinearSolverError& error) {
    problem_->last_failure = error.what();
    increment.init(std::numeric_limits<double>::quiet_NaN());
  }
  result.update(-1.0, increment, 0.0);
  return Ok;
}

const NOX::Abstract::Vector& BeamGroup::getGradient() const {
  throw std::logic_error("the beam group has no gradient: the mixed tangent is never formed");
}

double BeamGroup::equilibrium_norm() const { return problem_->assembler.equilibrium_norm(f_->values()); }

double BeamGroup::left_out_since(const BeamGroup& before) const {
  if (scales_.amplitude == 0.0 || !before.softened_) return 0.0;
  MixedVector step = x_->values().clone(true);
  step.update(-1.0, before.x_->values(), 1.0);
  ResidualScales as_moved = scales_;
  as_moved.strain = as_moved.rotation = scales_.amplitude;
  as_moved.displacement_noise = 0.0;
  problem_->assembler.use_scales(as_moved);
  const double largest = problem_->assembler.largest_softening_row(step);
  problem_->assembler.use_scales(scales_);
  return largest;
}

void BeamGroup::setParamsMulti(const std::vector<int>& ids, const NOX::Abstract::MultiVector::DenseMatrix& values) {
  for (size_t k = 0; k < ids.size(); ++k) setParam(ids[k], values(static_cast<int>(k), 0));
}

void BeamGroup::setParams(const LOCA::ParameterVector& parameters) {
  if (parameters.getValue(kLoadFactor) != load_factor()) reset();
  parameters_ = parameters;
}

void BeamGroup::setParam(int id, double value) {
  if (parameters_.getValue(id) != value) reset();
  parameters_.setValue(id, value);
}

void BeamGroup::setParam(std::string id, double value) {
  if (parameters_.getValue(id) != value) reset();
  parameters_.setValue(id, value);
}

NOX::Abstract::Group::ReturnType BeamGroup::computeDfDpMulti(const std::vector<int>& ids,
                                                             NOX::Abstract::MultiVector& dfdp, bool is_valid_f) {
  if (!is_valid_f) {
    computeF();
    dfdp[0] = *f_;
  }
  problem_->assembler.use_scales(scales_);
  BeamVector derivative(problem_->assembler.create_vector());
  problem_->assembler.load_derivative(state_, load_factor(), derivative.values());
  for (size_t k = 0; k < ids.size(); ++k) dfdp[static_cast<int>(k) + 1] = derivative;
  return Ok;
}

void BeamGroup::printSolution(double load_factor) const {
  if (observer_) observer_(*this, load_factor);
}

double BeamGroup::computeScaledDotProduct(const NOX::Abstract::Vector& a, const NOX::Abstract::Vector& b) const {
  return a.innerProduct(b) / static_cast<double>(a.length());
}

void BeamGroup::scaleVector(NOX::Abstract::Vector& x) const {
  x.scale(1.0 / std::sqrt(static_cast<double>(x.length())));
}

}  // namespace mixbeam
