/// A table as an HDF5 file: one dataset for each column.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace mixbeam {

/// A column; a "/" in its name makes groups.
struct TableColumn {
  std::string name{};
  std::vector<double> values{};
  std::function<std::vector<double>()> later{};  ///< computes them, for tables too large for memory
};

/// Replaces a file of that name. `texts`: datasets beside `group`, which holds the columns. Throws ResultFileError.
void write_table_file(const std::filesystem::path& path, const std::vector<TableColumn>& columns,
                      const std::map<std::string, std::string>& texts, const std::string& group = "columns");

}  // namespace mixbeam
