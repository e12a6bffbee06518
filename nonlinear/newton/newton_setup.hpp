/// Set-up of Newton's method in NOX, the same for every kind of path: parameter list, status tests, record of the work.
#pragma once

#include "discretization/state/resume_point.hpp"
#include "nonlinear/newton/beam_problem.hpp"

#include <NOX_Abstract_Group.H>
#include <NOX_StatusTest_Generic.H>
#include <NOX_Utils.H>
#include <Teuchos_ParameterList.hpp>

#include <vector>

namespace mixbeam {

/// Record of Newton's method since the last converged step.
struct SolveRecord {
  std::vector<NewtonIteration> history;
  int attempt = 0;     ///< number of the present attempt, from 1
  int iterations = 0;  ///< of the present attempt

  void clear() { *this = SolveRecord{}; }
};

/// Purpose of a Newton solve: a step of the path, or an evaluation inside one.
enum class NewtonPurpose { step, check };

/// The user's list, or the default, with names replaced by our own objects where NOX needs objects. Newton's method
/// writes to `record`, which must outlive the list.
Teuchos::ParameterList nox_list(const Teuchos::RCP<BeamProblem>& problem, const SolverParameters& parameters,
                                SolveRecord& record, NewtonPurpose purpose = NewtonPurpose::step);

/// Whether NOX with its default tests would take no iteration; recorded as if it had been set up, which would take
/// longer than an iteration on a small structure.
bool is_solved(const SolverParameters& parameters, SolveRecord& record, NewtonPurpose purpose, BeamGroup& group);

/// The user's tests, or the default ones, and two that always end an iteration that diverges or whose residual is NaN.
/// Passes on the exceptions of NOX for lists that it refuses.
Teuchos::RCP<NOX::StatusTest::Generic> guarded_status_tests(const SolverParameters& parameters,
                                                            const NOX::Utils& utils);

}  // namespace mixbeam
