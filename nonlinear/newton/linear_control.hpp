/// The equation, theory (55), that takes the place of a given load factor where a path is followed by its length, by
/// the motion of a point or by the amplitude of a mode.
#pragma once

#include "nonlinear/newton/beam_vector.hpp"

#include <LOCA_MultiContinuation_ConstraintInterfaceMVDX.H>

namespace mixbeam {

/// <weights, x> + load_weight (load factor - load_start) = target, x the increments since the start of the step. Linear
/// in what Newton's method adds, hence satisfied after the first full step.
struct ControlRow {
  MixedVector weights;
  double load_weight = 0.0, load_start = 0.0, target = 0.0;
};

/// The row as LOCA's constrained group wants it.
class LinearControl : public LOCA::MultiContinuation::ConstraintInterfaceMVDX {
 public:
  using Matrix = NOX::Abstract::MultiVector::DenseMatrix;
  using Status = NOX::Abstract::Group::ReturnType;

  LinearControl(const ControlRow& row, double load_factor);
  LinearControl(const LinearControl& other, NOX::CopyType type);

  void copy(const LOCA::MultiContinuation::ConstraintInterface& source) override;
  Teuchos::RCP<LOCA::MultiContinuation::ConstraintInterface> clone(NOX::CopyType type) const override;
  int numConstraints() const override { return 1; }
  void setX(const NOX::Abstract::Vector& x) override;
  void setParam(int id, double value) override;
  void setParams(const std::vector<int>& ids, const Matrix& values) override;
  Status computeConstraints() override;
  Status computeDX() override { return NOX::Abstract::Group::Ok; }
  Status computeDP(const std::vector<int>& ids, Matrix& derivatives, bool is_valid_constraint) override;
  bool isConstraints() const override { return valid_; }
  bool isDX() const override { return true; }
  const Matrix& getConstraints() const override { return value_; }
  bool isDXZero() const override { return false; }
  const NOX::Abstract::MultiVector* getDX() const override { return weights_.get(); }

 private:
  Teuchos::RCP<NOX::Abstract::MultiVector> weights_;
  double load_weight_ = 0.0, load_start_ = 0.0, target_ = 0.0;
  Teuchos::RCP<NOX::Abstract::Vector> x_;
  double load_factor_ = 0.0;
  Matrix value_{1, 1};
  bool valid_ = false;
};

}  // namespace mixbeam
