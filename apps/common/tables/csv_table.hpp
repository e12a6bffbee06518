/// CSV files for plots and spreadsheets: one header line, one line per row; numbers are read back bit for bit.
#pragma once

#include "discretization/results/disk_file.hpp"

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace mixbeam {

/// One cell, made from a number or a text. Floating-point numbers are written as the shortest decimal text (at most 17
/// significant digits) that is read back as the same double, in any locale; otherwise "nan", "inf", "-inf" as in
/// Python.
struct CsvCell {
  CsvCell(double value);
  CsvCell(int value) : text(std::to_string(value)) {}
  CsvCell(long value) : text(std::to_string(value)) {}
  CsvCell(std::size_t value) : text(std::to_string(value)) {}
  CsvCell(const char* value) : CsvCell(std::string(value)) {}
  CsvCell(const std::string& value);  ///< quoted if it contains a comma, a quote or a line end

  std::string text;
};

/// Writes a CSV file row by row, unbuffered. Throws FileError with path and reason.
class CsvTable {
 public:
  /// Creates the file and missing folders; replaces an existing file.
  CsvTable(const std::filesystem::path& path, const std::vector<std::string>& columns, Appears when = Appears::at_once);

  /// Appends a row; throws std::invalid_argument unless it has one cell per column.
  void add_row(const std::vector<CsvCell>& cells);
  /// Waits until the file is on disk. Without it, a table that appears on closing is discarded.
  void close() { file_.close(); }

 private:
  void write_line(const std::vector<CsvCell>& cells);

  std::filesystem::path path_;
  std::size_t columns_;
  TextFile file_;
};

}  // namespace mixbeam
