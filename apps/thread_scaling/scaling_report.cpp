#include "apps/thread_scaling/scaling_report.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <ostream>

namespace mixbeam {

namespace {

/// Share of the processor from which on times in seconds are those of the program alone.
constexpr double kIdleMachine = 0.95;

/// In the order of an iteration; sums behind their parts, whatever else there is at the end.
constexpr std::array<const char*, 15> kOrderOfPhases = {"residual",
                                                        "element tangent",
                                                        "condense chains",
                                                        "assemble",
                                                        "symbolic factorisation",
                                                        "numeric factorisation",
                                                        "solve",
                                                        "check of the solve",
                                                        "recover",
                                                        "update",
                                                        kOther,
                                                        kElementWork,
                                                        kLinearSolver,
                                                        kLinearSolverSparse,
                                                        kWholeIteration};

std::vector<std::string> ordered_phases(const Measurement& measurement) {
  std::vector<std::string> phases = measurement.phases();
  const auto place = [](const std::string& phase) {
    return std::find(kOrderOfPhases.begin(), kOrderOfPhases.end(), phase) - kOrderOfPhases.begin();
  };
  std::stable_sort(phases.begin(), phases.end(),
                   [&](const std::string& a, const std::string& b) { return place(a) < place(b); });
  return phases;
}

template <class... Values>
std::string text_of_line(const char* format, Values... values) {
  std::array<char, 256> text{};
  std::snprintf(text.data(), text.size(), format, values...);
  return text.data();
}

/// Right-aligned; "-" for what is not known.
std::string cell(double value, int width, int digits) {
  return std::isnan(value) ? text_of_line("%*s", width, "-") : text_of_line("%*.*f", width, digits, value);
}

/// Milliseconds with about four digits.
std::string milliseconds(double seconds, int width) {
  const double ms = 1e3 * seconds;
  return cell(ms, width, ms < 10.0 ? 3 : ms < 100.0 ? 2 : 1);
}

}  // namespace

PhaseFigures phase_figures(const ScalingCase& of, const Measurement& measurement, const CeilingsByThreads& ceilings,
                           int threads, const std::string& phase) {
  const auto costs = phase_costs(of.kind, of.order);
  const auto cost = costs.find(phase);
  PhaseFigures figures{};
  figures.cost = cost == costs.end() ? PhaseCost{std::nan(""), std::nan("")} : cost->second;
  figures.seconds = measurement.seconds(threads, phase);
  figures.ratio_to_unit = measurement.ratio_to_unit(threads, phase);
  const int reference = ceilings.begin()->first;
  figures.speed_up = measurement.speed_up(reference, threads, phase);
  figures.efficiency = figures.speed_up * reference / threads;
  figures.flops_per_second = figures.cost.flops * of.elements / figures.seconds;
  figures.bytes_per_second = figures.cost.bytes * of.elements / figures.seconds;
  figures.share_of_flop_peak = figures.flops_per_second / ceilings.at(threads).flops_per_second;
  figures.share_of_bandwidth = figures.bytes_per_second / ceilings.at(threads).bytes_per_second;
  return figures;
}

ScalingReport::ScalingReport(std::ostream& out, const std::optional<std::filesystem::path>& folder,
                             CeilingsByThreads ceilings)
    : out_(out), ceilings_(std::move(ceilings)) {
  for (const auto& [threads, of_threads] : ceilings_)
    out_ << text_of_line("ceilings of %d thread%s: %.1f GFlop/s multiply-add, %.1f GB/s triad\n", threads,
                         threads == 1 ? "" : "s", 1e-9 * of_threads.flops_per_second,
                         1e-9 * of_threads.bytes_per_second);
  if (!folder) return;
  using Columns = std::vector<std::string>;
  CsvTable csv(*folder / "ceilings.csv", Columns{"threads", "flops_per_second", "bytes_per_second"});
  for (const auto& [threads, of_threads] : ceilings_)
    csv.add_row({threads, of_threads.flops_per_second, of_threads.bytes_per_second});
  phases_ = std::make_unique<CsvTable>(
      *folder / "thread_scaling.csv",
      Columns{"kind", "elements", "order", "threads", "phase", "median_seconds", "ratio_to_unit", "speed_up",
              "efficiency", "flops_per_element", "bytes_per_element", "flops_per_second", "bytes_per_second",
              "share_of_flop_peak", "share_of_bandwidth"});
  cases_ = std::make_unique<CsvTable>(
      *folder / "cases.csv", Columns{"kind", "elements", "order", "rounds", "unit_seconds", "unit_factorize_seconds",
                                     "unit_solve_seconds", "memory_bytes_per_element", "share_of_processor"});
}

void ScalingReport::add(const ScalingCase& of, const Measurement& measurement) {
  print_phases(of, measurement);
  if (phases_ != nullptr) write(of, measurement);
  done_.emplace_back(of, measurement);
}

void ScalingReport::print_phases(const ScalingCase& of, const Measurement& measurement) const {
  out_ << text_of_line("\n%s, %d elements of order %d: B = %.3f ms (dgbtrf %.3f), %.0f bytes of memory per element\n",
                       of.kind.c_str(), of.elements, of.order, 1e3 * measurement.unit(),
                       1e3 * measurement.unit_factorize(), measurement.memory / of.elements);
  if (measurement.share_of_processor() < kIdleMachine)
    out_ << text_of_line("The machine was busy: B had the processor %.0f %% of its time. Judge by t / B alone.\n",
                         100.0 * measurement.share_of_processor());
  out_ << text_of_line("%-24s%8s%10s%8s%9s%6s%9s%9s%5s%9s%8s%5s\n", "phase", "threads", "ms", "t / B", "speed-up",
                       "eff.", "flop/el.", "GFlop/s", "%", "byte/el.", "GB/s", "%");
  for (const std::string& phase : ordered_phases(measurement))
    for (const auto& [threads, ignored] : ceilings_) {
      const PhaseFigures f = phase_figures(of, measurement, ceilings_, threads, phase);
      if (std::isnan(f.seconds)) continue;
      const bool first = threads == ceilings_.begin()->first;
      out_ << text_of_line("%-24s%8d", first ? phase.c_str() : "", threads) << milliseconds(f.seconds, 10)
           << cell(f.ratio_to_unit, 8, 3) << cell(f.speed_up, 9, 2) << cell(f.efficiency, 6, 2)
           << cell(f.cost.flops, 9, 0) << cell(1e-9 * f.flops_per_second, 9, 2)
           << cell(100.0 * f.share_of_flop_peak, 5, 0) << cell(f.cost.bytes, 9, 0)
           << cell(1e-9 * f.bytes_per_second, 8, 2) << cell(100.0 * f.share_of_bandwidth, 5, 0) << "\n";
    }
  out_.flush();
}

void ScalingReport::write(const ScalingCase& of, const Measurement& measurement) {
  for (const std::string& phase : ordered_phases(measurement))
    for (const auto& [threads, ignored] : ceilings_) {
      const PhaseFigures f = phase_figures(of, measurement, ceilings_, threads, phase);
      if (std::isnan(f.seconds)) continue;
      phases_->add_row({of.kind, of.elements, of.order, threads, phase, f.seconds, f.ratio_to_unit, f.speed_up,
                        f.efficiency, f.cost.flops, f.cost.bytes, f.flops_per_second, f.bytes_per_second,
                        f.share_of_flop_peak, f.share_of_bandwidth});
    }
  const double unit = measurement.unit(), factorize = measurement.unit_factorize();
  cases_->add_row({of.kind, of.elements, of.order, measurement.rounds.size(), unit, factorize, unit - factorize,
                   measurement.memory / of.elements, measurement.share_of_processor()});
}

void ScalingReport::print_summary() const {
  out_ << text_of_line("\n%-10s%10s%3s%8s%11s%8s%9s%12s%8s%12s%8s%11s%8s\n", "", "elements", "k", "threads",
                       "iteration", "t / B", "speed-up", "chains, ms", "t / B", "KLU2, ms", "t / B", "run, ms",
                       "t / B");
  for (const auto& [of, measurement] : done_)
    for (const auto& [threads, ignored] : ceilings_) {
      out_ << text_of_line("%-10s%10d%3d%8d", of.kind.c_str(), of.elements, of.order, threads)
           << milliseconds(measurement.seconds(threads, kWholeIteration), 11)
           << cell(measurement.ratio_to_unit(threads, kWholeIteration), 8, 2)
           << cell(measurement.speed_up(ceilings_.begin()->first, threads, kWholeIteration), 9, 2);
      const std::array<std::pair<const char*, int>, 3> columns = {
          {{kLinearSolver, 12}, {kLinearSolverSparse, 12}, {kWholeRun, 11}}};
      for (const auto& [phase, width] : columns)
        out_ << milliseconds(measurement.seconds(threads, phase), width)
             << cell(measurement.ratio_to_unit(threads, phase), 8, 2);
      out_ << "\n";
    }
}

}  // namespace mixbeam
