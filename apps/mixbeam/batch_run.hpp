/// Common parts of batches over the cases of a scene and over the scenes of a folder: table, checks and end.
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
  std::function<CsvCell(std::size_t index)> cell;     ///< value in the CSV file; empty: not in that file
  std::function<double(std::size_t index)> number{};  ///< value in the HDF5 file; likewise
};

/// A column with the same number in both files.
template <class Value>
CaseColumn column_of_numbers(const std::string& name, const Value& value) {
  return {name, [value](std::size_t index) { return CsvCell(value(index)); },
          [value](std::size_t index) { return static_cast<double>(value(index)); }};
}

/// Table of the cases of a batch.
struct BatchTable {
  std::size_t before = 0;          ///< number of cases before the first row
  std::vector<CaseColumn> own;     ///< columns that identify a case
  std::vector<std::string> names;  ///< columns with values of the cases
  bool has_limits = true;
  std::map<std::string, std::string> texts;  ///< texts in the HDF5 file
};

class BatchRun {
 public:
  /// `ranks`: divide the cases among them; each case is solved by one rank, with an application of its own.
  BatchRun(Application& app, const Communicator& ranks) : app_(app), ranks_(ranks) {}
  virtual ~BatchRun() = default;

  virtual void solve() = 0;
  /// Makes the table of all results, or of those so far.
  virtual BatchTable table(const std::vector<CaseResult>& results) const = 0;
  virtual std::string name_of_case(std::size_t index) const = 0;
  virtual const CaseQuantities& quantities_of(std::size_t index) const = 0;
  /// Index of one of BatchTable::names among the quantities of a case; their number if it has no such quantity.
  virtual std::size_t place_of(std::size_t name, std::size_t index) const = 0;
  /// Compares cases with expected values, or states why not.
  virtual void check_expected() = 0;
  const std::vector<CaseResult>& results() const { return results_.all(); }
  /// See CaseResults::so_far().
  std::vector<CaseResult> results_so_far() const { return results_.so_far(); }
  bool interrupted() const { return interrupted_; }

 protected:
  /// Gathers the results after this rank has solved its cases; `all`: none is left.
  void gather(bool all) { interrupted_ = !results_.gather(*ranks_, app_.summary, all); }

  Application& app_;
  Communicator ranks_;
  CaseResults results_;
  bool interrupted_ = false;
};

/// Solves a batch, which `read` creates after the ranks have been separated, and writes
/// <output>/<name>-batch[-rows].csv and .h5 with one row per attempted case. Writes the summary with counts of the
/// ends, prints failures and the last lines. Returns the exit code. Throws ConvergenceError if cases failed.
int run_batch(Application& app, const CommandLine& line, const Communicator& ranks, const std::string& name,
              const std::function<std::unique_ptr<BatchRun>()>& read);

/// Throws InputError if --rows exceeds the number of cases.
void require_rows(const std::array<int, 2>& rows, std::size_t cases);

/// Reads all scenes of the folder in the command line, then solves them one by one, divided among the ranks of mpirun:
/// one row per structure and load case. Returns the exit code. Throws InputError for a refused scene, otherwise as
/// run_batch().
int structures_batch(const CommandLine& line);

}  // namespace mixbeam
