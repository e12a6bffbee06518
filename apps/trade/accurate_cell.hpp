/// A benchmark solved to a wanted accuracy, on meshes that the program chooses: judged like a cell, and timed beside
/// the cheapest one.
#pragma once

#include "apps/trade/cell.hpp"
#include "nonlinear/run/accurate_run.hpp"

#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace mixbeam {

struct BenchmarkResult;

/// A wanted accuracy against the single solve that reaches it cheapest.
struct AccuracyPrice {
  double seconds = 0.0;      ///< of all meshes: processor time of one thread, wall time of several
  std::optional<Cell> best;  ///< none reaches it, or so small an error is not judged
  double best_seconds = std::numeric_limits<double>::quiet_NaN();
  double ratio() const { return seconds / best_seconds; }
};

struct AccurateCell {
  double wanted = 0.0;  ///< relative error of displacements
  AccuracyEnd end = AccuracyEnd::reached;
  std::vector<MeshRound> rounds;
  double estimated = 0.0;
  Errors errors = kNoErrors;
  std::optional<double> path_error{};   ///< see PathTrace; none: nothing was met
  std::map<int, AccuracyPrice> prices;  ///< threads -> medians of runs in turn with those of the cheapest cell
};

/// "5 x 4, 7 x 6": order and elements of the members, those of the finest member where they differ; mesh after mesh.
std::string meshes_text(const AccurateCell& cell);

/// Scenes that ask for a path have it followed on the last mesh too. `result`: with its cells.
AccurateCell measure_accurate_cell(const BenchmarkResult& result, const Reference& reference, double wanted,
                                   const TimingPlan& plan, const Communicator& communicator);

}  // namespace mixbeam
