#include "discretization/reading/import.hpp"

#include "discretization/parameters/validate.hpp"
#include "discretization/reading/scene_parts.hpp"
#include "discretization/scene/limits.hpp"
#include "discretization/text/message_text.hpp"
#include "discretization/text/number_text.hpp"
#include "discretization/text/result_names.hpp"
#include "discretization/text/text_file.hpp"

#include <algorithm>
#include <filesystem>
#include <utility>

namespace mixbeam {
namespace {

const std::string kNameColumn = "name";
const std::string kPointsFile = "Points File", kMembersFile = "Members File";

std::filesystem::path beside_scene(const std::string& name, const ParameterSource& source) {
  return std::filesystem::path(source.file()).parent_path() / name;
}

std::string resolved(const Teuchos::ParameterList& list, const std::string& parameter, const InputPlace& place) {
  const auto& name = list.get<std::string>(parameter);
  const std::filesystem::path file = beside_scene(name, place.source());
  std::error_code failure;
  if (std::filesystem::is_regular_file(file, failure)) return file.string();
  throw place[parameter].error("value \"" + excerpt(name) + "\": there is no file \"" + excerpt(file.string()) +
                               "\"; allowed: a file, relative to the folder of the scene");
}

CsvFile table_of(const Teuchos::ParameterList& list, const std::string& parameter, const InputPlace& place) {
  const auto& name = list.get<std::string>(parameter);
  const auto kept = place.source().files().find(name);
  if (kept == place.source().files().end()) return CsvFile(resolved(list, parameter, place));
  return {beside_scene(name, place.source()).string(), kept->second};
}

std::string imported_name(const ImportTable& table, const CsvRecord& record) {
  const std::string& name = table.cell(record, kNameColumn);
  const bool has_control = std::any_of(name.begin(), name.end(), [](unsigned char c) { return c < ' '; });
  if (has_control) throw table.error(record, kNameColumn, "value \"" + excerpt(name) + "\" has control characters");
  const Problem problem = result_name_problem(name);
  if (!problem.empty()) throw table.error(record, kNameColumn, problem);
  return name;
}

/// Of a cell that is not empty.
ParameterValue cell_value(const ImportTable& table, const CsvRecord& record, const ParameterSpec& spec) {
  const std::string column = lower_case(spec.name);
  ParameterValue value;
  Problem problem = parse_value(table.cell(record, column), spec.type, value);
  if (problem.empty()) problem = problem_of(value, spec);
  if (!problem.empty()) throw table.error(record, column, column + ": " + problem);
  return value;
}

/// Columns of the table of members: those that every record fills, then those with a default in the list "Import".
std::vector<std::string> member_columns(bool with_default) {
  std::vector<std::string> columns;
  for (const BoundParameter<Member>& parameter : member_parameters().parameters)
    if (parameter.is_column && parameter.column_default.empty() != with_default)
      columns.push_back(lower_case(parameter.spec.name));
  return columns;
}

std::string meaning_of_members_file() {
  static const std::vector<std::string> counts = {"none", "one", "two", "three", "four", "five", "six", "seven"};
  std::string text = "Table of straight members: " + kNameColumn;
  for (const bool with_default : {false, true})
    for (const std::string& column : member_columns(with_default)) text += ", " + column;
  return text + "; empty or absent cells of the last " + counts.at(member_columns(true).size()) +
         " take the values below.";
}

}  // namespace

ListSpec import_spec() {
  ListSpec spec(
      "Points and lines from tables (CSV), beside those of Points and Members. Cells are separated by commas, "
      "semicolons or tabulators; lines that begin with # do not count; a first line may name the columns, which may "
      "then stand in any order.");
  spec.add(text(kPointsFile), "Table of points: name, x, y, z; relative to the folder of the scene.");
  spec.add(text(kMembersFile), meaning_of_members_file());
  for (const BoundParameter<Member>& parameter : member_parameters().parameters) {
    if (parameter.column_default.empty()) continue;
    spec.add(parameter.spec.means(parameter.column_default));
  }
  return spec;
}

ImportTable::ImportTable(CsvFile file, std::vector<std::string> columns, std::size_t required)
    : file_(std::move(file)), columns_(std::move(columns)), required_(required) {
  for (std::size_t i = 0; i < columns_.size(); ++i) place_[columns_[i]] = i;
  bool first = true;
  file_.for_each([&](const CsvRecord& record) {
    const bool names = first && std::any_of(record.cells.begin(), record.cells.end(),
                                            [](const std::string& cell) { return lower_case(cell) == kNameColumn; });
    first = false;
    if (names) read_names(record);
  });
}

void ImportTable::read_names(const CsvRecord& record) {
  has_names_ = true;
  place_.clear();
  for (std::size_t i = 0; i < record.cells.size(); ++i) {
    const std::string column = lower_case(record.cells[i]);
    if (std::find(columns_.begin(), columns_.end(), column) == columns_.end()) {
      throw file_.error(record, i,
                        "value \"" + excerpt(record.cells[i]) +
                            "\" is not a column; allowed: " + quoted_list(columns_) + did_you_mean(column, columns_));
    }
    if (!place_.emplace(column, i).second)
      throw file_.error(record, i, "column \"" + column + "\" for the second time; allowed: once");
  }
  for (std::size_t i = 0; i < required_; ++i)
    if (place_.count(columns_[i]) == 0)
      throw file_.error(record, 0,
                        "no column \"" + columns_[i] + "\"; needed: " +
                            quoted_list({columns_.begin(), columns_.begin() + static_cast<int>(required_)}));
}

void ImportTable::for_each(const std::function<void(const CsvRecord&)>& action) const {
  bool skip = has_names_;
  const std::size_t most = has_names_ ? place_.size() : columns_.size();
  file_.for_each([&](const CsvRecord& record) {
    if (std::exchange(skip, false)) return;
    if (record.cells.size() > most) {
      throw file_.error(record, most,
                        "value \"" + excerpt(record.cells[most]) +
                            "\" is one cell too many; allowed: " + std::to_string(most) + " cells");
    }
    for (std::size_t i = 0; i < required_; ++i)
      if (cell(record, columns_[i]).empty())
        throw error(record, columns_[i], "missing \"" + columns_[i] + "\"; allowed: " + quoted_list(columns_));
    action(record);
  });
}

std::size_t ImportTable::place(const std::string& column) const {
  const auto found = place_.find(column);
  return found == place_.end() ? std::string::npos : found->second;
}

const std::string& ImportTable::cell(const CsvRecord& record, const std::string& column) const {
  static const std::string nothing;
  const std::size_t i = place(column);
  return i < record.cells.size() ? record.cells[i] : nothing;
}

InputError ImportTable::error(const CsvRecord& record, const std::string& column, const std::string& problem) const {
  return file_.error(record, place(column), problem);
}

InputError ImportTable::error(int line, const std::string& column, const std::string& problem) const {
  return error(file_.record_at(line), column, problem);
}

std::map<std::string, std::string> read_imported_files(const Teuchos::ParameterList& scene_list,
                                                       const ParameterSource& source, const ParameterPath& path) {
  std::map<std::string, std::string> texts;
  if (!scene_list.isSublist("Import")) return texts;
  const Teuchos::ParameterList& list = scene_list.sublist("Import");
  for (const std::string& parameter : {kPointsFile, kMembersFile}) {
    if (!list.isParameter(parameter)) continue;
    const auto& name = list.get<std::string>(parameter);
    if (texts.count(name) == 0)
      texts[name] = text_of_file(resolved(list, parameter, InputPlace(source, path)["Import"]), "a table");
  }
  return texts;
}

ImportTable points_table(const Teuchos::ParameterList& list, const InputPlace& place) {
  return {table_of(list, kPointsFile, place), {kNameColumn, "x", "y", "z"}, 4};
}

ImportTable members_table(const Teuchos::ParameterList& list, const InputPlace& place) {
  std::vector<std::string> columns = member_columns(false);
  columns.insert(columns.begin(), kNameColumn);
  const std::size_t required = columns.size();
  for (std::string& column : member_columns(true)) columns.push_back(std::move(column));
  return {table_of(list, kMembersFile, place), columns, required};
}

Point imported_point(const ImportTable& table, const CsvRecord& record) {
  const auto coordinate = [](const char* name) {
    return real(name).at_least(-kLargestCoordinate).at_most(kLargestCoordinate);
  };
  static const std::array<ParameterSpec, 3> coordinates = {coordinate("x"), coordinate("y"), coordinate("z")};
  Point point;
  point.name = imported_name(table, record);
  for (std::size_t i = 0; i < 3; ++i) point.position[i] = std::get<double>(cell_value(table, record, coordinates[i]));
  return point;
}

Member imported_member(const ImportTable& table, const CsvRecord& record, const Teuchos::ParameterList& list) {
  Member member;
  member.name = imported_name(table, record);
  for (const BoundParameter<Member>& parameter : member_parameters().parameters) {
    if (!parameter.is_column) continue;
    const std::string column = lower_case(parameter.spec.name);
    if (!table.cell(record, column).empty())
      parameter.give(member, cell_value(table, record, parameter.spec));
    else
      parameter.read(list, member);
  }
  return member;
}

}  // namespace mixbeam
