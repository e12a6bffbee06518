/// Newton steps limited by rotation instead of residual, theory (35): far from equilibrium the residual says little,
/// but a vertex that turns by more than a fraction of a radian in one iteration leaves the range of the linearisation.
#pragma once

#include <NOX_LineSearch_Generic.H>
#include <NOX_LineSearch_UserDefinedFactory.H>

#include <Teuchos_RCP.hpp>

namespace mixbeam {

/// Accepts the full step when no vertex turns by more than `maximum_rotation`, or when the full step brings forces and
/// moments into balance better than before (pure bending and similar problems converge in three iterations only that
/// way); otherwise scales the increment so that no vertex turns further.
class RotationLimitedLineSearch : public NOX::LineSearch::Generic {
 public:
  explicit RotationLimitedLineSearch(double maximum_rotation) : maximum_rotation_(maximum_rotation) {}

  bool compute(NOX::Abstract::Group& group, double& step, const NOX::Abstract::Vector& direction,
               const NOX::Solver::Generic& solver) override;

 private:
  double maximum_rotation_;
};

/// Moves `group` from `from` along `direction` as that line search does, and returns the share of the step.
double step_within_rotation(NOX::Abstract::Group& group, const NOX::Abstract::Group& from,
                            const NOX::Abstract::Vector& direction, double largest_rotation);

class RotationLimitedFactory : public NOX::LineSearch::UserDefinedFactory {
 public:
  explicit RotationLimitedFactory(double maximum_rotation) : maximum_rotation_(maximum_rotation) {}
  Teuchos::RCP<NOX::LineSearch::Generic> buildLineSearch(const Teuchos::RCP<NOX::GlobalData>&,
                                                         Teuchos::ParameterList&) const override {
    return Teuchos::rcp(new RotationLimitedLineSearch(maximum_rotation_));
  }

 private:
  double maximum_rotation_;
};

}  // namespace mixbeam
