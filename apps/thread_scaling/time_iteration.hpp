/// One Newton iteration as the nonlinear solver makes it, timed phase by phase.
#pragma once

#include "apps/thread_scaling/measurement.hpp"
#include "nonlinear/newton/beam_problem.hpp"

#include <memory>
#include <optional>

namespace mixbeam {

class IterationTimer {
 public:
  /// With the linear solver of `parameters`.
  IterationTimer(const Scene& scene, const SolverParameters& parameters, const Communicator& communicator);

  /// Residual, tangent, solve, recovery of the interior and update at the undeformed state under the full load, with
  /// the present number of threads.
  PhaseSeconds time();
  /// The same iteration's matrix gathered, factorised, solved and checked by the sparse solver alone, which is built
  /// when it is first asked for (memory).
  double time_sparse_solver();

 private:
  BeamProblem problem_;
  State state_;
  MixedVector residual_, increment_;
  std::optional<Tangent> tangent_;  ///< of the last time()
  std::string sparse_method_;
  double tolerance_;
  std::unique_ptr<TangentSolver> sparse_solver_;
};

}  // namespace mixbeam
