/// The results for the terminal and as CSV.
#pragma once

#include "apps/trade/choice.hpp"

#include <filesystem>
#include <iosfwd>
#include <string>
#include <vector>

namespace mixbeam {

/// "8 x 4": order and elements of each member.
std::string mesh_text(const Cell& cell);
/// "0.53 ms", "2.1 s"
std::string time_text(double seconds);
/// "1e-05"
std::string accuracy_text(double accuracy);

/// Largest error and processor time of every cell, orders down, meshes across.
void print_matrix(std::ostream& out, const BenchmarkResult& result, int threads);
/// The cheapest cell of every benchmark for every accuracy, and the best order over all of them.
void print_recommendation(std::ostream& out, const std::vector<BenchmarkResult>& results, int threads);

/// A wanted accuracy against the single solve that reaches it cheapest.
struct AccuracyPrice {
  const AccurateCell* cell;
  const CellResult* best;  ///< null: none reaches it, or so small an error is not judged
  double ratio;            ///< of processor times
};
std::vector<AccuracyPrice> accuracy_prices(const BenchmarkResult& result, int threads);
/// Meshes chosen, error estimated and true, time, the cheapest single solve; then the ratios over all benchmarks.
void print_accuracies(std::ostream& out, const std::vector<BenchmarkResult>& results, int threads);

/// trade.csv: a row for each cell. benchmarks.csv: what each benchmark is, and its references. orders.csv: the price of
/// each order for each accuracy, by the largest error and by that of the displacement. accuracy.csv: a row for each
/// accuracy that the program was asked for.
void write_tables(const std::filesystem::path& folder, const std::vector<BenchmarkResult>& results,
                  const std::vector<int>& threads);

}  // namespace mixbeam
