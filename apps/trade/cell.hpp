/// One cell of the matrix: a benchmark on one mesh, solved, judged, timed.
#pragma once

#include "apps/trade/reference.hpp"

#include <map>

namespace mixbeam {

enum class CellStatus {
  converged,
  failed,          ///< no equilibrium was found
  past_round_off,  ///< not computed: coarser meshes are as exact as rounding allows
  too_long         ///< took longer than a cell may, or would
};
const char* name_of(CellStatus status);
const char* name_of(ForceIntegration integration);

struct Cell {
  ForceIntegration integration = ForceIntegration::both_reduced;
  int order = 1;
  int elements = 1;  ///< of each member
};

struct CellTimes {
  double seconds = 0.0;            ///< wall time from the scene to equilibrium, reading left out
  double setup_seconds = 0.0;      ///< of it, until the first residual: mesh, numbering, memory
  double processor_seconds = 0.0;  ///< of all threads together: what a busy machine does not lengthen
};

struct CellResult {
  Cell cell;
  CellStatus status = CellStatus::failed;
  Errors errors = kNoErrors;
  Errors estimated = kNoErrors;   ///< by the run itself, see estimated_errors(); none in the gallery
  double estimate_seconds = 0.0;  ///< processor time for that
  int global_unknowns = 0, interior_unknowns = 0;
  int load_steps = 0, failed_steps = 0, iterations = 0;
  double flops = 0.0;              ///< of all iterations, see iteration_flops()
  std::map<int, CellTimes> times;  ///< threads -> medians
  bool converged() const { return status == CellStatus::converged; }
  // Not a number where it was not measured.
  double seconds(int threads) const;
  double processor_seconds(int threads) const;
};

/// How a cell is timed.
struct TimingPlan {
  std::vector<int> threads;
  int repetitions = 0;        ///< at most, for each number of threads; at least three where they fit into the budget
  double budget = 0.0;        ///< seconds for repetitions
  double most_seconds = 0.0;  ///< of the processor: a run that takes longer is stopped at the end of its load step
};

/// Floating-point operations of one Newton iteration on all elements, counted by running the kernels of a plain section
/// on counting numbers: element work, condensation of chains, solve, check.
double iteration_flops(int order, int elements);

/// One run, reading left out.
CellTimes time_once(const BenchmarkProblem& problem, const Cell& cell, int threads, const TimingPlan& plan,
                    const Communicator& communicator);

/// The first run with each number of threads warms up; it counts only where it is the only one that the budget allows.
CellResult measure_cell(const BenchmarkProblem& problem, const Reference& reference, const Cell& cell,
                        const TimingPlan& plan, const Communicator& communicator);

}  // namespace mixbeam
