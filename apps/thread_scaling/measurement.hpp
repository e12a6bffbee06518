/// Measured times of one case of the study and the numbers that follow from them, and the machine that they are judged
/// by.
#pragma once

#include "apps/common/studies/phase_costs.hpp"
#include "discretization/mesh/tpetra_types.hpp"
#include "discretization/scene/scene.hpp"
#include "nonlinear/parameters/solver_parameters.hpp"

#include <map>
#include <string>
#include <vector>

namespace mixbeam {

/// A case that is measured together.
struct ScalingCase {
  std::string kind;  ///< "spatial", "planar", or a kind of lattice
  int elements = 0, order = 0;
};

/// Phases that are not single timers of the model, besides those of phase_costs.hpp.
inline constexpr const char* kLinearSolverSparse =
    "linear solver, KLU2";                                      ///< the same tangent by the sparse solver alone
inline constexpr const char* kOther = "other";                  ///< of an iteration, outside of all timers
inline constexpr const char* kWholeRun = "run, per iteration";  ///< to equilibrium, with NOX and LOCA

using PhaseSeconds = std::map<std::string, double>;

/// With one number of threads, and the unit of time measured right after it.
struct Sample {
  double unit_factorize = 0.0, unit_solve = 0.0;
  double unit_processor_seconds = 0.0;  ///< that the processor spent on the unit: less than its time if others ran
  PhaseSeconds phases;
  double unit() const { return unit_factorize + unit_solve; }
};

/// One sample for each number of threads, taken one after the other: a shared machine drifts, ratios inside of a round
/// do not.
using Round = std::map<int, Sample>;

struct Measurement {
  std::vector<Round> rounds;
  /// Bytes that problem, state and iteration (not the unit of time) keep or kept resident; not a number where several
  /// cases shared a process.
  double memory = 0.0;

  /// In the order of an iteration; sums behind their parts, whatever else there is at the end.
  std::vector<std::string> phases() const;
  // Medians over the rounds that have the phase; not a number where none has.
  double seconds(int threads, const std::string& phase) const;
  double ratio_to_unit(int threads, const std::string& phase) const;
  double speed_up(int reference_threads, int threads, const std::string& phase) const;
  double unit() const;
  double unit_factorize() const;
  /// Processor time over wall time of the unit: 1 on an idle machine; far below, times are those of a busy machine.
  double share_of_processor() const;
};

/// Packs a measurement as bytes, between processes.
std::string written(const Measurement& measurement);
Measurement read_measurement(const std::string& bytes);

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

/// Ceilings of the machine, measured in the same program that is judged by them.
struct MachineCeilings {
  double flops_per_second = 0.0;  ///< multiply-adds on full vector registers, two operations each
  double bytes_per_second = 0.0;  ///< a_i = b_i + s c_i from and to memory (McCalpin's triad: 24 bytes for each i)
};

/// The best of several attempts with that many threads; takes about two seconds.
MachineCeilings measure_ceilings(int threads);

}  // namespace mixbeam
