/// One cell of the matrix: a benchmark on one mesh, solved, judged, timed. And what the program makes of a wanted
/// accuracy, judged and timed beside the cheapest cell.
#pragma once

#include "apps/common/studies/study.hpp"
#include "apps/trade/benchmark.hpp"

#include <map>

namespace mixbeam {

enum class CellStatus {
  converged,
  failed,          ///< no equilibrium was found
  past_round_off,  ///< not computed: coarser meshes are as exact as rounding allows
  too_long         ///< took longer than a cell may, or would
};
inline constexpr std::array<const char*, 4> kStatusNames = {"converged", "failed", "past round-off", "too long"};

/// What a run takes, in seconds.
enum TimeOf {
  kWall,       ///< from the scene to equilibrium, reading left out
  kSetup,      ///< of it, until the first residual: mesh, numbering, memory
  kProcessor,  ///< of all threads together
  kTimes
};
inline constexpr const char* kTimeNames[kTimes] = {"seconds_", "setup_seconds_", "processor_seconds_"};
using RunTimes = std::array<double, kTimes>;

struct CellResult {
  Discretization mesh;
  CellStatus status = CellStatus::failed;
  Errors errors = kNoErrors;
  Errors estimated = kNoErrors;   ///< by the run itself; none in the gallery
  double estimate_seconds = 0.0;  ///< processor time for that
  int global_unknowns = 0, interior_unknowns = 0;
  int load_steps = 0, failed_steps = 0, iterations = 0;
  double flops = 0.0;               ///< of all iterations, as many as an element of a plain section takes in each
  std::map<int, RunTimes> times{};  ///< threads -> medians
  bool converged() const { return status == CellStatus::converged; }
};

/// Which cells, against which reference, and how they are timed.
struct TradePlan {
  std::vector<std::string> benchmarks{}, gallery{};  ///< names
  std::vector<int> orders = {1, 2, 3, 4, 5, 6, 7, 8}, elements = {1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 1024};
  std::array<int, 2> reference = {8, 64}, confirmation = {6, 96};  ///< order, elements
  std::vector<double> accuracies = {1e-3, 1e-6, 1e-9};             ///< that the program is asked for
  std::vector<int> threads = {1, 2};
  int repetitions = 7;        ///< at most, for each number of threads; at least three where they fit into the budget
  double budget = 0.06;       ///< seconds for repetitions
  double most_seconds = 0.5;  ///< of the processor: a run that takes longer is stopped at the end of its load step
  Communicator communicator{};
};

/// A wanted accuracy against the single solve that reaches it cheapest.
struct AccuracyPrice {
  double seconds = 0.0;                  ///< of all meshes: processor time of one thread, wall time of several
  std::optional<Discretization> best{};  ///< none reaches it, or so small an error is not judged
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

  /// Smallest accuracy that is judged: errors below are those of reference and rounding.
  double floor() const;
  /// With both force parts reduced and a motion as exact as this, the cheapest first, by the time that an accuracy is
  /// priced by, with so many threads or with those that the cells were timed with; none where so small an error is not
  /// judged.
  std::vector<const CellResult*> cheapest(double accuracy, int threads) const;
};

/// Scenes that ask for a path have it followed on the last mesh too. `result`: with its cells.
AccurateCell measure_accurate_cell(const BenchmarkResult& result, const Reference& reference, double wanted,
                                   const TradePlan& plan);

/// Fills in the cells of a benchmark, all orders on all meshes; or those of a scene of the gallery: only cells that may
/// be the cheapest for one of the accuracies, from the highest order down, with the elements of the file halved and
/// doubled.
void measure_cells(BenchmarkResult& result, const Reference& reference, const TradePlan& plan);

}  // namespace mixbeam
