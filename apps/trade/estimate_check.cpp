#include "apps/trade/estimate_check.hpp"

#include "apps/common/tables/csv_table.hpp"
#include "apps/trade/trade_tables.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <ostream>

namespace mixbeam {

namespace {

/// Errors that are judged: larger ones belong to meshes that say little, smaller ones to rounding.
constexpr double kLargestError = 1e-2, kSmallestError = 1e-10;
/// A true error is known to a tenth when it is this many times the difference of the references.
constexpr double kAboveDifference = 10.0;
constexpr double kFactor = 5.0;

struct Quantity {
  const char* name;
  double Errors::*of;
};
constexpr std::array<Quantity, 4> kQuantities{{{"displacement", &Errors::displacement},
                                               {"centerline", &Errors::centerline},
                                               {"moment", &Errors::moment},
                                               {"energy", &Errors::energy}}};

bool is_judged(const BenchmarkResult& result, const CellResult& cell, double Errors::*of) {
  const double error = cell.errors.*of;
  return cell.converged() && cell.cell.integration == ForceIntegration::both_reduced && error >= kSmallestError &&
         error <= kLargestError && error >= kAboveDifference * result.difference.*of;
}

void judge(const BenchmarkResult& result, const CellResult& cell, double Errors::*of, EstimateJudgement& judgement) {
  const double ratio = cell.estimated.*of / (cell.errors.*of);
  ++judgement.cells;
  if (std::isnan(ratio)) {
    ++judgement.without;
    return;
  }
  if (ratio >= 1.0 / kFactor && ratio <= kFactor) ++judgement.within;
  if (ratio < judgement.least) {
    judgement.least = ratio;
    judgement.least_cell = result.problem.about.name + " " + mesh_text(cell.cell);
  }
  judgement.largest = std::max(judgement.largest, ratio);
}

std::string line_of(const char* pattern, const EstimateJudgement& j) {
  std::array<char, 200> text{};
  std::snprintf(text.data(), text.size(), pattern, j.quantity.c_str(), j.cells, j.without, 100.0 * j.share(), j.least,
                j.least_cell.c_str(), j.largest);
  return text.data();
}

}  // namespace

Errors estimated_errors(const Simulation& simulation, const std::string& point) {
  const ErrorEstimate estimate = simulation.estimate_error();
  if (!estimate.exists()) return kNoErrors;
  const Vector3 error = estimate.vertex_displacement.at(vertex_of(simulation.assembler().mesh(), point));
  const Vector3 size = simulation.displacement(point);
  return {std::hypot(error[0], error[1], error[2]) / std::hypot(size[0], size[1], size[2]),
          estimate.displacement.relative(), estimate.moment.relative(), std::abs(estimate.energy.relative())};
}

std::vector<EstimateJudgement> judge_estimates(const std::vector<BenchmarkResult>& results) {
  std::vector<EstimateJudgement> judgements;
  for (const Quantity& quantity : kQuantities) {
    EstimateJudgement judgement{quantity.name};
    judgement.least = std::numeric_limits<double>::infinity();
    for (const BenchmarkResult& result : results)
      for (const CellResult& cell : result.cells)
        if (is_judged(result, cell, quantity.of)) judge(result, cell, quantity.of, judgement);
    judgements.push_back(judgement);
  }
  return judgements;
}

double estimate_cost(const std::vector<BenchmarkResult>& results) {
  std::vector<double> ratios;
  for (const BenchmarkResult& result : results)
    for (const CellResult& cell : result.cells)
      if (cell.converged() && !cell.times.empty())
        ratios.push_back(cell.estimate_seconds / cell.times.begin()->second.processor_seconds);
  if (ratios.empty()) return std::nan("");
  std::nth_element(ratios.begin(), ratios.begin() + ratios.size() / 2, ratios.end());
  return ratios[ratios.size() / 2];
}

void print_judgements(std::ostream& out, const std::vector<BenchmarkResult>& results) {
  out << "\nEstimated over true error, cells with a true error of 1e-10 to 1e-2\n"
         "  quantity       cells   none  within 5     least  (where)                          largest\n";
  for (const EstimateJudgement& j : judge_estimates(results))
    out << line_of("  %-12s %7d %6d %8.1f%% %9.2g  %-32s %7.2g\n", j);
  out << "  time for the estimate over that for the solution, median: " << estimate_cost(results) << "\n";
}

void write_judgements(std::ostream& page, const std::vector<BenchmarkResult>& results) {
  page << "\n## Estimated errors\n\nEvery run estimates its own error (one Newton correction in the next order). "
          "Estimate over true error in all cells of the default integration whose true error is 1e-10 to 1e-2 and at "
          "least ten times the difference of the references:\n\n"
          "| quantity | cells | without estimate | within a factor of 5 | least | at | largest "
          "|\n|---|---:|---:|---:|---:|---|---:|\n";
  for (const EstimateJudgement& j : judge_estimates(results))
    page << line_of("| %s | %d | %d | %.1f %% | %.2g | %s | %.2g |\n", j);
  std::array<char, 100> cost{};
  std::snprintf(cost.data(), cost.size(), "%.2f", estimate_cost(results));
  page << "\nIt takes " << cost.data()
       << " times as long as the solution (median over all cells, most of which take a millisecond).\n";
}

void write_estimates(const std::filesystem::path& file, const std::vector<BenchmarkResult>& results) {
  CsvTable csv(file, {"benchmark", "integration", "order", "elements", "quantity", "error", "estimate", "judged"});
  for (const BenchmarkResult& result : results)
    for (const CellResult& cell : result.cells)
      for (const Quantity& quantity : kQuantities)
        if (cell.converged())
          csv.add_row({result.problem.about.name, name_of(cell.cell.integration), cell.cell.order, cell.cell.elements,
                       quantity.name, cell.errors.*quantity.of, cell.estimated.*quantity.of,
                       is_judged(result, cell, quantity.of) ? 1 : 0});
}

}  // namespace mixbeam
