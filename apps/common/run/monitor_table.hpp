/// What is followed over a run, as a CSV file with one row for each completed step: number of the step, load factor,
/// iterations, residual, energies, then every monitored quantity by its name, vectors as <name>.x, .y, .z,
/// and whether the state is stable: true, false, neutral, unknown.
#pragma once

#include "apps/common/tables/csv_table.hpp"
#include "discretization/results/stored_run.hpp"

#include <optional>

namespace mixbeam {

class MonitorTable {
 public:
  /// Replaces a file of that name as soon as there is a row.
  explicit MonitorTable(std::filesystem::path path) : path_(std::move(path)) {}

  /// A row for every step that a result file holds.
  void add(const StoredRun& run);
  void add(const StepRecord& record);
  /// Waits until the file is on the disk.
  void close() {
    if (table_) table_->close();
  }

 private:
  /// Quantities by name, in alphabetical order.
  using Row = std::map<std::string, std::vector<double>>;
  void write(const Row& row, const std::string& stable);

  std::filesystem::path path_;
  std::optional<CsvTable> table_;
};

}  // namespace mixbeam
