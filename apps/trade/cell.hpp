/// One cell of the matrix: a benchmark on one mesh, solved, judged, timed. And what the program makes of a wanted
/// accuracy, judged and timed beside the cheapest cell.
#pragma once

#include "apps/common/studies/study.hpp"
#include "apps/trade/reference.hpp"

#include <map>

namespace mixbeam {

enum class CellStatus {
  converged,
  failed,          ///< no equilibrium was found
  past_round_off,  ///< not computed: coarser meshes are as exact as rounding allows
  too_long         ///< took longer than a cell may, or would
};
inline constexpr std::array<const char*, 4> kStatusNames = {"converged", "failed", "past round-off", "too long"};

struct Cell {
  ForceIntegration integration = ForceIntegration::both_reduced;  ///< or full
  int order = 1;
  int elements = 1;  ///< of each member
};

struct RunTimes {
  double seconds = std::nan("");            ///< wall time from the scene to equilibrium, reading left out
  double setup_seconds = std::nan("");      ///< of it, until the first residual: mesh, numbering, memory
  double processor_seconds = std::nan("");  ///< of all threads together
  void stop(const RunWatch& watch) {
    seconds = watch.seconds();
    processor_seconds = watch.processor_seconds();
  }
};
using TimesByThreads = std::map<int, RunTimes>;  ///< medians

struct CellResult {
  Cell cell;
  CellStatus status = CellStatus::failed;
  Errors errors = kNoErrors;
  Errors estimated = kNoErrors;   ///< by the run itself; none in the gallery
  double estimate_seconds = 0.0;  ///< processor time for that
  int global_unknowns = 0, interior_unknowns = 0;
  int load_steps = 0, failed_steps = 0, iterations = 0;
  double flops = 0.0;  ///< of all iterations, as many as an element of a plain section takes in each
  TimesByThreads times{};
  bool converged() const { return status == CellStatus::converged; }
};

/// How a cell is timed.
struct TimingPlan {
  Communicator communicator;
  std::vector<int> threads;
  int repetitions = 0;        ///< at most, for each number of threads; at least three where they fit into the budget
  double budget = 0.0;        ///< seconds for repetitions
  double most_seconds = 0.0;  ///< of the processor: a run that takes longer is stopped at the end of its load step
};

/// Which cells, against which reference.
struct MatrixPlan {
  std::vector<int> orders, elements;  ///< ascending
  Discretization reference, confirmation;
  TimingPlan timing;
  std::vector<double> accuracies;  ///< that the program is asked for
};

/// The first run with each number of threads warms up; it counts only where it is the only one that the budget allows.
CellResult measure_cell(const BenchmarkProblem& problem, const Reference& reference, const Cell& cell,
                        const TimingPlan& plan);

/// A wanted accuracy against the single solve that reaches it cheapest.
struct AccuracyPrice {
  double seconds = 0.0;        ///< of all meshes: processor time of one thread, wall time of several
  std::optional<Cell> best{};  ///< none reaches it, or so small an error is not judged
  double best_seconds = std::nan("");
};

struct AccurateCell {
  double wanted = 0.0;  ///< relative error of displacements
  AccuracyEnd end = AccuracyEnd::reached;
  std::vector<MeshRound> rounds{};
  Errors errors = kNoErrors;
  double path_error = std::nan("");       ///< see PathTrace; not a number where nothing was met
  std::map<int, AccuracyPrice> prices{};  ///< threads -> medians of runs in turn with those of the cheapest cells
};

/// All cells of one benchmark.
struct BenchmarkResult {
  BenchmarkProblem problem;
  Discretization reference{}, confirmation{};
  Errors difference{};  ///< of these two
  std::vector<CellResult> cells{};
  std::vector<AccurateCell> accurate{};  ///< what the program makes of a wanted accuracy

  /// Smallest accuracy that is judged: errors below are those of reference and rounding. Scenes of the gallery are
  /// judged by their displacements only.
  double floor() const;
  /// With both force parts reduced and a motion as exact as this, the cheapest first, by the time that an accuracy is
  /// priced by, with so many threads or with those that the cells were timed with; none where so small an error is not
  /// judged.
  std::vector<const CellResult*> cheapest(double accuracy, int threads) const;
};

/// Scenes that ask for a path have it followed on the last mesh too. `result`: with its cells.
AccurateCell measure_accurate_cell(const BenchmarkResult& result, const Reference& reference, double wanted,
                                   const TimingPlan& plan);

/// Fills in the cells of a benchmark: all orders on all meshes.
void measure_matrix(BenchmarkResult& result, const Reference& reference, const MatrixPlan& plan);
/// Those of a scene of the gallery: only cells that may be the cheapest for one of the accuracies, from the highest
/// order down. Elements are those of the file, halved and doubled.
void measure_front(BenchmarkResult& result, const Reference& reference, const MatrixPlan& plan);

}  // namespace mixbeam
