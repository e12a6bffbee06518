#include "nonlinear/newton/beam_group.hpp"
#include "nonlinear/newton/thresholds.hpp"

#include <LOCA_Extended_MultiAbstractGroup.H>
#include <LOCA_Extended_Vector.H>
#include <LOCA_MultiContinuation_ExtendedVector.H>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace mixbeam {

const MixedVector& BeamVector::of(const NOX::Abstract::Vector& vector) {
  if (const auto* beam = dynamic_cast<const BeamVector*>(&vector)) return beam->values();
  if (const auto* extended = dynamic_cast<const LOCA::MultiContinuation::ExtendedVector*>(&vector))
    return of(*extended->getXVec());
  throw std::logic_error("a vector that holds no beam vector reached the beam group");
}

NOX::Abstract::Vector& BeamVector::init(double gamma) {
  values().fill(gamma);
  return *this;
}

NOX::Abstract::Vector& BeamVector::random(bool, int) {
  throw std::logic_error("random beam vectors are not used by any solver of this project");
}

NOX::Abstract::Vector& BeamVector::abs(const NOX::Abstract::Vector& y) {
  values().absolute_values_of(of(y));
  return *this;
}

NOX::Abstract::Vector& BeamVector::operator=(const NOX::Abstract::Vector& y) {
  if (const auto* beam = dynamic_cast<const BeamVector*>(&y)) return *this = *beam;  // with its sign and norm
  return *this = BeamVector(of(y));
}

NOX::Abstract::Vector& BeamVector::reciprocal(const NOX::Abstract::Vector& y) {
  values().reciprocals_of(of(y));
  return *this;
}

NOX::Abstract::Vector& BeamVector::scale(double gamma) {
  if (gamma == -1.0)
    is_negated_ = !is_negated_;
  else
    values().scale(gamma);
  return *this;
}

NOX::Abstract::Vector& BeamVector::scale(const NOX::Abstract::Vector& a) {
  values().multiply_by(of(a));
  return *this;
}

NOX::Abstract::Vector& BeamVector::update(double alpha, const NOX::Abstract::Vector& a, double gamma) {
  if (alpha == -1.0 && gamma == 0.0) return (*this = a).scale(alpha);
  values().update(alpha, of(a), gamma);
  return *this;
}

NOX::Abstract::Vector& BeamVector::update(double alpha, const NOX::Abstract::Vector& a, double beta,
                                          const NOX::Abstract::Vector& b, double gamma) {
  values().update(alpha, of(a), beta, of(b), gamma);
  return *this;
}

Teuchos::RCP<NOX::Abstract::Vector> BeamVector::clone(NOX::CopyType type) const {
  return Teuchos::rcp(new BeamVector(*this, type));
}

double BeamVector::norm(NormType type) const {
  if (type == MaxNorm) {
    if (!maximum_norm_) maximum_norm_ = values_.maximum_norm();
    return *maximum_norm_;
  }
  return type == OneNorm ? values_.one_norm() : std::sqrt(values_.inner_product(values_));
}

double BeamVector::norm(const NOX::Abstract::Vector& weights) const {
  MixedVector weighted = values_.clone(true);
  weighted.multiply_by(of(weights));
  return std::sqrt(weighted.inner_product(values_));
}

double BeamVector::innerProduct(const NOX::Abstract::Vector& y) const { return values().inner_product(of(y)); }

BeamGroup::BeamGroup(const Teuchos::RCP<LOCA::GlobalData>& global, const Teuchos::RCP<BeamProblem>& problem,
                     const State& initial, double load_factor, StepObserver observer, const TangentChoice& choice)
    : LOCA::Abstract::Group(global),
      global_(global),
      problem_(problem),
      state_(initial),
      x_(Teuchos::rcp(new BeamVector(problem->model.create_vector()))),
      f_(Teuchos::rcp(new BeamVector(problem->model.create_vector()))),
      newton_(Teuchos::rcp(new BeamVector(problem->model.create_vector()))),
      observer_(std::move(observer)),
      choice_(choice) {
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
      point_(other.point_),
      observer_(other.observer_),
      choice_(other.choice_),
      norm_before_(other.norm_before_) {
  if (type == NOX::DeepCopy) {
    valid_f_ = other.valid_f_;
    valid_newton_ = other.valid_newton_;
    newton_cap_ = other.newton_cap_;
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
  choice_ = other.choice_;
  norm_before_ = other.norm_before_;
  state_ = other.state_;
  *x_ = *other.x_;
  reset();
  if (other.valid_f_) {
    *f_ = *other.f_;
    point_ = other.point_;
    valid_f_ = true;
  }
  if (other.valid_newton_) {
    *newton_ = *other.newton_;
    newton_cap_ = other.newton_cap_;
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
  state_ = problem_->model.apply(state_, difference, 1.0);
  *x_ = y;
  reset();
}

void BeamGroup::computeX(const NOX::Abstract::Group& from, const NOX::Abstract::Vector& direction, double step) {
  const BeamGroup& source = of(from);
  const MixedVector& d = BeamVector::of(direction);
  reset();
  norm_before_ = source.valid_f_ ? source.getNormF() : 0.0;
  state_ = moved(*problem_, source.state_, d, step);
  x_->values().update(1.0, source.x_->values(), step, d, 0.0);
}

NOX::Abstract::Group::ReturnType BeamGroup::computeF() {
  if (valid_f_) return Ok;
  point_ = take_residual(*problem_, state_, load_factor(), f_->values());
  valid_f_ = true;
  return Ok;
}

Linearization& BeamGroup::linearization(const MixedVector* first) {
  if (isJacobian()) return *linearization_;
  computeF();
  ++problem_->work.tangents;
  linearize_here(choice_.in_space, first);
  problem_->last_failure = linearization_->failure();
  return *linearization_;
}

/// Newton's method converges quadratically: the residual falls by the square of its last reduction.
double BeamGroup::enough_for_increment() const {
  if (choice_.enough == 0.0 || norm_before_ == 0.0) return choice_.enough;
  const double norm = getNormF(), tolerance = problem_->model.options().residual_tolerance;
  const double square = norm / norm_before_ * norm / norm_before_;
  const bool is_last = square * norm <= newton_limit.nearly_there * tolerance;
  return std::min(choice_.enough, is_last ? newton_limit.less_than_curvature * tolerance / norm
                                          : newton_limit.less_than_curvature * square);
}

NOX::Abstract::Group::ReturnType BeamGroup::computeJacobian() {
  linearization();
  return Ok;
}

/// `in_space`: for borders that leave the plane; all later solves then use this same tangent.
void BeamGroup::linearize_here(bool in_space, const MixedVector* first) const {
  TangentChoice choice = choice_;
  choice.in_space = in_space;
  linearization_.reset();  // so that its arrays are reused
  linearization_ = linearize(*problem_, point_, choice, first);
}

Tangent BeamGroup::tangent() const { return Tangent(problem_->model, point_, cap(), {choice_.in_space, false}); }

NOX::Abstract::Group::ReturnType BeamGroup::computeNewton(Teuchos::ParameterList&) {
  if (!valid_newton_) linearization();
  find_newton();
  return Ok;
}

void BeamGroup::find_newton() const {
  if (valid_newton_) return;
  newton_cap_ = find_increment(*problem_, *linearization_, rows(), choice_, enough_for_increment(), newton_->values());
  valid_newton_ = true;
}

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
  if (rhs.same_values(rows())) {  // LOCA asks for this in every Newton iteration
    find_newton();
    result.update(-1.0, *newton_, 0.0);
    return Ok;
  }
  BeamVector increment(problem_->model.create_vector());
  try {
    if (linearization_->tangent().is_planar() && !problem_->model.is_in_plane(rhs)) linearize_here(true, &rhs);
    linearization_->solve(rhs, increment.values(), choice_.enough);
    if (!choice_.keeps_cap && feels_cap(*linearization_, increment.values(), choice_.enough)) {
      const double cap_ratio = linearization_->tangent().cap().least_ratio;
      remove_cap_compliance(*linearization_, cap_ratio > 0.0 ? cap_ratio : newton_limit.rigid_ratio, increment.values(),
                            choice_.enough);
    }
  } catch (const LinearSolverError& error) {
    problem_->last_failure = error.what();
    increment.init(std::numeric_limits<double>::quiet_NaN());
  }
  increment.scale(-1.0);
  result = increment;
  return Ok;
}

const NOX::Abstract::Vector& BeamGroup::getGradient() const {
  throw std::logic_error("the beam group has no gradient: the mixed tangent is never formed");
}

double BeamGroup::equilibrium_norm() const { return mixbeam::equilibrium_norm(problem_->model, rows()); }

double BeamGroup::left_out_since(const BeamGroup& before) const {
  if (point_.scales.amplitude == 0.0 || before.newton_cap_.stiffness == 0.0) return 0.0;
  MixedVector step = x_->values().clone(true);
  step.update(-1.0, before.x_->values(), 1.0);
  ResidualScales as_moved = point_.scales;
  as_moved.strain = as_moved.rotation = as_moved.amplitude;
  as_moved.displacement_noise = 0.0;
  return largest_cap_compliance_row(problem_->model, before.newton_cap_, as_moved, step);
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
  BeamVector derivative(problem_->model.create_vector());
  load_derivative(problem_->model, state_, load_factor(), point_.scales, derivative.values());
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
