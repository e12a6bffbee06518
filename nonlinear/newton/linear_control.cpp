#include "nonlinear/newton/linear_control.hpp"

#include <NOX_Abstract_MultiVector.H>

namespace mixbeam {

LinearControl::LinearControl(const ControlRow& row, double load_factor)
    : weights_(BeamVector(row.weights).createMultiVector(1, NOX::DeepCopy)),
      load_weight_(row.load_weight),
      load_start_(row.load_start),
      target_(row.target),
      x_(Teuchos::rcp(new BeamVector(row.weights.clone(false)))),
      load_factor_(load_factor) {
  (*weights_)[0] = BeamVector(row.weights);
  x_->init(0.0);
}

LinearControl::LinearControl(const LinearControl& other, NOX::CopyType type)
    : weights_(other.weights_),
      load_weight_(other.load_weight_),
      load_start_(other.load_start_),
      target_(other.target_),
      x_(other.x_->clone(type)),
      load_factor_(other.load_factor_),
      value_(other.value_),
      valid_(other.valid_ && type == NOX::DeepCopy) {}

void LinearControl::copy(const LOCA::MultiContinuation::ConstraintInterface& source) {
  const auto& other = dynamic_cast<const LinearControl&>(source);
  if (this == &other) return;
  weights_ = other.weights_;
  load_weight_ = other.load_weight_;
  load_start_ = other.load_start_;
  target_ = other.target_;
  *x_ = *other.x_;
  load_factor_ = other.load_factor_;
  value_.assign(other.value_);
  valid_ = other.valid_;
}

Teuchos::RCP<LOCA::MultiContinuation::ConstraintInterface> LinearControl::clone(NOX::CopyType type) const {
  return Teuchos::rcp(new LinearControl(*this, type));
}

void LinearControl::setX(const NOX::Abstract::Vector& x) {
  *x_ = x;
  valid_ = false;
}

void LinearControl::setParam(int, double value) {
  load_factor_ = value;
  valid_ = false;
}

void LinearControl::setParams(const std::vector<int>&, const Matrix& values) { setParam(0, values(0, 0)); }

LinearControl::Status LinearControl::computeConstraints() {
  if (valid_) return NOX::Abstract::Group::Ok;
  value_(0, 0) = (*weights_)[0].innerProduct(*x_) + load_weight_ * (load_factor_ - load_start_) - target_;
  valid_ = true;
  return NOX::Abstract::Group::Ok;
}

LinearControl::Status LinearControl::computeDP(const std::vector<int>&, Matrix& derivatives, bool is_valid_constraint) {
  if (!is_valid_constraint) {
    computeConstraints();
    derivatives(0, 0) = value_(0, 0);
  }
  derivatives(0, 1) = load_weight_;
  return NOX::Abstract::Group::Ok;
}

}  // namespace mixbeam
