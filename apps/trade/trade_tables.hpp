/// The results for the terminal and as CSV.
#pragma once

#include "apps/trade/choice.hpp"

#include <filesystem>
#include <iosfwd>
#include <map>
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

/// Of all accuracies that are judged.
struct AccuracyTotals {
  struct Ratios {
    double middle = 0.0, largest = 0.0;  ///< median and maximum of AccuracyPrice::ratio()
  };
  int judged = 0, kept = 0;        ///< kept: the true error is below the accuracy
  std::map<int, Ratios> ratios{};  ///< by threads
};
AccuracyTotals accuracy_totals(const std::vector<BenchmarkResult>& results);
/// Meshes chosen, error estimated and true, time, the cheapest single solve; then the ratios over all benchmarks.
void print_accuracies(std::ostream& out, const std::vector<BenchmarkResult>& results);

/// trade.csv: a row for each cell. benchmarks.csv: what each benchmark is, and its references. orders.csv: the price of
/// each order for each accuracy, by the largest error and by that of the displacement. accuracy.csv: a row for each
/// accuracy that the program was asked for, with each number of threads. gallery.csv, gallery_accuracy.csv: the same of
/// the gallery.
void write_tables(const std::filesystem::path& folder, const std::vector<BenchmarkResult>& results,
                  const std::vector<BenchmarkResult>& gallery, const std::vector<int>& threads);

}  // namespace mixbeam
