#include "apps/mixbeam/batch_cases.hpp"

#include "apps/common/run/number_path.hpp"
#include "apps/mixbeam/commands.hpp"
#include "discretization/parameters/value.hpp"
#include "discretization/reading/read_scene.hpp"
#include "discretization/reading/variables.hpp"
#include "discretization/scene/load_cases.hpp"
#include "discretization/text/message_text.hpp"
#include "discretization/text/number_text.hpp"
#include "nonlinear/run/imperfect_scene.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mixbeam {

namespace {

InputError refused(const BatchColumn& column, const std::string& problem) {
  return column.refusal("\"" + excerpt(column.parameter) + "\": " + problem);
}

/// Number of entries of an array, 0 for a single number, -1 for anything else.
int components_of(const Teuchos::ParameterEntry& entry) {
  if (entry.isType<double>() || entry.isType<int>()) return 0;
  if (entry.isType<Teuchos::Array<double>>())
    return static_cast<int>(Teuchos::getValue<Teuchos::Array<double>>(entry).size());
  if (entry.isType<Teuchos::Array<int>>())
    return static_cast<int>(Teuchos::getValue<Teuchos::Array<int>>(entry).size());
  return -1;
}

bool is_whole(double value) { return std::floor(value) == value && std::abs(value) <= std::numeric_limits<int>::max(); }

}  // namespace

CaseScenes::CaseScenes(Application& app, Batch& batch, std::string load_case)
    : app_(app), batch_(batch), load_case_(std::move(load_case)) {
  for (std::size_t i = 0; i < batch.columns.size(); ++i) places_.push_back(find(batch.columns[i], i));
  find_formulas();
  evaluate_cells(batch);
}

/// Finds formulas outside the list "Scene", whose values may depend on the case.
void CaseScenes::find_formulas() {
  const Teuchos::ParameterList& root = *app_.xml.list;
  for (const std::string& name : names_of(root)) {
    if (name == "Scene" || name == "Batch" || !root.isSublist(name)) continue;
    if (name == "Expected" && batch_.output != BatchOutput::expected) continue;
    for (const ParameterPath& path : paths_of_formulas(root.sublist(name), {name})) {
      const auto is_own = [&](const OwnExpectation& own) { return path == ParameterPath{name, own.name, "Value"}; };
      if (std::any_of(own_expectations_.begin(), own_expectations_.end(), is_own)) continue;
      const Teuchos::ParameterList* list = &root;
      for (std::size_t i = 0; i + 1 < path.size(); ++i) list = &list->sublist(path[i]);
      const Teuchos::ParameterEntry* const entry = list->getEntryPtr(path.back());
      formulas_.push_back({path, entry, value_of(*entry)});
      if (name == "Expected" && path.back() == "Value") own_expectations_.push_back({kOfFormula, path[1]});
    }
  }
}

/// Evaluates formulas in cells with the variables and points of their row, which may be formulas themselves.
void CaseScenes::evaluate_cells(Batch& batch) const {
  const auto evaluate_row = [&](auto first, auto end) {
    Teuchos::ParameterList scene = app_.xml.list->sublist("Scene");
    std::vector<Place> places;
    for (const BatchColumn& column : batch.columns) {
      const NumberPath path = number_path(column.parameter);
      places.push_back(path.names.front() == "Expected" ? Place{} : find_in(scene, path.names, path.component, column));
    }
    for (std::size_t i = 0; i < places.size(); ++i)
      if (const double value = batch.value(first->index, i); !std::isnan(value))
        set(places[i], value, first->index, batch.columns[i]);
    for (auto cell = first; cell != end; ++cell)
      if (const Place& place = places[cell->column]; place.entry != nullptr)
        set_formula(*place.entry, place.component, cell->text);
    Variables variables(scene, app_.xml.source);
    for (auto cell = first; cell != end; ++cell)
      batch.values[cell->index * batch.columns.size() + cell->column] =
          std::get<double>(variables.value(cell->text, ParameterType::real, cell->refusal));
  };
  for (auto first = batch.formulas.begin(); first != batch.formulas.end();) {
    const auto is_behind = [&](const Batch::Formula& cell) { return cell.index != first->index; };
    const auto end = std::find_if(first, batch.formulas.end(), is_behind);
    try {
      app_.xml.source.collect([&] { evaluate_row(first, end); });
    } catch (const InputError& error) {
      throw InputError(batch.name_of_case(first->index) + ": " + error.what());
    }
    first = end;
  }
}

/// Evaluates formulas outside the list "Scene". Only limits and expected values may vary: cases share all the rest.
void CaseScenes::evaluate_formulas(std::size_t index) {
  Teuchos::ParameterList& root = *app_.xml.list;
  const ParameterSource& source = app_.xml.source;
  Variables variables(root.sublist("Scene"), source);
  for (const SublistSpec& list : mixbeam_root_spec().sublists)
    if (list.name != "Scene" && list.name != "Batch" && root.isSublist(list.name))
      source.collect([&] { variables.resolve(root.sublist(list.name), *list.list, {list.name}); });
  bool has_limits = false;
  for (OuterFormula& formula : formulas_) {
    const ParameterPath& path = formula.path;
    const bool is_expected = path.front() == "Expected" && path.back() == "Value";
    const bool is_limit = path.front() == "Quantities" && (path.back() == "Limit" || path.back().rfind("Span", 0) == 0);
    has_limits = has_limits || is_limit;
    formula.values.resize(std::max(formula.values.size(), index + 1));
    if (is_expected) formula.values[index] = Teuchos::getValue<double>(*formula.entry);
    if (is_expected || is_limit || value_of(*formula.entry) == formula.of_file) continue;
    throw source.error(path, "its formula would be " + excerpt(to_text(value_of(*formula.entry))) +
                                 " in this case and " + excerpt(to_text(formula.of_file)) +
                                 " in the scene; allowed to differ in a batch, outside of the list \"Scene\": limits "
                                 "and expected values");
  }
  if (!has_limits) return;
  limits_.resize(std::max(limits_.size(), index + 1));
  limits_[index].clear();
  for (const Quantity& quantity : read_quantities(root.sublist("Quantities"), source))
    limits_[index].push_back(quantity.allowed().value_or(0.0));
}

double CaseScenes::expected(const OwnExpectation& own, std::size_t index) const {
  if (own.column != kOfFormula) return batch_.value(index, own.column);
  const auto is_its = [&](const OuterFormula& formula) {
    return formula.path == ParameterPath{"Expected", own.name, "Value"};
  };
  return std::find_if(formulas_.begin(), formulas_.end(), is_its)->values[index];
}

CaseScenes::Place CaseScenes::find(const BatchColumn& column, std::size_t index) {
  const NumberPath path = number_path(column.parameter);
  if (path.names.front() != "Expected")
    return find_in(app_.xml.list->sublist("Scene"), path.names, path.component, column);
  std::vector<std::string> names;
  for (const ExpectedValue& value : app_.expected)
    if (value.word.empty()) names.push_back(value.name);
  const std::string name = path.names.size() > 1 ? path.names[1] : "";
  if (std::find(names.begin(), names.end(), name) == names.end())
    throw refused(column, "no expected value of this name; allowed: " + quoted_list(names) + did_you_mean(name, names));
  if (path.names.size() != 3 || path.names[2] != "Value" || path.component != -1)
    throw refused(column, "allowed in the list \"Expected\": \"Expected/" + name + "/Value\"");
  if (batch_.output != BatchOutput::expected)
    throw refused(column, "given, but expected quantities are not evaluated; allowed with \"Output\" = \"expected\"");
  own_expectations_.push_back({index, name});
  return {};
}

CaseScenes::Place CaseScenes::find_in(Teuchos::ParameterList& list, const std::vector<std::string>& path, int component,
                                      const BatchColumn& column) const {
  Teuchos::ParameterList* here = &list;
  for (std::size_t i = 0; i < path.size(); ++i) {
    const bool is_last = i + 1 == path.size();
    std::vector<std::string> names;
    for (const std::string& name : names_of(*here))
      if (here->isSublist(name) != is_last) names.push_back(name);
    if (std::find(names.begin(), names.end(), path[i]) == names.end())
      throw refused(column, "no " + (is_last ? app_.xml.source.parameter_word() : app_.xml.source.list_word()) + " \"" +
                                excerpt(path[i]) + "\" in the list \"" + (i == 0 ? "Scene" : path[i - 1]) +
                                "\" of the scene; allowed: " + quoted_list(names) + did_you_mean(path[i], names));
    if (!is_last) here = &here->sublist(path[i]);
  }
  Teuchos::ParameterEntry& entry = *here->getEntryPtr(path.back());
  const int components = components_of(entry);
  if (components < 0) throw refused(column, "not a number; allowed: parameters that are numbers or arrays of them");
  if (components == 0 && component != -1) throw refused(column, "a single number; allowed: its name without [...]");
  if (components > 0 && (component < 0 || component >= components))
    throw refused(column, "an array of " + std::to_string(components) + " numbers; allowed: one of them, [0] to [" +
                              std::to_string(components - 1) + "]");
  return {&entry, component};
}

void CaseScenes::set(const Place& place, double value, std::size_t index, const BatchColumn& column) const {
  if (place.entry == nullptr) return;  // an expected value
  Teuchos::ParameterEntry& entry = *place.entry;
  const auto refuse = [&](const std::string& seen, const std::string& allowed) {
    throw InputError(batch_.name_of_case(index) + ": \"" + excerpt(column.parameter) + "\": " + seen +
                     "; allowed: " + allowed);
  };
  if (std::isnan(value)) refuse("an empty cell", "a number; only expected values may be left out");
  const bool whole = entry.isType<int>() || entry.isType<Teuchos::Array<int>>();
  if (whole && !is_whole(value)) refuse("value " + shortest(value), "a whole number");
  set_number(entry, place.component, value);
}

void CaseScenes::keep(std::size_t index, Scene scene) {
  if (kept_.size() * scene.members.size() < kMostKept) kept_.emplace(index, std::move(scene));
}

Scene CaseScenes::scene_of(std::size_t index) {
  if (auto kept = kept_.extract(index)) return std::move(kept.mapped());
  if (const auto kept = imperfect_.find(index); kept != imperfect_.end()) return kept->second;
  for (std::size_t i = 0; i < places_.size(); ++i) set(places_[i], batch_.value(index, i), index, batch_.columns[i]);
  try {
    if (!formulas_.empty()) evaluate_formulas(index);
    Scene scene = read_scene(app_.xml.list->sublist("Scene"), app_.xml.source);
    const bool is_alike = scene.members.size() == app_.scene.members.size();
    if (names_no_mesh(scene))
      scene = on_mesh(scene, is_alike ? mesh_of(app_.scene) : start_mesh(scene, kAccuracyWithoutMesh));
    if (scene.imperfection_modes.empty()) return scene_of_case(scene, load_case_);
    scene = with_mode_shapes(scene, app_.solver, app_.communicator, {app_.xml.source, {"Scene"}});
    scene = scene_of_case(scene, load_case_);
    if (!app_.mesh_is_free) imperfect_[index] = scene;
    return scene;
  } catch (const InputError& error) {
    throw InputError(batch_.name_of_case(index) + ": " + error.what());
  }
}

}  // namespace mixbeam
