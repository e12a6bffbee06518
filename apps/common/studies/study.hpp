/// Common parts of study programs: start, parameters, clocks, medians, tables of results.
#pragma once

#include "apps/common/run/application.hpp"
#include "apps/common/tables/csv_table.hpp"
#include "apps/common/tables/table_printer.hpp"

#include <array>
#include <chrono>
#include <ctime>
#include <limits>

namespace mixbeam {

/// Measures the time since its construction.
class RunWatch {
 public:
  /// Wall time.
  double seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }
  /// Processor time of all threads together: other work on the machine does not lengthen it.
  double processor_seconds() const { return static_cast<double>(std::clock() - processor_start_) / CLOCKS_PER_SEC; }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point start_ = Clock::now();
  std::clock_t processor_start_ = std::clock();
};

/// Median; NaN without values.
double median(std::vector<double> values);

/// Parameters of the list "Study": a whole number from `least` to `most`, an array of them, one of positive numbers.
ParameterSpec count(const std::string& name, int by_default, double most, const std::string& meaning, int least = 1);
ParameterSpec counts(const std::string& name, const std::vector<int>& by_default, double most,
                     const std::string& meaning, int least = 1);
ParameterSpec sizes(const std::string& name, const std::vector<double>& by_default, double most,
                    const std::string& meaning);
inline constexpr double kNoLimit = std::numeric_limits<double>::infinity();

/// A number of the list "Study"; an array of it.
inline int study_number(Application& app, const std::string& name) { return app.study().get<int>(name); }
template <class Value>
std::vector<Value> study_list(Application& app, const std::string& name) {
  return app.study().get<Teuchos::Array<Value>>(name).toVector();
}

/// Splits "one,two" into words: columns of a table.
std::vector<std::string> words(const std::string& text);

/// A table that grows row by row: on the terminal, and complete in a CSV file.
class StudyTable {
 public:
  /// `file`: in the output folder; empty: none. `shown`: number of leading columns to print.
  StudyTable(const Application& app, const std::string& file, const std::vector<std::string>& columns,
             std::size_t shown = 0);
  void add_row(const std::vector<CsvCell>& cells);

 private:
  std::ostream& out_;
  std::optional<CsvTable> csv_;      ///< on the first rank
  std::vector<std::size_t> widths_;  ///< of the columns that are printed
};

/// Runs the program of this name: `run` computes the study declared by `study`. See ApplicationDefinition.
int run_study(int argc, char** argv, const std::string& name, const std::string& purpose, const ListSpec& study,
              const std::function<void(Application&)>& run);

/// Checks a value against the printed digits of a source, for a table of both; an empty text: not compared.
ComparedValue compared(Application& app, const std::string& name, double own, const std::string& printed,
                       const std::string& source);

/// A table of a paper: three printed numbers for an order and a number of elements.
struct PaperTable {
  struct Row {
    int order, elements;
    std::array<std::string, 3> printed;
  };
  std::string source;
  std::vector<Row> rows;
  int figures = 0;  ///< significant digits shown in the paper; 0: all of `rows`

  /// Texts of a row; empty if the paper has none.
  std::array<std::string, 3> row(int order, int elements) const;
};

/// Calls compared() for three components, named before + "1" + after, ...
std::vector<ComparedValue> compared(Application& app, const std::string& before, const std::string& after,
                                    const Vector3& own, const std::array<std::string, 3>& printed,
                                    const std::string& source);

/// Throws InputError with the place unless the scene has a point of this name, which the study reports.
void require_point(const Application& app, const std::string& name);

/// Solves in `steps` equal load steps per stage, quietly; calls `observer` after each.
Simulation solve_in_steps(Application& app, const Scene& scene, int steps, const RunObserver& observer = {});

/// Writes machine.csv: machine and conditions of the measurements.
void write_machine(const Application& app, const std::vector<std::pair<std::string, std::string>>& more = {});

}  // namespace mixbeam
