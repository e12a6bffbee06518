/// Which mesh and order to take: the cheapest cells, and what holds over all benchmarks.
#pragma once

#include "apps/trade/accurate_cell.hpp"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace mixbeam {

/// All cells of one benchmark.
struct BenchmarkResult {
  BenchmarkProblem problem;
  Errors difference;  ///< of the two references
  std::vector<CellResult> cells;
  std::vector<AccurateCell> accurate{};  ///< what the program makes of a wanted accuracy
  /// Smallest accuracy that is judged: errors below are those of reference and rounding. Scenes of the gallery are
  /// judged by their displacements only.
  double floor() const;
};

/// What is asked of a cell: the largest of all errors, or that of one quantity.
using ErrorMeasure = std::function<double(const Errors&)>;
double largest_error(const Errors& errors);
double displacement_error(const Errors& errors);
double motion_error(const Errors& errors);  ///< of tip and centerline

/// What is paid for it: time on structures as small as these, operations on large ones.
using CostMeasure = std::function<double(const CellResult&)>;
/// Of the processor: with one thread it is the wall time on an idle machine, and what others do does not lengthen it.
CostMeasure processor_time(int threads);
double operations(const CellResult& cell);

struct Criterion {
  ErrorMeasure error;
  CostMeasure cost;
};

/// Cells with both force parts reduced that no other one beats in error and in cost, ascending in cost.
std::vector<const CellResult*> pareto_front(const BenchmarkResult& result, const Criterion& by);

/// Least cost among the cells with both parts reduced whose error is at most `accuracy`; of this
/// order, unless it is zero. Null where there is none or so small an error is not judged.
const CellResult* cheapest(const BenchmarkResult& result, const Criterion& by, double accuracy, int order = 0);

/// What it costs to take one order everywhere for an accuracy.
struct OrderPrice {
  int order = 0;
  int reached = 0;        ///< benchmarks on which a mesh of this order is accurate enough ...
  int judged = 0;         ///< ... of those on which any mesh is
  double mean = 0.0;      ///< its cost over that of the cheapest order, geometric mean over those reached
  double worst = 0.0;     ///< the largest of these ratios
  double elements = 0.0;  ///< of each member: geometric mean over those reached
};

/// For each of the orders that were computed.
std::vector<OrderPrice> order_prices(const std::vector<BenchmarkResult>& results, const Criterion& by, double accuracy);
/// The order that reaches the accuracy on most benchmarks, and of these the one with the least mean; none where no cell
/// does.
std::optional<OrderPrice> best_order(const std::vector<OrderPrice>& prices);

/// Cost of `accuracy` over that for `coarse`, both cheapest: geometric mean over the benchmarks on which both are
/// judged.
double cost_ratio(const std::vector<BenchmarkResult>& results, const Criterion& by, double accuracy, double coarse);

/// 1e-2, 1e-3, .. 1e-12
std::vector<double> accuracies();

}  // namespace mixbeam
