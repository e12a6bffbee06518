/// Tables as text: comma, semicolon or tabulator between cells.
#pragma once

#include "discretization/text/errors.hpp"

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace mixbeam {

struct CsvRecord {
  int line = 0;                      ///< number of its first line
  std::vector<std::string> cells{};  ///< without surrounding blanks and quotes
  std::vector<int> columns{};        ///< of the first character of each cell, from 1
};

/// File of records, one per line. Cells may be enclosed in double quotes (a quote inside is doubled); empty lines and
/// lines that begin with # are skipped; a byte order mark and any line ends are accepted. The separator is the first of
/// semicolon, tabulator, comma that the first record contains.
class CsvFile {
 public:
  /// Reads the file. Throws InputError if it cannot be read or is not text in UTF-8.
  explicit CsvFile(const std::string& path);
  /// Takes a text that was read already; `path` appears in messages.
  CsvFile(std::string path, std::string text);

  /// Calls `action` with every record in turn. Throws InputError for unmatched quotes.
  void for_each(const std::function<void(const CsvRecord&)>& action) const;

  /// Place of a cell, `members.csv:12:7`; that of the record if it has fewer cells.
  std::string where(const CsvRecord& record, std::size_t cell) const;
  /// `members.csv:12:7: <problem>`, and the line with a mark below the place.
  InputError error(int line, int column, const std::string& problem) const;
  InputError error(const CsvRecord& record, std::size_t cell, const std::string& problem) const;
  /// Record that begins in this line; without cells if there is none.
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
