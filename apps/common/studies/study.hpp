/// What programs that measure share: clocks, medians, tables of results.
#pragma once

#include "apps/common/run/application.hpp"
#include "apps/common/tables/csv_table.hpp"

#include <chrono>
#include <ctime>

namespace mixbeam {

/// From its making on.
class RunWatch {
 public:
  /// Wall time.
  double seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }
  /// Of all threads together: what others do on the machine does not lengthen it.
  double processor_seconds() const { return static_cast<double>(std::clock() - processor_start_) / CLOCKS_PER_SEC; }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point start_ = Clock::now();
  std::clock_t processor_start_ = std::clock();
};

/// Not a number where there are no values.
double median(std::vector<double> values);

/// An array of the list "Study".
template <class Value>
std::vector<Value> study_list(Application& app, const std::string& name) {
  return app.study().get<Teuchos::Array<Value>>(name).toVector();
}

/// A table that grows row by row: on the terminal, and complete in a CSV file.
class StudyTable {
 public:
  /// `file`: in the output folder. `shown`: so many of the first columns are printed; zero: none.
  StudyTable(const Application& app, const std::string& file, const std::vector<std::string>& columns,
             std::size_t shown = 0);
  void add_row(const std::vector<CsvCell>& cells);

 private:
  std::ostream& out_;
  std::optional<CsvTable> csv_;      ///< on the first rank
  std::vector<std::size_t> widths_;  ///< of the columns that are printed
};

/// What measurements were made with, and what else is to be known of them: machine.csv.
void write_machine(const Application& app, const std::vector<std::pair<std::string, std::string>>& more = {});

}  // namespace mixbeam
