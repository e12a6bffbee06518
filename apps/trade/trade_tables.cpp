#include "apps/trade/trade_tables.hpp"

#include "apps/common/tables/csv_table.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <ostream>

namespace mixbeam {

namespace {

template <class... Values>
std::string formatted(const char* pattern, Values... values) {
  std::array<char, 200> text{};
  std::snprintf(text.data(), text.size(), pattern, values...);
  return text.data();
}

std::vector<int> meshes_of(const BenchmarkResult& result) {
  std::vector<int> meshes;
  for (const CellResult& cell : result.cells)
    if (std::find(meshes.begin(), meshes.end(), cell.cell.elements) == meshes.end())
      meshes.push_back(cell.cell.elements);
  return meshes;
}

std::string error_text(const CellResult& cell) {
  switch (cell.status) {
    case CellStatus::converged:
      return formatted("%.1e", cell.errors.largest());
    case CellStatus::failed:
      return "failed";
    case CellStatus::past_round_off:
      return ".";
    case CellStatus::too_long:
      return "long";
  }
  return "";
}

void print_row(std::ostream& out, const BenchmarkResult& result, std::size_t first, std::size_t count, int threads) {
  const Cell& cell = result.cells[first].cell;
  out << formatted("  %d error", cell.order);
  for (std::size_t i = first; i < first + count; ++i) out << formatted("%9s", error_text(result.cells[i]).c_str());
  out << "\n       ms";
  for (std::size_t i = first; i < first + count; ++i) {
    const double seconds = result.cells[i].processor_seconds(threads);
    out << (std::isnan(seconds) ? formatted("%9s", "") : formatted("%9.3g", 1e3 * seconds));
  }
  out << "\n";
}

std::vector<std::string> columns_of_cells(const std::vector<int>& threads) {
  std::vector<std::string> columns = {
      "benchmark",         "integration",  "order",        "elements",      "status",           "displacement_error",
      "centerline_error",  "moment_error", "energy_error", "largest_error", "pareto",           "global_unknowns",
      "interior_unknowns", "flops",        "load_steps",   "failed_steps",  "newton_iterations"};
  for (const int n : threads)
    for (const char* what : {"seconds", "setup_seconds", "processor_seconds"})
      columns.push_back(std::string(what) + "_" + std::to_string(n));
  return columns;
}

std::vector<CsvCell> row_of(const BenchmarkResult& result, const CellResult& cell, bool pareto,
                            const std::vector<int>& threads) {
  std::vector<CsvCell> row = {result.problem.about.name,
                              name_of(cell.cell.integration),
                              cell.cell.order,
                              cell.cell.elements,
                              name_of(cell.status),
                              cell.errors.displacement,
                              cell.errors.centerline,
                              cell.errors.moment,
                              cell.errors.energy,
                              cell.errors.largest(),
                              pareto ? 1 : 0,
                              cell.global_unknowns,
                              cell.interior_unknowns,
                              cell.flops,
                              cell.load_steps,
                              cell.failed_steps,
                              cell.iterations};
  for (const int n : threads) {
    const auto found = cell.times.find(n);
    const double nan = std::nan("");
    const CellTimes times = found == cell.times.end() ? CellTimes{nan, nan, nan} : found->second;
    for (const double value : {times.seconds, times.setup_seconds, times.processor_seconds}) row.emplace_back(value);
  }
  return row;
}

void write_cells(const std::filesystem::path& file, const std::vector<BenchmarkResult>& results,
                 const std::vector<int>& threads) {
  CsvTable csv(file, columns_of_cells(threads));
  for (const BenchmarkResult& result : results) {
    const auto front = pareto_front(result, {largest_error, processor_time(threads.front())});
    for (const CellResult& cell : result.cells)
      csv.add_row(row_of(result, cell, std::find(front.begin(), front.end(), &cell) != front.end(), threads));
  }
}

void write_benchmarks(const std::filesystem::path& file, const std::vector<BenchmarkResult>& results) {
  CsvTable csv(file, {"benchmark", "kind", "members", "point", "floor", "displacement_difference",
                      "centerline_difference", "moment_difference", "energy_difference"});
  for (const BenchmarkResult& result : results)
    csv.add_row({result.problem.about.name, result.problem.about.kind, result.problem.scene.members.size(),
                 result.problem.about.point, result.floor(), result.difference.displacement,
                 result.difference.centerline, result.difference.moment, result.difference.energy});
}

void write_orders(const std::filesystem::path& file, const std::vector<BenchmarkResult>& results, int threads) {
  CsvTable csv(file, {"measure", "cost", "accuracy", "order", "reached", "judged", "mean", "worst", "elements"});
  const std::vector<std::pair<const char*, ErrorMeasure>> measures = {{"largest", largest_error},
                                                                      {"displacement", displacement_error}};
  const std::vector<std::pair<const char*, CostMeasure>> costs = {{"seconds", processor_time(threads)},
                                                                  {"flops", operations}};
  for (const auto& [measure, error] : measures)
    for (const auto& [unit, cost] : costs)
      for (const double accuracy : accuracies())
        for (const OrderPrice& price : order_prices(results, {error, cost}, accuracy))
          csv.add_row({measure, unit, accuracy, price.order, price.reached, price.judged, price.mean, price.worst,
                       price.elements});
}

}  // namespace

std::string mesh_text(const Cell& cell) { return std::to_string(cell.order) + " x " + std::to_string(cell.elements); }

std::string time_text(double seconds) {
  return seconds < 1.0 ? formatted("%.2g ms", 1e3 * seconds) : formatted("%.2g s", seconds);
}

std::string accuracy_text(double accuracy) { return formatted("%.0e", accuracy); }

void print_matrix(std::ostream& out, const BenchmarkResult& result, int threads) {
  const std::vector<int> meshes = meshes_of(result);
  const char* integration = "";
  for (std::size_t first = 0; first + meshes.size() <= result.cells.size(); first += meshes.size()) {
    const char* of_row = name_of(result.cells[first].cell.integration);
    if (of_row != std::string(integration)) {
      out << "\n"
          << result.problem.about.name << " (" << result.problem.about.kind << "), " << of_row << "\n  k       ";
      for (const int elements : meshes) out << formatted("%9d", elements);
      out << "\n";
      integration = of_row;
    }
    print_row(out, result, first, meshes.size(), threads);
  }
  out << std::flush;
}

namespace {

void print_orders(std::ostream& out, const std::vector<BenchmarkResult>& results, const Criterion& by) {
  out << "  accuracy  order  elements  reached      price    worst  cost against 1e-02\n";
  for (const double accuracy : accuracies()) {
    const auto best = best_order(order_prices(results, by, accuracy));
    if (!best) continue;
    out << formatted("  %8s  %5d  %8.0f  %2d of %2d  %9.2f  %7.2f  %18.2f\n", accuracy_text(accuracy).c_str(),
                     best->order, best->elements, best->reached, best->judged, best->mean, best->worst,
                     cost_ratio(results, by, accuracy, accuracies().front()));
  }
}

}  // namespace

void print_recommendation(std::ostream& out, const std::vector<BenchmarkResult>& results, int threads) {
  const Criterion by_time{largest_error, processor_time(threads)};
  out << "\nCheapest order x elements of each member for a largest error, and its time\n";
  for (const BenchmarkResult& result : results) {
    out << "  " << result.problem.about.name << "\n   ";
    for (const double accuracy : accuracies()) {
      const CellResult* cell = cheapest(result, by_time, accuracy);
      if (cell == nullptr) continue;
      out << formatted("  %s: %s %s", accuracy_text(accuracy).c_str(), mesh_text(cell->cell).c_str(),
                       time_text(cell->processor_seconds(threads)).c_str());
    }
    out << "\n";
  }
  out << "\nThe order to take over all benchmarks, by time (price: that of the order over that of the cheapest, "
         "mean and worst)\n";
  print_orders(out, results, by_time);
  out << "\nThe same by operations, which is what large structures cost\n";
  print_orders(out, results, {largest_error, operations});
}

void print_accuracies(std::ostream& out, const std::vector<BenchmarkResult>& results) {
  out << "\nWanted accuracies of displacements: meshes chosen, error estimated and true, time, the cheapest single "
         "solve; for each number of threads\n";
  for (const BenchmarkResult& result : results)
    for (const AccurateCell& cell : result.accurate) {
      out << formatted("  %-20s %6s  %-28s %8.1e %8.1e", result.problem.about.name.c_str(),
                       accuracy_text(cell.wanted).c_str(), meshes_text(cell).c_str(), cell.estimated,
                       motion_error(cell.errors));
      for (const auto& [threads, price] : cell.prices) {
        out << formatted(" %9s", time_text(price.seconds).c_str());
        if (price.best)
          out << formatted("   %-8s %9s  ratio %5.2f", mesh_text(*price.best).c_str(),
                           time_text(price.best_seconds).c_str(), price.ratio());
      }
      out << (cell.end == AccuracyEnd::reached ? "" : "  " + text_of(cell.end)) << "\n";
    }
  const AccuracyTotals totals = accuracy_totals(results);
  out << "  " << totals.kept << " of " << totals.judged << " below the accuracy";
  for (const auto& [threads, ratios] : totals.ratios)
    out << formatted("; %d thread: ratio %.2f, at most %.2f", threads, ratios.middle, ratios.largest);
  out << "\n";
}

AccuracyTotals accuracy_totals(const std::vector<BenchmarkResult>& results) {
  AccuracyTotals totals;
  std::map<int, std::vector<double>> ratios;
  for (const BenchmarkResult& result : results)
    for (const AccurateCell& cell : result.accurate) {
      if (cell.wanted < result.floor()) continue;
      ++totals.judged;
      totals.kept += motion_error(cell.errors) <= cell.wanted ? 1 : 0;
      for (const auto& [threads, price] : cell.prices)
        if (price.best) ratios[threads].push_back(price.ratio());
    }
  for (auto& [threads, list] : ratios) {
    std::sort(list.begin(), list.end());
    totals.ratios[threads] = {list[list.size() / 2], list.back()};
  }
  return totals;
}

namespace {

void write_accuracies(const std::filesystem::path& file, const std::vector<BenchmarkResult>& results) {
  CsvTable csv(file, {"benchmark", "wanted", "outcome", "meshes", "rounds", "estimated_error", "displacement_error",
                      "centerline_error", "path_error", "threads", "seconds", "best_order", "best_elements",
                      "best_seconds", "ratio"});
  for (const BenchmarkResult& result : results)
    for (const AccurateCell& cell : result.accurate)
      for (const auto& [threads, price] : cell.prices)
        csv.add_row({result.problem.about.name, cell.wanted, text_of(cell.end), meshes_text(cell), cell.rounds.size(),
                     cell.estimated, cell.errors.displacement, cell.errors.centerline,
                     cell.path_error.value_or(std::nan("")), threads, price.seconds, price.best ? price.best->order : 0,
                     price.best ? price.best->elements : 0, price.best_seconds, price.ratio()});
}

}  // namespace

void write_tables(const std::filesystem::path& folder, const std::vector<BenchmarkResult>& results,
                  const std::vector<BenchmarkResult>& gallery, const std::vector<int>& threads) {
  write_cells(folder / "trade.csv", results, threads);
  write_benchmarks(folder / "benchmarks.csv", results);
  write_orders(folder / "orders.csv", results, threads.front());
  write_accuracies(folder / "accuracy.csv", results);
  write_cells(folder / "gallery.csv", gallery, {threads.front()});
  write_accuracies(folder / "gallery_accuracy.csv", gallery);
}

}  // namespace mixbeam
