/// Measured times of one case of the study, derived numbers, and the ceilings of the machine.
#pragma once

#include "apps/common/studies/phase_costs.hpp"
#include "discretization/mesh/tpetra_types.hpp"
#include "discretization/scene/scene.hpp"
#include "nonlinear/parameters/solver_parameters.hpp"

#include <map>
#include <string>
#include <vector>

namespace mixbeam {

/// A case of the study.
struct ScalingCase {
  std::string kind;  ///< "spatial", "planar", or a kind of lattice
  int elements = 0, order = 0;
};

/// Phases beyond the timers of the model and phase_costs.hpp.
inline constexpr const char* kLinearSolverSparse =
    "linear solver, KLU2";                                      ///< the same tangent, only by the sparse solver
inline constexpr const char* kOther = "other";                  ///< of an iteration, outside all timers
inline constexpr const char* kWholeRun = "run, per iteration";  ///< to equilibrium, with NOX and LOCA

using PhaseSeconds = std::map<std::string, double>;

/// Times with one number of threads, and the unit of time measured right afterwards.
struct Sample {
  double unit_factorize = 0.0, unit_solve = 0.0;
  double unit_processor_seconds = 0.0;  ///< processor time of the unit; less than its wall time if other processes ran
  PhaseSeconds phases;
  double unit() const { return unit_factorize + unit_solve; }
};

/// One sample for each number of threads, taken in sequence: a shared machine drifts, ratios within a round do not.
using Round = std::map<int, Sample>;

struct Measurement {
  std::vector<Round> rounds;
  /// Peak resident bytes of problem, state and iteration (not the unit of time); NaN if several cases shared a process.
  double memory = 0.0;

  /// Names in the order of an iteration; sums after their parts, unknown ones last.
  std::vector<std::string> phases() const;
  // Medians over the rounds that have the phase; NaN if none has.
  double seconds(int threads, const std::string& phase) const;
  double ratio_to_unit(int threads, const std::string& phase) const;
  double speed_up(int reference_threads, int threads, const std::string& phase) const;
  double unit() const;
  double unit_factorize() const;
  /// Processor time over wall time of the unit: 1 on an idle machine; far below, times are those of a busy machine.
  double share_of_processor() const;
};

/// Serializes a measurement for another process.
std::string written(const Measurement& measurement);
Measurement read_measurement(const std::string& bytes);

struct MeasuringPlan {
  std::vector<int> threads;
  int repetitions = 0, run_repetitions = 0;  ///< at most
  double seconds = 0.0;                      ///< after which no further round is begun, of iterations and of runs each
  bool compare_sparse_solver = true;
};

/// Measures iterations, then whole runs, in rounds over all numbers of threads, each with the unit of time. The first
/// round of iterations is a warm-up; at least kLeastRounds follow, and one of runs if any.
Measurement measure_case(const Scene& scene, const SolverParameters& parameters, const Communicator& communicator,
                         const MeasuringPlan& plan);

/// Ceilings of the machine, measured in the same program.
struct MachineCeilings {
  double flops_per_second = 0.0;  ///< multiply-adds on full vector registers, two operations each
  double bytes_per_second = 0.0;  ///< a_i = b_i + s c_i from and to memory (McCalpin's triad: 24 bytes for each i)
};

/// Measures the ceilings with `threads` threads, the best of several attempts; takes about two seconds.
MachineCeilings measure_ceilings(int threads);

}  // namespace mixbeam
