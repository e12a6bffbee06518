/// Tables as text: comma, semicolon or tabulator between cells.
#pragma once

#include "discretization/text/errors.hpp"

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace mixbeam {

struct CsvRecord {
  int line = 0;                      ///< where it begins
  std::vector<std::string> cells{};  ///< without blanks around them and without quotes
  std::vector<int> columns{};        ///< where each cell begins: characters from 1
};

/// A file of records, one per line. Cells may stand in double quotes (a quote inside is doubled); empty lines and lines
/// that begin with # do not count; a byte order mark and any line ends are understood. The separator is the first of
/// semicolon, tabulator, comma that the first record contains.
class CsvFile {
 public:
  /// Reads the file. Throws InputError if it cannot be read or is not text in UTF-8.
  explicit CsvFile(const std::string& path);
  /// For a text that is there already; `path` appears in messages.
  CsvFile(std::string path, std::string text);

  /// Calls `action` with every record in turn. Throws InputError for quotes that do not match.
  void for_each(const std::function<void(const CsvRecord&)>& action) const;

  /// `members.csv:12:7`: a cell, or the start of the record if it has fewer.
  std::string where(const CsvRecord& record, std::size_t cell) const;
  /// `members.csv:12:7: <problem>`, and the line with a mark below the place.
  InputError error(int line, int column, const std::string& problem) const;
  InputError error(const CsvRecord& record, std::size_t cell, const std::string& problem) const;
  /// The record that begins in this line.
  CsvRecord record_at(int line) const;

 private:
  void prepare();
  std::string where(int line, int column) const {
    return path_ + ":" + std::to_string(line) + ":" + std::to_string(column);
  }

  std::string path_;
  std::string text_;
};

}  // namespace mixbeam
