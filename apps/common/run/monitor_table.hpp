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
  /// The columns of the series kQuantitySeries; where they are indices of members, the names are written.
  struct Quantities {
    std::vector<std::string> names{};
    std::vector<bool> is_member{};
    std::vector<std::string> members{};
  };

  /// Replaces a file of that name as soon as there is a row.
  MonitorTable(std::filesystem::path path, Quantities quantities)
      : path_(std::move(path)), quantities_(std::move(quantities)) {}

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

  CsvCell quantity_cell(std::size_t column, double value) const;

  std::filesystem::path path_;
  Quantities quantities_;
  std::optional<CsvTable> table_;
};

}  // namespace mixbeam
