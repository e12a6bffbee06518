/// Tables of the study, for the terminal and as CSV.
#pragma once

#include "apps/common/studies/phase_costs.hpp"
#include "apps/common/tables/csv_table.hpp"
#include "apps/thread_scaling/machine_ceilings.hpp"
#include "apps/thread_scaling/measurement.hpp"

#include <filesystem>
#include <iosfwd>
#include <memory>
#include <optional>

namespace mixbeam {

/// Number of threads -> ceilings.
using CeilingsByThreads = std::map<int, MachineCeilings>;

/// One row of the tables: a phase of a case with one number of threads. Not a number: not known.
struct PhaseFigures {
  double seconds, ratio_to_unit, speed_up, efficiency;
  PhaseCost cost;                                 ///< of one element
  double flops_per_second, bytes_per_second;      ///< of all threads together
  double share_of_flop_peak, share_of_bandwidth;  ///< of the ceilings for as many threads
};
PhaseFigures phase_figures(const ScalingCase& of, const Measurement& measurement, const CeilingsByThreads& ceilings,
                           int threads, const std::string& phase);

class ScalingReport {
 public:
  /// `folder`: for thread_scaling.csv, cases.csv, ceilings.csv; none: nothing is written.
  ScalingReport(std::ostream& out, const std::optional<std::filesystem::path>& folder, CeilingsByThreads ceilings);

  /// Prints the phases of a case and adds its rows to the files.
  void add(const ScalingCase& of, const Measurement& measurement);
  /// One line for each case so far.
  void print_summary() const;

 private:
  void print_phases(const ScalingCase& of, const Measurement& measurement) const;
  void write(const ScalingCase& of, const Measurement& measurement);

  std::ostream& out_;
  CeilingsByThreads ceilings_;
  std::unique_ptr<CsvTable> phases_, cases_;
  std::vector<std::pair<ScalingCase, Measurement>> done_;
};

}  // namespace mixbeam
