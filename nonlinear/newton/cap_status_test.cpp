#include "nonlinear/newton/cap_status_test.hpp"

#include "nonlinear/newton/beam_group.hpp"

#include <NOX_Solver_Generic.H>

#include <ostream>
#include <string>

namespace mixbeam {

namespace {

/// Of the motion. Each iteration divides what is left by the cap, 1e5 as a rule: a bound near rounding would ask for
/// one iteration more than is of use.
constexpr double kNegligibleMotion = 1e-9;

/// Beyond, rounding errors of the strains move the forces to and fro, and more iterations do not help.
constexpr int kMostRefusals = 2;

}  // namespace

NOX::StatusTest::StatusType CapStatusTest::checkStatus(const NOX::Solver::Generic& solver,
                                                       NOX::StatusTest::CheckType type) {
  using namespace NOX::StatusTest;
  if (solver.getNumIterations() == 0) refusals_ = 0;
  status_ = Converged;
  if (type == None) {
    status_ = Unevaluated;
  } else if (solver.getNumIterations() > 0 && refusals_ < kMostRefusals) {
    const BeamGroup& before = BeamGroup::of(solver.getPreviousSolutionGroup());
    if (BeamGroup::of(solver.getSolutionGroup()).left_out_since(before) > kNegligibleMotion) status_ = Unconverged;
    refusals_ += status_ == Unconverged ? 1 : 0;
  }
  return status_;
}

std::ostream& CapStatusTest::print(std::ostream& stream, int indent) const {
  return stream << std::string(static_cast<std::size_t>(indent), ' ') << status_ << "the cap of the tangent\n";
}

}  // namespace mixbeam
