/// What a batch over the cases of one scene and one over the scenes of a folder share: table, checks and end.
#pragma once

#include "apps/common/session/command_line.hpp"
#include "apps/common/tables/csv_table.hpp"
#include "apps/mixbeam/batch_solver.hpp"

#include <array>
#include <map>

namespace mixbeam {

/// A column of the table of a batch.
struct CaseColumn {
  std::string name;
  std::function<CsvCell(std::size_t index)> cell;     ///< of a case in the CSV file; empty: not there
  std::function<double(std::size_t index)> number{};  ///< in the HDF5 file, likewise
};

/// The same number in both files.
template <class Value>
CaseColumn column_of_numbers(const std::string& name, const Value& value) {
  return {name, [value](std::size_t index) { return CsvCell(value(index)); },
          [value](std::size_t index) { return static_cast<double>(value(index)); }};
}

/// What a batch writes of its cases.
struct BatchTable {
  std::size_t before = 0;          ///< cases before the first row
  std::vector<CaseColumn> own;     ///< columns that tell cases apart
  std::vector<std::string> names;  ///< of what is written of all cases
  bool has_limits = true;
  std::map<std::string, std::string> texts;  ///< of the HDF5 file
};

class BatchRun {
 public:
  /// `ranks`: share out the cases, each of which is solved by one of them; the application is that of its rank alone.
  BatchRun(Application& app, const Communicator& ranks) : app_(app), ranks_(ranks) {}
  virtual ~BatchRun() = default;

  virtual void solve() = 0;
  /// With these results, which are all of it or those so far.
  virtual BatchTable table(const std::vector<CaseResult>& results) const = 0;
  virtual std::string name_of_case(std::size_t index) const = 0;
  virtual const CaseQuantities& quantities_of(std::size_t index) const = 0;
  /// Place of one of BatchTable::names among the quantities of a case; behind the last: it has no such quantity.
  virtual std::size_t place_of(std::size_t name, std::size_t index) const = 0;
  /// Compares cases with expected values, or says why it does not.
  virtual void check_expected() = 0;
  const std::vector<CaseResult>& results() const { return results_.all(); }
  /// See CaseResults::so_far().
  std::vector<CaseResult> results_so_far() const { return results_.so_far(); }
  bool interrupted() const { return interrupted_; }

 protected:
  /// Where the cases of this rank are solved; `all`: to the last one.
  void gather(bool all) { interrupted_ = !results_.gather(*ranks_, app_.summary, all); }

  Application& app_;
  Communicator ranks_;
  CaseResults results_;
  bool interrupted_ = false;
};

/// Solves a batch, which `read` makes when the ranks have parted, and writes <output>/<name>-batch[-rows].csv and .h5,
/// with one row for each case that was tried. Counts how the cases end, writes the summary, prints what failed and the
/// last lines. Returns the exit code. Throws ConvergenceError where cases failed.
int run_batch(Application& app, const CommandLine& line, const Communicator& ranks, const std::string& name,
              const std::function<std::unique_ptr<BatchRun>()>& read);

/// Throws InputError where --rows names more than there is.
void require_rows(const std::array<int, 2>& rows, std::size_t cases);

/// Reads all scenes of the folder that the command line names before the first is solved; then solves each by itself,
/// shared out over the ranks of mpirun: one row for each structure and load case. Returns the exit code. Throws
/// InputError for a scene that is refused, and as run_batch().
int structures_batch(const CommandLine& line);

}  // namespace mixbeam
