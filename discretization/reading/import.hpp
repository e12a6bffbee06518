/// Points, members and entries of other lists of a scene from tables.
#pragma once

#include "discretization/parameters/source.hpp"
#include "discretization/parameters/spec.hpp"
#include "discretization/reading/scene_parts.hpp"
#include "discretization/scene/scene.hpp"
#include "discretization/text/csv_file.hpp"

#include <Teuchos_ParameterList.hpp>

#include <functional>
#include <map>
#include <string>
#include <vector>

namespace mixbeam {

class Variables;

/// Declaration of the list "Import".
ListSpec import_spec();

/// A table whose first record may name its columns; otherwise the columns are in the order of their declaration.
class ImportTable {
 public:
  /// Columns from `required` on may be absent. Throws InputError for an unknown column name.
  ImportTable(CsvFile file, std::vector<std::string> columns, std::size_t required, const ParameterSource& source);

  const ParameterSource& source() const { return *source_; }
  /// Calls `action` with each record except the names of columns. Mistakes of a record are kept in the source.
  void for_each(const std::function<void(const CsvRecord&)>& action) const;

  /// Text of a column of the record, empty if the record has no such cell.
  const std::string& cell(const CsvRecord& record, const std::string& column) const;
  /// Place of the cell of this column, `loads.csv:12:7`.
  std::string where(const CsvRecord& record, const std::string& column) const;
  /// Error at the cell of this column.
  InputError error(const CsvRecord& record, const std::string& column, const std::string& problem) const;
  /// Error in that column of the record in this line.
  InputError error(int line, const std::string& column, const std::string& problem) const;

 private:
  void read_names(const CsvRecord& record);
  std::size_t place(const std::string& column) const;

  CsvFile file_;
  const ParameterSource* source_;
  std::vector<std::string> columns_;
  std::size_t required_;
  std::map<std::string, std::size_t> place_;  ///< column -> index of its cell in a record
  bool has_names_ = false;
};

/// Texts of the tables that the list of a scene names, by these names: result files keep them, so that resuming needs
/// no other file. `path`: place of the scene below the root of `source`. Throws InputError when a file cannot be read.
std::map<std::string, std::string> read_imported_files(const Teuchos::ParameterList& scene_list,
                                                       const ParameterSource& source,
                                                       const ParameterPath& path = {"Scene"});

/// Adds entries to the lists "Sections", "Supports", "Joints", "Point Loads", ... of a scene that is not validated yet:
/// one for each line of the tables named by its list "Import". Records their places in `source`. Throws InputError.
void import_entries(Teuchos::ParameterList& scene_list, ParameterSource& source, const ParameterPath& path = {"Scene"});

/// Finder of sections that name a Profile, in the catalogue of the program and the table "Profiles File" of the list
/// "Import"; converts dimensions to the unit of length in `units` of the scene. Keeps a reference to the list.
ProfileFinder profile_finder(const Teuchos::ParameterList& scene_list, const InputPlace& scene,
                             const std::string& units);

/// The table that a parameter names: the text that the source has under this name, else a file relative to the folder
/// of the scene file. Columns as in ImportTable.
ImportTable import_table(const Teuchos::ParameterList& list, const std::string& parameter, const InputPlace& place,
                         const std::vector<std::string>& columns, std::size_t required);
/// Tables of points and of members of the list "Import".
ImportTable points_table(const Teuchos::ParameterList& list, const InputPlace& place);
ImportTable members_table(const Teuchos::ParameterList& list, const InputPlace& place);

/// A cell as a number, 0 if it is empty. Without `variables` formulas are refused.
double imported_number(const ImportTable& table, const CsvRecord& record, const std::string& column,
                       Variables* variables = nullptr);
/// Three cells of a record as a vector. Without `variables` formulas are refused. Mistakes are kept in the source;
/// numbers that differ from line to line replace them.
Vector3 imported_vector(const ImportTable& table, const CsvRecord& record, const std::array<std::string, 3>& columns,
                        Variables* variables = nullptr);

/// One record as a point, or as a member with the defaults of the list "Import".
Point imported_point(const ImportTable& table, const CsvRecord& record, Variables& variables);
Member imported_member(const ImportTable& table, const CsvRecord& record, const Teuchos::ParameterList& list,
                       Variables& variables);

}  // namespace mixbeam
