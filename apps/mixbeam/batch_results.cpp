#include "apps/mixbeam/batch_solver.hpp"

#include "apps/common/session/interrupt.hpp"
#include "apps/common/tables/csv_table.hpp"
#include "apps/common/tables/formatted.hpp"
#include "apps/mixbeam/run_report.hpp"
#include "discretization/results/table_file.hpp"
#include "mixbeam/version.hpp"

#include <algorithm>
#include <limits>
#include <ostream>

namespace mixbeam {

namespace {

std::filesystem::path with_ending(std::filesystem::path stem, const std::string& ending) { return stem += ending; }

/// Value of a quantity in a case; none (nan) where there is no state.
double value_of(const CaseResult& result, std::size_t quantity) {
  return result.values.written.empty() ? std::numeric_limits<double>::quiet_NaN() : result.values.written[quantity];
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
  add("stable", [&](std::size_t i) { return number_of_stable(results[i].stable); });
  if (!quantities.limits().empty())
    add("within limits", [&](std::size_t i) { return beyond_limits(results[i], quantities, i).empty() ? 1.0 : 0.0; });
  std::string causes;
  for (std::size_t i = 0; i < results.size(); ++i)
    if (!results[i].cause.empty()) causes += batch.name_of_case(i) + ": " + results[i].cause + "\n";
  write_table_file(file, columns, {{"scene", scene_xml}, {"version", kVersion}, {"causes", causes}});
}

}  // namespace

std::string beyond_limits(const CaseResult& result, const CaseQuantities& quantities, std::size_t index) {
  std::string names;
  for (std::size_t i = 0; i < result.values.limited.size(); ++i)
    if (!quantities.is_kept(result.values.limited[i], quantities.limits()[i], index))
      names += (names.empty() ? "" : "; ") + quantities.limits()[i].name;
  return names;
}

double number_of_stable(const std::string& stable) {
  if (stable == "true") return 1.0;
  if (stable == "false") return 0.0;
  return stable == "neutral" ? 0.5 : std::numeric_limits<double>::quiet_NaN();
}

void write_batch(const std::filesystem::path& stem, const Batch& batch, const CaseQuantities& quantities,
                 const std::vector<CaseResult>& results, const std::string& scene_xml) {
  write_rows(with_ending(stem, ".csv"), batch, quantities, results);
  write_columns(with_ending(stem, ".h5"), batch, quantities, results, scene_xml);
}

std::string rows_text(const CommandLine& line) {
  return line.rows ? formatted("-%d-%d", (*line.rows)[0], (*line.rows)[1]) : "";
}

void require_row(int first, std::size_t cases) {
  if (static_cast<std::size_t>(first) > cases)
    throw InputError(formatted("option --rows: row %d of %zu; allowed: 1 to %zu", first, cases, cases));
}

void part_ranks(Application& app) {
  static std::ostream silence(nullptr);
  const int rank = app.communicator->getRank();
  if (app.communicator->getSize() == 1) return;
  app.communicator = app.communicator->split(rank, 0);
  if (rank == 0) return;
  app.terminal = &silence;
  const int threads = app.summary.threads;
  app.summary = {};
  app.summary.threads = threads;
}

namespace {

constexpr std::size_t kMostNamed = 12;  // the table has them all

void print_failures(std::ostream& out, const SolvedBatch& batch) {
  std::size_t printed = 0;
  for (std::size_t i = 0; i < batch.results.size(); ++i) {
    const CaseResult& result = batch.results[i];
    if (result.solved && !result.converged && ++printed <= kMostNamed)
      out << batch.name_of_case(i) << " FAILED: " << result.cause << "\n";
  }
  if (printed > kMostNamed) out << "... and " << printed - kMostNamed << " more in the files\n";
}

/// The last lines.
void print_ends(std::ostream& out, const SolvedBatch& batch, const std::map<std::string, int>& stable_cases) {
  std::size_t printed = 0;
  for (std::size_t i = 0; i < batch.results.size(); ++i)
    if (batch.results[i].stable == "false" && ++printed <= kMostNamed)
      out << batch.name_of_case(i) << ": stable: false: " << kDoesNotStay << "\n";
  if (printed > kMostNamed) out << "... and " << printed - kMostNamed << " more in the files\n";
  out << "cases by stable:";
  const char* separator = " ";
  for (const char* word : {"true", "false", "neutral", "unknown"}) {
    const auto count = stable_cases.find(word);
    out << separator << word << " " << (count == stable_cases.end() ? 0 : count->second);
    separator = ", ";
  }
  out << "\n";
}

}  // namespace

int conclude_batch(Application& app, const CommandLine& line, const SolvedBatch& batch) {
  std::size_t failed = 0;
  for (const CaseResult& result : batch.results) {
    if (!result.solved) continue;
    ++app.summary.stable_cases[result.stable];
    if (!result.converged) ++failed;
  }
  const std::size_t cases = batch.results.size();
  const int unstable = app.summary.stable_cases["false"];
  if (unstable > 0)
    app.summary.warnings.push_back(formatted("%d of %zu cases end unstable: ", unstable, cases) + kDoesNotStay);
  if (failed > 0)
    app.summary.failure = std::to_string(failed) + " of " + std::to_string(cases) + " cases did not converge";
  if (line.summary) app.summary.write_json(*line.summary);
  print_failures(app.out(), batch);
  app.summary.print_checks(app.out(), false);
  const auto seconds = [&app](const char* name) { return app.summary.seconds[name]; };
  app.out() << formatted("mixbeam: %zu cases, %zu failed; set-up %.3f s, solve %.3f s, output %.3f s, results in ",
                         cases, failed, seconds("batch set-up"), seconds("batch solve"), seconds("batch output"))
            << app.output.string() << "\n";
  print_ends(app.out(), batch, app.summary.stable_cases);
  if (batch.interrupted) return kInterruptedExitCode;
  if (failed > 0) throw ConvergenceError(app.summary.failure);
  return app.summary.all_passed() ? 0 : kFailedExitCode;
}

}  // namespace mixbeam
