/// Tiny loads: residuals of compatibility allow for the rounding errors of strains, which are differences of numbers of
/// size one. Where these errors do not arise (members along an axis), the residual cannot tell the first increment of a
/// capped tangent from an equilibrium, although it misses some 1e-5 of the motion.
#pragma once

#include <NOX_StatusTest_Generic.H>

namespace mixbeam {

/// Converged when the cap of the tangent has left nothing worth mentioning out of the last step. For use in AND
/// combinations behind a test of the residual.
class CapStatusTest : public NOX::StatusTest::Generic {
 public:
  NOX::StatusTest::StatusType checkStatus(const NOX::Solver::Generic& solver, NOX::StatusTest::CheckType type) override;
  NOX::StatusTest::StatusType getStatus() const override { return status_; }
  std::ostream& print(std::ostream& stream, int indent = 0) const override;

 private:
  NOX::StatusTest::StatusType status_ = NOX::StatusTest::Unevaluated;
  int refusals_ = 0;  ///< in the present solve
};

}  // namespace mixbeam
