#include "apps/mixbeam/batch_run.hpp"

#include "apps/common/session/guarded_run.hpp"
#include "apps/common/session/interrupt.hpp"
#include "apps/common/session/mpi_session.hpp"
#include "apps/common/tables/formatted.hpp"
#include "apps/mixbeam/scene_run.hpp"
#include "discretization/results/table_file.hpp"
#include "discretization/text/errors.hpp"
#include "discretization/text/text_file.hpp"
#include "mixbeam/version.hpp"

#include <limits>
#include <ostream>

namespace mixbeam {

namespace {

/// 1 for "true", 0 for "false", 0.5 for "neutral", NaN for "unknown": a number for a column of the HDF5 file.
double number_of_stable(const std::string& stable) {
  if (stable == "true") return 1.0;
  if (stable == "false") return 0.0;
  return stable == "neutral" ? 0.5 : std::numeric_limits<double>::quiet_NaN();
}

/// "sag; drift": the quantities of a case beyond their limits.
std::string beyond_limits(const CaseResult& result, const CaseQuantities& quantities, std::size_t index) {
  std::string names;
  for (std::size_t i = 0; i < result.values.limited.size(); ++i)
    if (!quantities.is_kept(result.values.limited[i], quantities.limits()[i], index))
      names += (names.empty() ? "" : "; ") + quantities.limits()[i].name;
  return names;
}

/// Column of a quantity: NaN without a state; member indices as names in the CSV file.
CaseColumn column_of_quantity(const BatchRun& run, const std::vector<CaseResult>& results, const std::string& name,
                              std::size_t number) {
  const auto value = [&run, &results, number](std::size_t i) {
    const std::vector<double>& written = results[i].values.written;
    const std::size_t place = run.place_of(number, i);
    return place < written.size() ? written[place] : std::numeric_limits<double>::quiet_NaN();
  };
  const auto cell = [&run, value, number](std::size_t i) {
    const double one = value(i);
    const std::string member = std::isnan(one) ? "" : run.quantities_of(i).member_of(run.place_of(number, i), one);
    return member.empty() ? CsvCell(one) : CsvCell(member);
  };
  return {name, cell, value};
}

/// Columns of the table; `run`, `table` and `results` must outlive them.
std::vector<CaseColumn> columns_of(const BatchRun& run, const BatchTable& table,
                                   const std::vector<CaseResult>& results) {
  std::vector<CaseColumn> columns = {
      column_of_numbers("case", [&table](std::size_t i) { return table.before + i + 1; })};
  columns.insert(columns.end(), table.own.begin(), table.own.end());
  for (std::size_t q = 0; q < table.names.size(); ++q)
    columns.push_back(column_of_quantity(run, results, table.names[q], q));
  const auto beyond = [&](std::size_t i) { return beyond_limits(results[i], run.quantities_of(i), i); };
  columns.push_back(column_of_numbers("iterations", [&](std::size_t i) { return results[i].iterations; }));
  columns.push_back(column_of_numbers("residual", [&](std::size_t i) { return results[i].residual; }));
  columns.push_back({"converged", [&](std::size_t i) { return CsvCell(results[i].converged ? "yes" : "no"); },
                     [&](std::size_t i) { return results[i].converged ? 1.0 : 0.0; }});
  columns.push_back({"stable", [&](std::size_t i) { return CsvCell(results[i].stable); },
                     [&](std::size_t i) { return number_of_stable(results[i].stable); }});
  columns.push_back({"cause", [&](std::size_t i) { return CsvCell(results[i].cause); }});
  if (!table.has_limits) return columns;
  columns.push_back({"beyond limits", [beyond](std::size_t i) { return CsvCell(beyond(i)); }});
  columns.push_back({"within limits", {}, [beyond](std::size_t i) { return beyond(i).empty() ? 1.0 : 0.0; }});
  return columns;
}

void write_batch(const std::filesystem::path& stem, const BatchRun& run, const std::vector<CaseResult>& results) {
  BatchTable table = run.table(results);
  const std::vector<CaseColumn> columns = columns_of(run, table, results);
  std::vector<std::string> heads;
  for (const CaseColumn& column : columns)
    if (column.cell) heads.push_back(column.name);
  CsvTable csv(stem.string() + ".csv", heads, Appears::when_closed);
  std::string causes;
  for (std::size_t i = 0; i < results.size(); ++i) {
    if (!results[i].solved) continue;
    std::vector<CsvCell> cells;
    for (const CaseColumn& column : columns)
      if (column.cell) cells.push_back(column.cell(i));
    csv.add_row(cells);
    if (!results[i].cause.empty()) causes += run.name_of_case(i) + ": " + results[i].cause + "\n";
  }
  csv.close();
  std::vector<TableColumn> numbers;
  for (const CaseColumn& column : columns)
    if (column.number)
      numbers.push_back({column.name, {}, [&results, &column] {
                           std::vector<double> values;
                           for (std::size_t i = 0; i < results.size(); ++i)
                             if (results[i].solved) values.push_back(column.number(i));
                           return values;
                         }});
  table.texts["version"] = kVersion;
  table.texts["causes"] = causes;
  write_table_file(stem.string() + ".h5", numbers, table.texts);
}

/// Checks the quantities of each case against their limits.
void check_limits(Application& app, const BatchRun& run) {
  for (std::size_t i = 0; i < run.results().size(); ++i) {
    const CaseQuantities& quantities = run.quantities_of(i);
    const std::vector<EstimatedValue>& values = run.results()[i].values.limited;
    for (std::size_t j = 0; j < values.size(); ++j)
      app.summary.check_limit(run.name_of_case(i) + ": size of " + values[j].name, "", std::abs(values[j].value),
                              values[j].error, values[j].not_estimated,
                              quantities.largest_size(quantities.limits()[j], i));
  }
}

/// "-3-7" of --rows 3:7, for names of files; empty without it.
std::string rows_text(const CommandLine& line) {
  return line.rows ? formatted("-%d-%d", (*line.rows)[0], (*line.rows)[1]) : "";
}

/// Separates the ranks: each solves by itself; only the first one prints.
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

constexpr std::size_t kMostNamed = 12;  // the table has all

void print_failures(std::ostream& out, const BatchRun& batch) {
  std::size_t printed = 0;
  for (std::size_t i = 0; i < batch.results().size(); ++i) {
    const CaseResult& result = batch.results()[i];
    if (result.solved && !result.converged && ++printed <= kMostNamed)
      out << batch.name_of_case(i) << " FAILED: " << result.cause << "\n";
  }
  if (printed > kMostNamed) out << "... and " << printed - kMostNamed << " more in the files\n";
}

/// Prints the last lines.
void print_ends(std::ostream& out, const BatchRun& batch, const std::map<std::string, int>& stable_cases) {
  std::size_t printed = 0;
  for (std::size_t i = 0; i < batch.results().size(); ++i)
    if (batch.results()[i].stable == "false" && ++printed <= kMostNamed)
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

/// Finishes run_batch().
int conclude_batch(Application& app, const CommandLine& line, const BatchRun& batch) {
  std::size_t failed = 0;
  for (const CaseResult& result : batch.results()) {
    if (!result.solved) continue;
    ++app.summary.stable_cases[result.stable];
    if (!result.converged) ++failed;
  }
  const std::size_t cases = batch.results().size();
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
  if (batch.interrupted()) return kInterruptedExitCode;
  if (failed > 0) throw ConvergenceError(app.summary.failure);
  return app.summary.all_passed() ? 0 : kFailedExitCode;
}

}  // namespace

void require_rows(const std::array<int, 2>& rows, std::size_t cases) {
  if (static_cast<std::size_t>(rows[1]) > cases)
    throw InputError(formatted("option --rows: value %d:%d; allowed: rows 1 to %zu", rows[0], rows[1], cases));
}

int run_batch(Application& app, const CommandLine& line, const Communicator& ranks, const std::string& name,
              const std::function<std::unique_ptr<BatchRun>()>& read) {
  const std::filesystem::path stem = app.output / (name + "-batch" + rows_text(line));
  const SharedResultLock lock = lock_or_warn(app, stem.string() + ".h5");
  watch_for_interrupts();
  part_ranks(app);
  const std::unique_ptr<BatchRun> run = read();
  for (const char* ending : {".h5", ".csv"}) require_no_input(stem.string() + ending);
  try {
    const LastResort rows([&] {
      if (ranks->getRank() == 0) write_batch(stem, *run, run->results_so_far());
    });
    run->solve();
  } catch (const MemberError& error) {
    throw placed(app, error);
  }
  if (ranks->getRank() > 0) return 0;
  finish_in_order();  // the table is written in one piece
  {
    const Stopwatch stopwatch(app, "batch output");
    write_batch(stem, *run, run->results());
  }
  run->check_expected();
  check_limits(app, *run);
  return conclude_batch(app, line, *run);
}

}  // namespace mixbeam
