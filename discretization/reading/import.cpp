#include "discretization/reading/import.hpp"

#include "discretization/parameters/validate.hpp"
#include "discretization/parameters/value.hpp"
#include "discretization/reading/blade_file.hpp"
#include "discretization/reading/read_scene.hpp"
#include "discretization/reading/variables.hpp"
#include "discretization/scene/limits.hpp"
#include "discretization/text/message_text.hpp"
#include "discretization/text/number_text.hpp"
#include "discretization/text/result_names.hpp"
#include "discretization/text/text_file.hpp"

#include <algorithm>
#include <filesystem>
#include <memory>
#include <utility>

namespace mixbeam {

extern const char* const kProfilesOfProgram;  // profiles.csv

namespace {

const std::string kNameColumn = "name";
const std::string kPointsFile = "Points File", kMembersFile = "Members File", kProfilesFile = "Profiles File";

const std::vector<std::string> kNumberColumns = {"x", "y", "z", "dx", "dy", "dz", "order", "elements"};

/// Lists whose entries a table may give, named by the parameter with " File" behind the name of the list.
const std::vector<std::string> kImportedLists = {"Sections",     "Supports",          "Joints",      "Point Loads",
                                                 "Point Masses", "Distributed Loads", "Eigenstrains"};

/// All parameters that name files of a scene: list, parameter.
std::vector<std::pair<std::string, std::string>> file_parameters() {
  std::vector<std::pair<std::string, std::string>> all = {
      {"Import", kPointsFile}, {"Import", kMembersFile}, {"Import", kProfilesFile}, {"Imperfection", kPointsFile}};
  for (const std::string& list : kImportedLists) all.emplace_back("Import", list + " File");
  return all;
}

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

/// Value of a cell that is not empty, a formula as written.
ParameterValue written_cell(const ImportTable& table, const CsvRecord& record, const ParameterSpec& spec) {
  const std::string column = lower_case(spec.name);
  ParameterValue value;
  Problem problem = parse_value(table.cell(record, column), spec.type, value);
  if (problem.empty() && !stands_for_number(value, spec)) problem = problem_of(value, spec);
  if (!problem.empty()) throw table.error(record, column, column + ": " + problem);
  return value;
}

/// Value of a cell that is not empty, with formulas evaluated.
ParameterValue cell_value(const ImportTable& table, const CsvRecord& record, const ParameterSpec& spec,
                          Variables* variables) {
  ParameterValue value = written_cell(table, record, spec);
  const std::string column = lower_case(spec.name);
  const auto refusal = [&](const std::string& problem) { return table.error(record, column, column + ": " + problem); };
  if (!stands_for_number(value, spec)) return value;
  if (variables != nullptr) value = variables->value(value, spec.type, refusal);
  const Problem problem = problem_of(value, spec);
  if (!problem.empty()) throw table.error(record, column, column + ": " + problem);
  return value;
}

/// Columns of the table of members: those that every record fills, or those with a default in the list "Import".
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

/// Parameter of an entry, or of a list inside it, that a column fills.
struct EntryColumn {
  std::string list{};  ///< inside the entry; empty: the entry itself
  ParameterSpec spec;
};

std::map<std::string, EntryColumn> entry_columns(const ListSpec& entry) {
  std::map<std::string, EntryColumn> columns;
  for (const ParameterSpec& parameter : entry.parameters)
    columns.emplace(lower_case(parameter.name), EntryColumn{"", parameter});
  for (const SublistSpec& inside : entry.sublists)
    for (const ParameterSpec& parameter : inside.list->parameters)
      columns.emplace(lower_case(parameter.name), EntryColumn{inside.name, parameter});
  return columns;
}

/// Adds an entry to `list` for each record.
void add_entries(const ImportTable& table, const std::map<std::string, EntryColumn>& columns, const ParameterPath& path,
                 Teuchos::ParameterList& list, ParameterSource& source) {
  table.for_each([&](const CsvRecord& record) {
    const std::string name = imported_name(table, record);
    if (list.isParameter(name))
      throw table.error(
          record, kNameColumn,
          "value \"" + excerpt(name) + "\" is in the list \"" + path.back() + "\" already; allowed: names that differ");
    Teuchos::ParameterList& entry = list.sublist(name);
    const ParameterPath place = child(path, name);
    source.record(place, table.where(record, kNameColumn));
    for (const auto& [column, target] : columns) {
      if (table.cell(record, column).empty()) continue;
      ParameterPath inside = place;
      if (!target.list.empty()) inside.push_back(target.list);
      Teuchos::ParameterList& holder = target.list.empty() ? entry : entry.sublist(target.list);
      inside.push_back(target.spec.name);
      source.record(inside, table.where(record, column));
      InputPlace(source, inside).attempt([&, &column = column, &target = target] {
        set_value(holder, target.spec.name, written_cell(table, record, target.spec));
      });
    }
  });
}

/// Adds the sections of a file of another program; false if the file is a table.
bool import_blade(const Teuchos::ParameterList& import, const InputPlace& place, Teuchos::ParameterList& sections) {
  const std::string parameter = "Sections File";
  const auto& name = import.get<std::string>(parameter);
  const auto kept = place.source().files().find(name);
  const std::string text =
      kept == place.source().files().end() ? text_of_file(resolved(import, parameter, place), "a table") : kept->second;
  if (blade_format(text) == BladeFormat::none) return false;
  const Teuchos::ParameterList read = sections_of_blade(text, beside_scene(name, place.source()).string());
  for (const std::string& section : names_of(read)) {
    if (sections.isParameter(section))
      throw place[parameter].error("section \"" + section +
                                   "\" is in the list \"Sections\" already; allowed: names that differ");
    sections.sublist(section) = read.sublist(section);
  }
  return true;
}

/// Units of length in millimetres, by their words in Units.
const std::vector<std::pair<std::string, double>> kMillimetres = {{"mm", 1.0},   {"cm", 10.0}, {"dm", 100.0},
                                                                  {"m", 1000.0}, {"in", 25.4}, {"ft", 304.8}};

double millimetres_of(const std::string& units, const InputPlace& place) {
  const std::string length = trimmed(units.substr(0, units.find(',')));
  std::vector<std::string> words;
  for (const auto& [word, size] : kMillimetres) {
    if (word == length) return size;
    words.push_back(word);
  }
  throw place.error("the catalogue is in mm, and \"Units\" of the scene " +
                    (units.empty() ? "is missing" : "has \"" + excerpt(length) + "\" as unit of length") +
                    "; allowed: " + quoted_list(words) + ", as in \"m, N\"");
}

/// Key of a profile: "IPE 300" and "ipe300" are one name.
std::string profile_key(const std::string& name) {
  std::string key = lower_case(name);
  key.erase(std::remove(key.begin(), key.end(), ' '), key.end());
  return key;
}

/// Profiles as lists of sections in millimetres.
struct Catalogue {
  Teuchos::ParameterList profiles{};
  ParameterSource source{"profiles.csv"};
  std::map<std::string, std::string> names{};  ///< by key

  void add(CsvFile file) {
    std::map<std::string, EntryColumn> columns;
    std::vector<std::string> column_names = {kNameColumn};
    const ListSpec section = section_spec();
    for (const std::string& name : profile_parameters()) {
      columns.emplace(lower_case(name), EntryColumn{"", *section.find_parameter(name)});
      column_names.push_back(lower_case(name));
    }
    const ImportTable table(std::move(file), column_names, 1, source);
    table.for_each([&](const CsvRecord& record) {
      const auto [known, is_new] =
          names.emplace(profile_key(table.cell(record, kNameColumn)), table.cell(record, kNameColumn));
      if (!is_new)
        throw table.error(
            record, kNameColumn,
            "profile \"" + excerpt(known->second) + "\" is in the catalogue already; allowed: names that differ");
    });
    source.collect([&] { add_entries(table, columns, {"Profiles"}, profiles, source); });
  }
};

const Catalogue& catalogue_of_program() {
  static const Catalogue catalogue = [] {
    Catalogue filled;
    filled.add(CsvFile("profiles.csv", kProfilesOfProgram));
    return filled;
  }();
  return catalogue;
}

}  // namespace

ListSpec import_spec() {
  ListSpec spec(
      "Points and lines from tables (CSV), beside those of Points and Members. Cells are separated by commas, "
      "semicolons or tabulators; lines that begin with # do not count; a first line may name the columns, which may "
      "then stand in any order.");
  spec.add(text(kPointsFile), "Table of points: name, x, y, z; relative to the folder of the scene.");
  spec.add(text(kMembersFile), meaning_of_members_file());
  spec.add(text(kProfilesFile),
           "Table of profiles beside those of the program: name, shape, and the dimensions of the shape in "
           "millimetres, which the first line names as a section does.");
  for (const std::string& list : kImportedLists)
    spec.add(text(list + " File"), "Table of entries of the list " + list +
                                       ": name, and any of the parameters of an entry, which the first line names" +
                                       (list == "Sections" ? ", those of Material among them." : ".") +
                                       " Cells say what XML says there, {0, 0, -1} with commas in double quotes.");
  for (const BoundParameter<Member>& parameter : member_parameters().parameters) {
    if (parameter.column_default.empty()) continue;
    spec.add(parameter.spec.means(parameter.column_default));
  }
  return spec;
}

ImportTable::ImportTable(CsvFile file, std::vector<std::string> columns, std::size_t required,
                         const ParameterSource& source)
    : file_(std::move(file)), source_(&source), columns_(std::move(columns)), required_(required) {
  for (std::size_t i = 0; i < columns_.size(); ++i) place_[columns_[i]] = i;
  bool first = true;
  file_.for_each([&](const CsvRecord& record) {
    const auto is_column = [this](const std::string& cell) {
      return std::find(columns_.begin(), columns_.end(), lower_case(cell)) != columns_.end();
    };
    // Such a word cannot be an entry of a column of numbers.
    const auto is_number_column = [&](const std::string& cell) {
      const auto place = static_cast<std::size_t>(&cell - record.cells.data());
      return place < columns_.size() && place > 0 && lower_case(cell) == columns_[place] &&
             std::count(kNumberColumns.begin(), kNumberColumns.end(), columns_[place]) > 0;
    };
    const auto is_name = [](const std::string& cell) { return lower_case(cell) == kNameColumn; };
    const bool names = first && (std::any_of(record.cells.begin(), record.cells.end(), is_name) ||
                                 std::any_of(record.cells.begin(), record.cells.end(), is_number_column) ||
                                 std::all_of(record.cells.begin(), record.cells.end(), is_column));
    first = false;
    if (names) read_names(record);
  });
  if (first) throw error(1, columns_.front(), "the table is empty; allowed: columns " + quoted_list(columns_));
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
    const bool is_right = source_->attempt([&] {
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
    if (!is_right) source_->cannot_mend();
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

std::string ImportTable::where(const CsvRecord& record, const std::string& column) const {
  return file_.where(record, place(column));
}

InputError ImportTable::error(int line, const std::string& column, const std::string& problem) const {
  return error(file_.record_at(line), column, problem);
}

std::map<std::string, std::string> read_imported_files(const Teuchos::ParameterList& scene_list,
                                                       const ParameterSource& source, const ParameterPath& path) {
  std::map<std::string, std::string> texts;
  const auto read = [&](const Teuchos::ParameterList& list, const std::string& parameter, const InputPlace& place) {
    if (!list.isType<std::string>(parameter)) return;
    const auto& name = list.get<std::string>(parameter);
    if (texts.count(name) == 0) texts[name] = text_of_file(resolved(list, parameter, place), "a table");
  };
  for (const auto& [list, parameter] : file_parameters())
    if (scene_list.isSublist(list)) read(scene_list.sublist(list), parameter, InputPlace(source, path)[list]);
  const auto for_each_list = [&](const char* of, const auto& action) {
    if (!scene_list.isSublist(of)) return;
    const Teuchos::ParameterList& all = scene_list.sublist(of);
    for (const std::string& name : names_of(all))
      if (all.isSublist(name)) action(all.sublist(name), InputPlace(source, path)[of][name]);
  };
  for_each_list("Eigenstrains", [&](const Teuchos::ParameterList& strain, const InputPlace& place) {
    for (const char* parameter : {"Strain Table", "Curvature Table"}) read(strain, parameter, place);
  });
  for_each_list("Members", [&](const Teuchos::ParameterList& member, const InputPlace& place) {
    const std::string stations = "Section Stations";
    if (member.isSublist(stations)) read(member.sublist(stations), "Table", place[stations]);
  });
  return texts;
}

void import_entries(Teuchos::ParameterList& scene_list, ParameterSource& source, const ParameterPath& path) {
  if (!scene_list.isSublist("Import")) return;
  const Teuchos::ParameterList& import = scene_list.sublist("Import");
  static const ListSpec scene = scene_spec();
  const auto import_list = [&](const std::string& name) {
    const bool is_taken = scene_list.isParameter(name) && !scene_list.isSublist(name);  // reported by validate()
    if (!import.isType<std::string>(name + " File") || is_taken) return;
    if (name == "Sections" && import_blade(import, InputPlace(source, path)["Import"], scene_list.sublist(name)))
      return;
    const std::map<std::string, EntryColumn> columns = entry_columns(*scene.find_list(name)->list->named_list);
    std::vector<std::string> names = {kNameColumn};
    for (const auto& [column, target] : columns) names.push_back(column);
    const ImportTable table(table_of(import, name + " File", InputPlace(source, path)["Import"]), names, 1, source);
    add_entries(table, columns, child(path, name), scene_list.sublist(name), source);
  };
  source.collect([&] {
    for (const std::string& name : kImportedLists)
      if (!source.attempt([&] { import_list(name); })) source.cannot_mend();
  });
}

ProfileFinder profile_finder(const Teuchos::ParameterList& scene_list, const InputPlace& scene,
                             const std::string& units) {
  const bool has_own = scene_list.isSublist("Import") && scene_list.sublist("Import").isParameter(kProfilesFile);
  return [&scene_list, scene, units, has_own, own = std::make_shared<Catalogue>()](
             const Teuchos::ParameterList& section, const InputPlace& place) {
    if (has_own && own->names.empty()) {
      *own = catalogue_of_program();
      own->add(table_of(scene_list.sublist("Import"), kProfilesFile, scene["Import"]));
    }
    const Catalogue& catalogue = has_own ? *own : catalogue_of_program();
    const auto& wanted = section.get<std::string>("Profile");
    const auto found = catalogue.names.find(profile_key(wanted));
    if (found == catalogue.names.end()) {
      std::vector<std::string> names;
      for (const auto& [key, name] : catalogue.names) names.push_back(name);
      throw place["Profile"].error("value \"" + excerpt(wanted) +
                                   "\" is not in the catalogue; allowed: IPE, HEA, HEB, CHS, SHS, RHS with their "
                                   "sizes, and the names of \"Profiles File\"" +
                                   did_you_mean(wanted, names));
    }
    const double unit = millimetres_of(units, place["Profile"]);
    Teuchos::ParameterList whole = section;
    whole.remove("Profile");
    const Teuchos::ParameterList& profile = catalogue.profiles.sublist(found->second);
    for (const std::string& name : names_of(profile))
      if (profile.isType<double>(name))
        whole.set(name, profile.get<double>(name) / unit);
      else
        whole.set(name, profile.get<std::string>(name));
    validate(whole, section_spec(), catalogue.source, {"Profiles", found->second});
    return whole;
  };
}

ImportTable import_table(const Teuchos::ParameterList& list, const std::string& parameter, const InputPlace& place,
                         const std::vector<std::string>& columns, std::size_t required) {
  return {table_of(list, parameter, place), columns, required, place.source()};
}

ImportTable points_table(const Teuchos::ParameterList& list, const InputPlace& place) {
  return import_table(list, kPointsFile, place, {kNameColumn, "x", "y", "z"}, 4);
}

ImportTable members_table(const Teuchos::ParameterList& list, const InputPlace& place) {
  std::vector<std::string> columns = member_columns(false);
  columns.insert(columns.begin(), kNameColumn);
  const std::size_t required = columns.size();
  for (std::string& column : member_columns(true)) columns.push_back(std::move(column));
  return import_table(list, kMembersFile, place, columns, required);
}

double imported_number(const ImportTable& table, const CsvRecord& record, const std::string& column,
                       Variables* variables) {
  const ParameterSpec number = real(column).at_least(-kLargestCoordinate).at_most(kLargestCoordinate);
  return table.cell(record, column).empty() ? 0.0 : std::get<double>(cell_value(table, record, number, variables));
}

Vector3 imported_vector(const ImportTable& table, const CsvRecord& record, const std::array<std::string, 3>& columns,
                        Variables* variables) {
  Vector3 vector{};
  for (std::size_t i = 0; i < 3; ++i) {
    const bool is_right = table.source().attempt([&] {
      if (table.cell(record, columns[i]).empty())
        throw table.error(record, columns[i], "missing \"" + columns[i] + "\"; allowed: a number");
      vector[i] = imported_number(table, record, columns[i], variables);
    });
    if (!is_right) vector[i] = record.line;
  }
  return vector;
}

Point imported_point(const ImportTable& table, const CsvRecord& record, Variables& variables) {
  return {imported_name(table, record), imported_vector(table, record, {"x", "y", "z"}, &variables)};
}

Member imported_member(const ImportTable& table, const CsvRecord& record, const Teuchos::ParameterList& list,
                       Variables& variables) {
  Member member;
  member.name = imported_name(table, record);
  for (const BoundParameter<Member>& parameter : member_parameters().parameters) {
    if (!parameter.is_column) continue;
    const std::string column = lower_case(parameter.spec.name);
    if (!table.cell(record, column).empty())
      parameter.give(member, cell_value(table, record, parameter.spec, &variables));
    else
      parameter.read(list, member);
  }
  return member;
}

}  // namespace mixbeam
