/// All rounds of one case.
#pragma once

#include "apps/thread_scaling/measurement.hpp"
#include "discretization/mesh/tpetra_types.hpp"
#include "discretization/scene/scene.hpp"
#include "nonlinear/parameters/solver_parameters.hpp"

namespace mixbeam {

struct MeasuringPlan {
  std::vector<int> threads;
  int repetitions = 0, run_repetitions = 0;  ///< at most
  double seconds = 0.0;                      ///< after which no further round is begun, of iterations and of runs each
  bool compare_sparse_solver = true;
};

/// Iterations, then whole runs, each with all numbers of threads in turn and with the unit of time beside it. The first
/// round of iterations warms up and is not counted; at least kLeastRounds are, and one of runs if any.
Measurement measure_case(const Scene& scene, const SolverParameters& parameters, const Communicator& communicator,
                         const MeasuringPlan& plan);

}  // namespace mixbeam
