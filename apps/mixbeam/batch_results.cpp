#include "apps/mixbeam/batch_solver.hpp"

#include "apps/common/tables/csv_table.hpp"
#include "discretization/results/table_file.hpp"
#include "mixbeam/version.hpp"

#include <limits>

namespace mixbeam {

namespace {

std::filesystem::path with_ending(std::filesystem::path stem, const std::string& ending) { return stem += ending; }

/// Value of a quantity in a case; none (nan) where there is no state.
double value_of(const CaseResult& result, std::size_t quantity) {
  return result.values.written.empty() ? std::numeric_limits<double>::quiet_NaN() : result.values.written[quantity];
}

/// "sag; drift": the quantities that are beyond their limits.
std::string beyond_limits(const CaseResult& result, const CaseQuantities& quantities, std::size_t index) {
  std::string names;
  for (std::size_t i = 0; i < result.values.limited.size(); ++i)
    if (!quantities.is_kept(result.values.limited[i], quantities.limits()[i], index))
      names += (names.empty() ? "" : "; ") + quantities.limits()[i].name;
  return names;
}

/// A column holds numbers: 1 for true, 0 for false, 0.5 for neutral, nan for unknown.
double number_of(const std::string& stable) {
  if (stable == "true") return 1.0;
  if (stable == "false") return 0.0;
  return stable == "neutral" ? 0.5 : std::numeric_limits<double>::quiet_NaN();
}

void write_rows(const std::filesystem::path& file, const Batch& batch, const CaseQuantities& quantities,
                const std::vector<CaseResult>& results) {
  std::vector<std::string> names = {"case"};
  for (const BatchColumn& column : batch.columns) names.push_back(column.parameter);
  names.insert(names.end(), quantities.names().begin(), quantities.names().end());
  for (const char* name : {"iterations", "residual", "converged", "stable", "cause"}) names.emplace_back(name);
  if (!quantities.limits().empty()) names.emplace_back("beyond limits");
  CsvTable table(file, names, Appears::when_closed);
  std::vector<CsvCell> cells;
  for (std::size_t i = 0; i < results.size(); ++i) {
    const CaseResult& result = results[i];
    if (!result.solved) continue;
    cells.assign(1, CsvCell(batch.before + i + 1));
    for (std::size_t c = 0; c < batch.columns.size(); ++c) cells.emplace_back(batch.value(i, c));
    for (std::size_t q = 0; q < quantities.names().size(); ++q) {
      const double value = value_of(result, q);
      const std::string member = quantities.member_of(q, value);
      cells.push_back(member.empty() ? CsvCell(value) : CsvCell(member));
    }
    cells.emplace_back(result.iterations);
    cells.emplace_back(result.residual);
    cells.emplace_back(result.converged ? "yes" : "no");
    cells.emplace_back(result.stable);
    cells.emplace_back(result.cause);
    if (!quantities.limits().empty()) cells.emplace_back(beyond_limits(result, quantities, i));
    table.add_row(cells);
  }
  table.close();
}

void write_columns(const std::filesystem::path& file, const Batch& batch, const CaseQuantities& quantities,
                   const std::vector<CaseResult>& results, const std::string& scene_xml) {
  std::vector<TableColumn> columns;
  const auto add = [&](const std::string& name, const auto& value) {
    TableColumn& column = columns.emplace_back(TableColumn{name, {}});
    column.values.reserve(results.size());
    for (std::size_t i = 0; i < results.size(); ++i)
      if (results[i].solved) column.values.push_back(value(i));
  };
  add("case", [&](std::size_t i) { return static_cast<double>(batch.before + i + 1); });
  for (std::size_t c = 0; c < batch.columns.size(); ++c)
    add(batch.columns[c].parameter, [&](std::size_t i) { return batch.value(i, c); });
  for (std::size_t q = 0; q < quantities.names().size(); ++q)
    add(quantities.names()[q], [&](std::size_t i) { return value_of(results[i], q); });
  add("iterations", [&](std::size_t i) { return static_cast<double>(results[i].iterations); });
  add("residual", [&](std::size_t i) { return results[i].residual; });
  add("converged", [&](std::size_t i) { return results[i].converged ? 1.0 : 0.0; });
  add("stable", [&](std::size_t i) { return number_of(results[i].stable); });
  if (!quantities.limits().empty())
    add("within limits", [&](std::size_t i) { return beyond_limits(results[i], quantities, i).empty() ? 1.0 : 0.0; });
  std::string causes;
  for (std::size_t i = 0; i < results.size(); ++i)
    if (!results[i].cause.empty()) causes += batch.name_of_case(i) + ": " + results[i].cause + "\n";
  write_table_file(file, columns, {{"scene", scene_xml}, {"version", kVersion}, {"causes", causes}});
}

}  // namespace

void write_batch(const std::filesystem::path& stem, const Batch& batch, const CaseQuantities& quantities,
                 const std::vector<CaseResult>& results, const std::string& scene_xml) {
  write_rows(with_ending(stem, ".csv"), batch, quantities, results);
  write_columns(with_ending(stem, ".h5"), batch, quantities, results, scene_xml);
}

}  // namespace mixbeam
