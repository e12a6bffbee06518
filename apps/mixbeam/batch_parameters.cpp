#include "apps/mixbeam/batch_cases.hpp"

#include "discretization/parameters/binding.hpp"
#include "discretization/parameters/spec.hpp"
#include "discretization/parameters/value.hpp"
#include "discretization/text/csv_file.hpp"
#include "discretization/text/message_text.hpp"
#include "discretization/text/number_text.hpp"

#include <cmath>
#include <filesystem>
#include <limits>
#include <memory>

namespace mixbeam {

namespace {

const ParameterPath kList = {"Batch"};
constexpr int kMostCases = 10'000'000;  ///< as for elements of a scene: bounds memory after typing errors

/// One direction of the grid.
struct GridAxis {
  std::string parameter;
  double first = 0.0, last = 0.0;
  int count = 2;
  bool logarithmic = false;
  std::vector<double> values{};
};

BoundList<GridAxis> vary_parameters() {
  BoundList<GridAxis> vary("One direction of the grid.");
  vary.bind(&GridAxis::parameter, text("Parameter").required(),
            "Path of a number of the scene: Point Loads/tip/Force[1].");
  vary.bind(&GridAxis::first, real("First").required(), "Its value in the first case.");
  vary.bind(&GridAxis::last, real("Last").required(), "Its value in the last case.");
  vary.bind(&GridAxis::count, integer("Count").at_least(2).at_most(kMostCases).required(), "Number of values.");
  vary.bind(&GridAxis::logarithmic, text("Spacing").by_default(),
            "Equal differences, or equal ratios between values of one sign.",
            {{"linear", false}, {"logarithmic", true}});
  return vary;
}

GridAxis read_axis(const Teuchos::ParameterList& list, const ParameterSource& source, const ParameterPath& path) {
  GridAxis axis = vary_parameters().read(list);
  const double first = axis.first, last = axis.last;
  if (axis.logarithmic && !(first * last > 0.0))
    throw source.error(child(path, "Spacing"), "value \"logarithmic\" from " + shortest(first) + " to " +
                                                   shortest(last) + "; allowed: values of one sign, none of them zero");
  for (int i = 0; i < axis.count; ++i) {
    const double t = static_cast<double>(i) / (axis.count - 1);
    axis.values.push_back(axis.logarithmic ? first * std::pow(last / first, t) : (1.0 - t) * first + t * last);
  }
  axis.values.front() = first;
  axis.values.back() = last;
  return axis;
}

/// Reads a grid; the first list of the file varies slowest.
void read_grid(const Teuchos::ParameterList& list, const ParameterSource& source, Batch& batch) {
  std::vector<GridAxis> axes;
  double cases = 1.0;
  for (const std::string& name : names_of(list)) {
    const ParameterPath path = child(child(kList, "Vary"), name);
    axes.push_back(read_axis(list.sublist(name), source, path));
    batch.columns.push_back({axes.back().parameter, [&source, path](const std::string& problem) {
                               return source.error(child(path, "Parameter"), problem);
                             }});
    cases *= static_cast<double>(axes.back().values.size());
  }
  if (cases > kMostCases)
    throw source.error(child(kList, "Vary"), shortest(cases) + " cases; allowed: up to " + std::to_string(kMostCases));
  const std::size_t count = static_cast<std::size_t>(cases);
  batch.values.reserve(count * axes.size());
  for (std::size_t index = 0; index < count; ++index) {
    std::size_t inner = count, rest = index;
    for (const GridAxis& axis : axes) {
      inner /= axis.values.size();
      batch.values.push_back(axis.values[rest / inner]);
      rest %= inner;
    }
  }
}

/// Reads a table record by record; the first one names the columns.
class TableReader {
 public:
  TableReader(std::shared_ptr<const CsvFile> table, Batch& batch) : table_(std::move(table)), batch_(batch) {
    table_->for_each(
        [this](const CsvRecord& record) { batch_.columns.empty() ? read_head(record) : read_case(record); });
  }

 private:
  void read_head(const CsvRecord& record) {
    for (std::size_t i = 0; i < record.cells.size(); ++i) {
      for (const BatchColumn& other : batch_.columns)
        if (other.parameter == record.cells[i])
          throw table_->error(record, i,
                              "column \"" + excerpt(record.cells[i]) + "\" for the second time; allowed: once");
      batch_.columns.push_back({record.cells[i], refusal(record, i)});
    }
  }
  void read_case(const CsvRecord& record) {
    const std::size_t columns = batch_.columns.size();
    if (record.cells.size() != columns)
      throw table_->error(record, columns,
                          std::to_string(record.cells.size()) + " cells; allowed: " + std::to_string(columns) +
                              ", as many as the first line has");
    for (std::size_t i = 0; i < columns; ++i) {
      double value = std::numeric_limits<double>::quiet_NaN();
      const std::string& cell = record.cells[i];
      const bool is_plain = !cell.empty() && !is_formula(cell);
      if (is_formula(cell)) batch_.formulas.push_back({batch_.size(), i, cell, refusal(record, i)});
      if (const Problem problem = is_plain ? parse_number(cell, value) : ""; !problem.empty())
        throw table_->error(record, i, problem);
      if (is_plain && std::isnan(value))
        throw table_->error(record, i, "value " + excerpt(cell) + "; allowed: a number");
      batch_.values.push_back(value);
    }
    batch_.lines.push_back(record.line);
  }

  Variables::Refusal refusal(const CsvRecord& record, std::size_t cell) const {
    return [table = table_, line = record.line, column = record.columns[cell]](const std::string& problem) {
      return table->error(line, column, problem);
    };
  }

  std::shared_ptr<const CsvFile> table_;
  Batch& batch_;
};

void read_table(const std::string& name, const ParameterSource& source, Batch& batch) {
  const std::string path = (std::filesystem::path(source.file()).parent_path() / name).string();
  std::error_code failure;
  if (!std::filesystem::is_regular_file(path, failure))
    throw source.error(child(kList, "Table"), "value \"" + excerpt(name) + "\": there is no file \"" + excerpt(path) +
                                                  "\"; allowed: a file, relative to the folder of the scene");
  batch.table = path;
  const TableReader reader(std::make_shared<const CsvFile>(path), batch);
  if (batch.size() == 0)
    throw InputError(path + ":1: no case; allowed: a line of parameters' paths, then one line per case");
}

}  // namespace

void Batch::keep(std::size_t first, std::size_t count) {
  const auto cut = [](auto& all, std::size_t from, std::size_t number) {
    all.erase(all.begin() + static_cast<std::ptrdiff_t>(from + number), all.end());
    all.erase(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(from));
  };
  cut(values, first * columns.size(), count * columns.size());
  if (!lines.empty()) cut(lines, first, count);
  std::vector<Formula> kept;
  for (Formula& formula : formulas)
    if (formula.index >= first && formula.index < first + count) {
      formula.index -= first;
      kept.push_back(std::move(formula));
    }
  formulas = std::move(kept);
  before += first;
}

std::string Batch::name_of_case(std::size_t index) const {
  const std::string number = "case " + std::to_string(before + index + 1);
  return lines.empty() ? number : table + ":" + std::to_string(lines[index]) + ": " + number;
}

ListSpec batch_spec() {
  ListSpec batch("Cases of one scene that mixbeam batch solves together, by Table or by Vary; mixbeam run ignores it.");
  batch.add(text("Table").means(
      "CSV file, relative to the folder of the scene: its first line names parameters of the scene by their paths "
      "(Sections/steel/EI2, Points/tip[0], Expected/deflection/Value), each further line has their values in one "
      "case."));
  batch.add(choice("Output", {"followed", "expected", "quantities"})
                .by_default(std::string("followed"))
                .means("Output of each case: displacement and rotation of the points that are supported or "
                       "loaded and the reactions of supports, the quantities of the list Expected, or those of the "
                       "list Quantities."));
  batch.add_list("Vary",
                 ListSpec("A grid: every value of one direction with every value of the others.")
                     .with_named_lists("direction", vary_parameters().spec, 1),
                 Presence::optional);
  return batch;
}

Batch read_batch(const Teuchos::ParameterList& list, const ParameterSource& source) {
  Batch batch;
  if (list.isParameter("Table") == list.isSublist("Vary"))
    throw source.error(kList, std::string(list.isSublist("Vary") ? "both" : "neither") +
                                  " of \"Table\" and \"Vary\"; allowed: one of them");
  if (list.isSublist("Vary"))
    read_grid(list.sublist("Vary"), source, batch);
  else
    read_table(list.get<std::string>("Table"), source, batch);
  const auto& output = list.get<std::string>("Output");
  if (output == "expected") batch.output = BatchOutput::expected;
  if (output == "quantities") batch.output = BatchOutput::quantities;
  return batch;
}

}  // namespace mixbeam
