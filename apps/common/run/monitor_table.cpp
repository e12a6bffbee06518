#include "apps/common/run/monitor_table.hpp"

#include "discretization/state/record_fields.hpp"
#include "discretization/text/result_names.hpp"

#include <array>

namespace mixbeam {

namespace {

constexpr std::array<const char*, 3> kAxes = {"x", "y", "z"};

}  // namespace

void MonitorTable::add(const StoredRun& run) {
  for (std::size_t step = 0; step < run.steps().size(); ++step) {
    Row row;
    for (const MonitoredSeries& series : run.monitor()) {
      const auto begin = series.values.begin() + static_cast<std::ptrdiff_t>(step * series.columns);
      row[series.name].assign(begin, begin + static_cast<std::ptrdiff_t>(series.columns));
    }
    write(row, run.stability()[step].stable);
  }
}

void MonitorTable::add(const StepRecord& record) {
  Row row;
  visit_fields<const StepSummary>(
      record, [&](const auto& field, auto value) { row[field.name] = {static_cast<double>(value)}; });
  for (const MonitoredQuantity& quantity : record.monitored) row[quantity.name] = quantity.components;
  write(row, record.stability.stable);
}

void MonitorTable::write(const Row& row, const std::string& stable) {
  std::vector<std::string> names = kOwnTimeSeries;  // the others follow in alphabetical order
  for (const auto& [name, values] : row)
    if (!is_own_time_series(name) && name != kQuantitySeries) names.push_back(name);
  std::vector<std::string> columns;
  std::vector<CsvCell> cells;
  for (const std::string& name : names) {
    const std::vector<double>& values = row.at(name);
    for (std::size_t i = 0; i < values.size(); ++i) {
      columns.push_back(values.size() == kAxes.size() ? name + "." + kAxes[i] : name);
      cells.emplace_back(values[i]);
    }
  }
  for (std::size_t i = 0; i < quantities_.names.size(); ++i) {
    columns.push_back(quantities_.names[i]);
    cells.push_back(quantity_cell(i, row.at(kQuantitySeries).at(i)));
  }
  columns.emplace_back("stable");
  cells.emplace_back(stable);
  if (!table_) table_.emplace(path_, columns);
  table_->add_row(cells);
}

CsvCell MonitorTable::quantity_cell(std::size_t column, double value) const {
  const auto members = static_cast<double>(quantities_.members.size());
  const bool is_member = quantities_.is_member[column] && value >= 0.0 && value < members;
  return is_member ? CsvCell(quantities_.members.at(static_cast<std::size_t>(value))) : CsvCell(value);
}

}  // namespace mixbeam
