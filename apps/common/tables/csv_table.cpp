#include "apps/common/tables/csv_table.hpp"

#include "discretization/text/number_text.hpp"

#include <cmath>
#include <stdexcept>
#include <system_error>

namespace mixbeam {
namespace {

std::string quoted(const std::string& value) {
  if (value.find_first_of(",\"\r\n") == std::string::npos) return value;
  std::string result = "\"";
  for (const char c : value) {
    if (c == '"') result += '"';
    result += c;
  }
  return result + "\"";
}

/// Creates the folder of a file.
const std::filesystem::path& in_its_folder(const std::filesystem::path& path) {
  std::error_code error;
  if (path.has_parent_path()) std::filesystem::create_directories(path.parent_path(), error);
  if (error) throw FileError("cannot create the folder " + path.parent_path().string() + ": " + error.message());
  return path;
}

}  // namespace

CsvCell::CsvCell(double value) : text(std::isnan(value) ? "nan" : shortest(value)) {}  // without the meaningless sign

CsvCell::CsvCell(const std::string& value) : text(quoted(value)) {}

CsvTable::CsvTable(const std::filesystem::path& path, const std::vector<std::string>& columns, Appears when)
    : path_(path), columns_(columns.size()), file_(in_its_folder(path), when) {
  write_line({columns.begin(), columns.end()});
}

void CsvTable::add_row(const std::vector<CsvCell>& cells) {
  if (cells.size() != columns_) {
    throw std::invalid_argument("a row of " + path_.string() + " has " + std::to_string(cells.size()) + " cells for " +
                                std::to_string(columns_) + " columns");
  }
  write_line(cells);
}

void CsvTable::write_line(const std::vector<CsvCell>& cells) {
  std::string line;
  for (const auto& cell : cells) line += (&cell == &cells.front() ? "" : ",") + cell.text;
  file_.append(line + '\n');
}

}  // namespace mixbeam
