/// CSV files for plots and spreadsheets: one header line, one line per row, numbers that read back bit for bit.
#pragma once

#include "discretization/results/disk_file.hpp"

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace mixbeam {

/// One entry of a row, made from a number or a text. Floating-point numbers take the shortest decimal text (at most 17
/// significant digits) that reads back as the same double, whatever the locale; "nan", "inf" and "-inf" as Python
/// reads.
struct CsvCell {
  CsvCell(double value);
  CsvCell(int value) : text(std::to_string(value)) {}
  CsvCell(long value) : text(std::to_string(value)) {}
  CsvCell(std::size_t value) : text(std::to_string(value)) {}
  CsvCell(const char* value) : CsvCell(std::string(value)) {}
  CsvCell(const std::string& value);  ///< quoted when it holds a comma, a quote or a line end

  std::string text;
};

/// Writes a CSV file row by row; each row reaches the file at once. Errors are FileError with path and reason.
class CsvTable {
 public:
  /// Creates the file, and its folders where they are missing; replaces a file of that name.
  CsvTable(const std::filesystem::path& path, const std::vector<std::string>& columns, Appears when = Appears::at_once);

  /// Appends a row; std::invalid_argument unless it has one cell for each column.
  void add_row(const std::vector<CsvCell>& cells);
  /// Waits until the file is on the disk. Without it a table that appears when it is closed is removed again.
  void close() { file_.close(); }

 private:
  void write_line(const std::vector<CsvCell>& cells);

  std::filesystem::path path_;
  std::size_t columns_;
  TextFile file_;
};

}  // namespace mixbeam
