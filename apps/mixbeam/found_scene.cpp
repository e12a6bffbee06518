#include "apps/mixbeam/found_scene.hpp"

#include "apps/common/run/quantity_values.hpp"
#include "apps/common/run/scene_file.hpp"
#include "apps/common/tables/csv_table.hpp"
#include "apps/common/tables/formatted.hpp"
#include "apps/mixbeam/commands.hpp"
#include "discretization/parameters/parameter_file.hpp"
#include "discretization/results/table_file.hpp"
#include "discretization/text/errors.hpp"
#include "discretization/text/message_text.hpp"
#include "discretization/text/text_file.hpp"

#include <algorithm>
#include <cmath>
#include <ostream>

namespace mixbeam {

namespace {

/// Relative tolerance between the end of a path and the continued equilibrium: far above the error of Newton's method,
/// far below the distance of another equilibrium.
constexpr double kSameState = 1e-6;
/// Columns that fit into a line of the terminal.
constexpr std::size_t kMostColumns = 6;

void print_head(std::ostream& out, const SearchParameters& search) {
  out << search.list << ": " << search.numbers.size() << " number(s) from "
      << (search.is_design ? "an objective and " + std::to_string(search.wanted.size() - 1) + " constraint(s)"
                           : std::to_string(search.wanted.size()) + " measurement(s)")
      << "\n  step     objective    gradient      change" << (search.is_design ? "   violation" : "");
  for (std::size_t i = 0; i < std::min(search.numbers.size(), kMostColumns); ++i)
    out << formatted("  %16.16s", search.numbers[i].name.c_str());
  out << (search.numbers.size() > kMostColumns ? "  ...\n" : "\n");
}

void print_step(std::ostream& out, const SearchParameters& search, const SearchStep& step) {
  out << formatted("  %4d  %12.6g  %10.2e  %10.2e", step.number, step.objective, step.gradient, step.step);
  if (search.is_design) out << formatted("  %10.2e", step.violation);
  for (std::size_t i = 0; i < std::min(step.unknowns.size(), kMostColumns); ++i)
    out << formatted("  %16.10g", step.unknowns[i]);
  out << "\n" << std::flush;
}

double correlation(const FoundScene& found, std::size_t i, std::size_t j) {
  return found.covariance[i * found.numbers.size() + j] / (found.numbers[i].deviation * found.numbers[j].deviation);
}

void print_fit(std::ostream& out, const SearchParameters& search, const FoundScene& found) {
  constexpr double kStrong = 0.9;  // then deviations alone mean little
  for (std::size_t i = 0; i < found.numbers.size(); ++i)
    for (std::size_t j = 0; j < i && !found.covariance.empty(); ++j)
      if (std::abs(correlation(found, i, j)) > kStrong)
        out << "  " << found.numbers[j].name << " and " << found.numbers[i].name
            << formatted(" are correlated by %.4f\n", correlation(found, i, j));
  double sum = 0.0;
  for (std::size_t k = 0; k < found.values.size(); ++k)
    sum += std::pow((found.values[k] - search.wanted[k].value) / search.wanted[k].deviation, 2);
  const auto freedom = static_cast<double>(search.wanted.size()) - static_cast<double>(found.numbers.size());
  if (!found.values.empty())
    out << formatted("  squares of residuals over deviations: %.6g; expected about %.0f\n", sum,
                     std::max(freedom, 0.0));
}

void print_constraints(std::ostream& out, const SearchParameters& search, const FoundScene& found) {
  for (std::size_t k = 0; k < found.values.size(); ++k) {
    const WantedQuantity& wanted = search.wanted[k];
    out << formatted("  %-20.20s  %16.10g", wanted.name.c_str(), found.values[k]);
    if (wanted.at_least) out << formatted("  at least %.10g", *wanted.at_least);
    if (wanted.at_most) out << formatted("  at most %.10g", *wanted.at_most);
    out << "\n";
  }
}

void print_found(std::ostream& out, const SearchParameters& search, const FoundScene& found) {
  out << "  found                            value" << (search.is_design ? "" : "   standard deviation")
      << "  number of the scene\n";
  for (const SearchedNumber& number : found.numbers) {
    out << formatted("  %-20.20s  %16.10g  ", number.name.c_str(), number.value);
    if (!search.is_design) out << formatted("%19.6g  ", number.deviation);
    out << number.path << (number.is_held ? ", at its bound" : "") << "\n";
  }
  search.is_design ? print_constraints(out, search, found) : print_fit(out, search, found);
}

std::string lines_of(const std::vector<std::string>& texts) {
  std::string all;
  for (const std::string& text : texts) all += (all.empty() ? "" : "\n") + text;
  return all;
}

/// Writes texts and columns of numbers side by side.
void write_csv(const std::string& file, std::vector<std::string> heads, const std::vector<std::vector<CsvCell>>& texts,
               const std::vector<TableColumn>& columns) {
  for (const TableColumn& column : columns) heads.push_back(column.name);
  CsvTable table(file, heads, Appears::when_closed);
  for (std::size_t i = 0; i < columns.front().values.size(); ++i) {
    std::vector<CsvCell> row = texts.empty() ? std::vector<CsvCell>{} : texts[i];
    for (const TableColumn& column : columns) row.emplace_back(column.values[i]);
    table.add_row(row);
  }
  table.close();
}

/// Writes NAME.csv, NAME-steps.csv, and NAME.h5 with both.
void write_tables(const std::string& name, const SearchParameters& search, const FoundScene& found) {
  std::vector<TableColumn> numbers = {{"start"}, {"value"}, {"standard deviation"}, {"at least"}, {"at most"}};
  std::vector<TableColumn> steps = {{"objective"}, {"gradient"}, {"change"}, {"violation"}};
  std::vector<std::vector<CsvCell>> texts;
  std::vector<std::string> names, paths, wanted;
  const auto add = [](std::vector<TableColumn>& to, const std::vector<double>& row) {
    for (std::size_t i = 0; i < row.size(); ++i) to[i].values.push_back(row[i]);
  };
  const std::size_t n = found.numbers.size();
  for (std::size_t i = 0; i < n; ++i) {
    const SearchedNumber& one = found.numbers[i];
    add(numbers, {one.start, one.value, one.deviation, *one.at_least, *one.at_most});
    texts.push_back({one.name, one.path});
    names.push_back(one.name);
    paths.push_back(one.path);
    steps.push_back({one.name});
  }
  for (std::size_t i = 0; i < n && !found.covariance.empty(); ++i) {
    TableColumn& column = numbers.emplace_back(TableColumn{"covariance with " + names[i]});
    for (std::size_t j = 0; j < n; ++j) column.values.push_back(found.covariance[j * n + i]);
  }
  for (const SearchStep& step : found.steps) {
    std::vector<double> row = {step.objective, step.gradient, step.step, step.violation};
    row.insert(row.end(), step.unknowns.begin(), step.unknowns.end());
    add(steps, row);
  }
  write_csv(name + ".csv", {"parameter", "number"}, texts, numbers);
  write_csv(name + "-steps.csv", {}, {}, steps);
  for (const WantedQuantity& one : search.wanted) wanted.push_back(one.name);
  for (std::size_t i = 0; i < steps.size(); ++i)  // names may be invalid in HDF5
    steps[i].name = "steps/" + (i < 4 ? steps[i].name : std::to_string(i - 4));
  for (std::size_t i = 5; i < numbers.size(); ++i) numbers[i].name = "covariance/" + std::to_string(i - 5);
  numbers.insert(numbers.end(), steps.begin(), steps.end());
  numbers.push_back({"wanted", found.values});
  write_table_file(name + ".h5", numbers,
                   {{"names", lines_of(names)}, {"numbers", lines_of(paths)}, {"wanted", lines_of(wanted)}}, "found");
}

/// Compares the end of the run with the continued equilibrium: the path from the unloaded structure may lead elsewhere.
void compare_end(Application& app, const SearchParameters& search, const FoundScene& found) {
  app.watch = [&app, search, values = found.values, sizes = found.sizes, before = app.watch](const Simulation& run,
                                                                                             const StepReport& step) {
    if (before) before(run, step);
    if (!run.is_end_of_path(step.load_factor)) return;
    const std::vector<double> all = values_of(app.quantities, run);
    for (std::size_t k = 0; k < values.size(); ++k) {
      const WantedQuantity& wanted = search.wanted[k];
      if (wanted.load_case != app.load_case) continue;
      for (std::size_t i = 0; i < all.size(); ++i)
        if (app.quantities.columns()[i].name == wanted.quantity)
          app.summary.check_absolute(search.list + " / " + wanted.name, all[i], values[k],
                                     kSameState * std::max({std::abs(values[k]), sizes[k], wanted.deviation}),
                                     "equilibrium of the list \"" + search.list + "\", carried along with its numbers");
    }
  };
}

void tell(Application& app, const SearchParameters& search, const FoundScene& found) {
  const auto n = static_cast<std::ptrdiff_t>(found.numbers.size());
  for (std::ptrdiff_t i = 0; i < n; ++i) {
    const SearchedNumber& one = found.numbers[static_cast<std::size_t>(i)];
    app.summary.found_numbers.push_back({one.name, one.path, one.start, one.value, one.deviation});
    if (!found.covariance.empty())
      app.summary.found_numbers.back().covariance.assign(found.covariance.begin() + i * n,
                                                         found.covariance.begin() + (i + 1) * n);
  }
  print_found(app.out(), search, found);
  for (const std::string& text : found.remarks) app.warn(text);
}

}  // namespace

bool take_found_numbers(Application& app, const std::filesystem::path& stem) {
  if (!app.search) return true;
  const SearchParameters search = *app.search;
  const ListSpec& root = mixbeam_root_spec();
  const std::string name = stem.string() + "-" + lower_case(search.list), file = name + ".xml";
  const auto imported = app.xml.source.files();
  if (!stem.empty()) {
    for (const char* ending : {".xml", ".csv", ".h5", "-steps.csv"}) require_no_input(name + ending);
    copy_imported(app.xml.source, stem.parent_path(), search.list);
  }
  if (!app.quiet) print_head(app.out(), search);
  const FoundScene found = search_scene(app, root, [&](const SearchStep& step) {
    if (!app.quiet) print_step(app.out(), search, step);
  });
  tell(app, search, found);
  if (!stem.empty()) {
    replace_file(file, found.xml, false);
    write_tables(name, search, found);
    app.out() << "  scene with these numbers: " << file << "\n";
  }
  if (found.end == SearchEnd::stopped) return false;
  if (!found.failure.empty())
    throw ConvergenceError(search.list + ": " + found.failure +
                           (stem.empty() ? "" : ". The best numbers so far are in " + file) + ".");
  XmlParameters scene = parse_parameters(found.xml, stem.empty() ? app.xml.source.file() : file, root);
  scene.source.set_files(imported);
  const int threads = app.solver.threads;
  app.search.reset();
  read_scene_file(app, std::move(scene), mixbeam_definition(), root);
  app.solver.threads = threads;
  compare_end(app, search, found);
  return true;
}

void refuse_search(const Application& app) {
  if (app.search)
    throw app.xml.source.error({app.search->list},
                               "given, but this program solves scenes as they stand; allowed: mixbeam "
                               "run of this scene, and then the scene that it writes");
}

}  // namespace mixbeam
