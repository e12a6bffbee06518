#include "discretization/reading/import.hpp"

#include "discretization/parameters/access.hpp"
#include "discretization/reading/read_scene.hpp"
#include "discretization/scene/limits.hpp"
#include "discretization/text/message_text.hpp"
#include "discretization/text/nearest_name.hpp"
#include "discretization/text/number_text.hpp"
#include "discretization/text/result_names.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <utility>

namespace mixbeam {
namespace {

const std::string kNameColumn = "name";
const std::string kPointsFile = "Points File", kMembersFile = "Members File";
constexpr int kLargestOrder = 8;

std::string lower_case(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

std::filesystem::path beside_scene(const std::string& name, const ParameterSource& source) {
  return std::filesystem::path(source.file()).parent_path() / name;
}

std::string resolved(const Teuchos::ParameterList& list, const std::string& parameter, const ParameterSource& source,
                     const ParameterPath& path) {
  const auto& name = list.get<std::string>(parameter);
  const std::filesystem::path file = beside_scene(name, source);
  std::error_code failure;
  if (std::filesystem::is_regular_file(file, failure)) return file.string();
  throw source.error(child(path, parameter), "value \"" + excerpt(name) + "\": there is no file \"" +
                                                 excerpt(file.string()) +
                                                 "\"; allowed: a file, relative to the folder of the scene");
}

CsvFile table_of(const Teuchos::ParameterList& list, const std::string& parameter, const ParameterSource& source,
                 const ParameterPath& path) {
  const auto& name = list.get<std::string>(parameter);
  const auto kept = source.files().find(name);
  if (kept == source.files().end()) return CsvFile(resolved(list, parameter, source, path));
  return {beside_scene(name, source).string(), kept->second};
}

std::string imported_name(const ImportTable& table, const CsvRecord& record, const std::string& column) {
  const std::string& name = table.cell(record, column);
  if (name.empty()) throw table.error(record, column, "missing " + column + "; allowed: a name");
  const bool has_control = std::any_of(name.begin(), name.end(), [](unsigned char c) { return c < ' '; });
  if (has_control) throw table.error(record, column, "value \"" + excerpt(name) + "\" has control characters");
  const Problem problem = result_name_problem(name);
  if (!problem.empty()) throw table.error(record, column, problem);
  return name;
}

double imported_coordinate(const ImportTable& table, const CsvRecord& record, const std::string& column) {
  double value = 0.0;
  const Problem problem = parse_number(table.cell(record, column), value);
  if (!problem.empty()) throw table.error(record, column, column + ": " + problem);
  if (std::abs(value) <= kLargestCoordinate) return value;  // false for nan
  throw table.error(record, column,
                    column + ": value " + shortest(value) + "; allowed: up to " + shortest(kLargestCoordinate));
}

int imported_count(const ImportTable& table, const CsvRecord& record, const std::string& column, int absent, int most) {
  const std::string& text = table.cell(record, column);
  if (text.empty()) return absent;
  int value = 0;
  const Problem problem = parse_number(text, value);
  if (!problem.empty()) throw table.error(record, column, column + ": " + problem);
  if (value >= 1 && value <= most) return value;
  throw table.error(record, column,
                    column + ": value " + std::to_string(value) + "; allowed: 1 to " + std::to_string(most));
}

}  // namespace

ListSpec import_spec() {
  ListSpec spec(
      "Points and lines from tables (CSV), beside those of Points and Members. Cells are separated by commas, "
      "semicolons or tabulators; lines that begin with # do not count; a first line may name the columns, which may "
      "then stand in any order.");
  spec.add(text(kPointsFile).means("Table of points: name, x, y, z; relative to the folder of the scene."));
  spec.add(text(kMembersFile)
               .means("Table of straight members: name, start, end, section, order, elements; empty or absent cells of "
                      "the last three take the values below."));
  spec.add(text("Section").means("Section of the members whose record names none."));
  spec.add(integer("Order").at_least(1).at_most(kLargestOrder).by_default(2).means("Order of their elements."));
  spec.add(integer("Elements").at_least(1).at_most(kMostElements).by_default(1).means("Number of their elements."));
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
    if (texts.count(name) == 0) texts[name] = text_of_table(resolved(list, parameter, source, child(path, "Import")));
  }
  return texts;
}

ImportTable points_table(const Teuchos::ParameterList& list, const ParameterSource& source, const ParameterPath& path) {
  return {table_of(list, kPointsFile, source, path), {kNameColumn, "x", "y", "z"}, 4};
}

ImportTable members_table(const Teuchos::ParameterList& list, const ParameterSource& source,
                          const ParameterPath& path) {
  return {table_of(list, kMembersFile, source, path), {kNameColumn, "start", "end", "section", "order", "elements"}, 3};
}

Point imported_point(const ImportTable& table, const CsvRecord& record) {
  Point point;
  point.name = imported_name(table, record, kNameColumn);
  point.position = {imported_coordinate(table, record, "x"), imported_coordinate(table, record, "y"),
                    imported_coordinate(table, record, "z")};
  return point;
}

Member imported_member(const ImportTable& table, const CsvRecord& record, const Teuchos::ParameterList& list) {
  Member member;
  member.name = imported_name(table, record, kNameColumn);
  member.start_point = imported_name(table, record, "start");
  member.end_point = imported_name(table, record, "end");
  member.section = table.cell(record, "section");
  if (member.section.empty()) member.section = get_text_or_empty(list, "Section");
  if (member.section.empty())
    throw table.error(record, "section", "missing section; allowed: a name here, or \"Section\" of \"Import\"");
  member.order = imported_count(table, record, "order", list.get<int>("Order"), kLargestOrder);
  member.elements = imported_count(table, record, "elements", list.get<int>("Elements"), kMostElements);
  member.keeps_order = is_given(list, "Order") || !table.cell(record, "order").empty();
  member.keeps_elements = is_given(list, "Elements") || !table.cell(record, "elements").empty();
  return member;
}

}  // namespace mixbeam
