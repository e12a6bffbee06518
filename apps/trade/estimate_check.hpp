/// The estimated errors of all cells against the true ones.
#pragma once

#include "apps/trade/choice.hpp"

#include <filesystem>
#include <iosfwd>

namespace mixbeam {

/// What a run estimates of its own error, as Errors are measured; not a number where it does not.
Errors estimated_errors(const Simulation& simulation, const std::string& point);

/// All cells with both parts reduced whose true error of one quantity lies between 1e-10 and 1e-2, and well above the
/// difference of the references.
struct EstimateJudgement {
  std::string quantity;
  int cells = 0;
  int without = 0;           ///< the run says that it cannot estimate, and why
  int within = 0;            ///< estimate at most five times too large or too small
  double least = 0.0;        ///< smallest estimate over true error
  double largest = 0.0;      ///< largest
  std::string least_cell{};  ///< where the smallest is
  double share() const { return cells == 0 ? 0.0 : static_cast<double>(within) / cells; }
};
std::vector<EstimateJudgement> judge_estimates(const std::vector<BenchmarkResult>& results);

/// Median over the cells of the time for the estimate over that for the solution.
double estimate_cost(const std::vector<BenchmarkResult>& results);

void print_judgements(std::ostream& out, const std::vector<BenchmarkResult>& results);
/// A section of the page.
void write_judgements(std::ostream& page, const std::vector<BenchmarkResult>& results);
/// estimates.csv: true and estimated errors of every cell.
void write_estimates(const std::filesystem::path& file, const std::vector<BenchmarkResult>& results);

}  // namespace mixbeam
