#include "discretization/reading/scene_reader.hpp"

#include "discretization/checks/mechanism.hpp"
#include "discretization/parameters/access.hpp"
#include "discretization/parameters/validate.hpp"
#include "discretization/reading/read_scene.hpp"
#include "discretization/reading/scene_parts.hpp"
#include "discretization/scene/limits.hpp"
#include "discretization/text/message_text.hpp"
#include "discretization/text/number_text.hpp"
#include "discretization/text/result_names.hpp"
#include "kernels/math/vector_algebra.hpp"

#include <cctype>

namespace mixbeam {

namespace {

constexpr std::size_t kLongestUnit = 16;  // letters: labels of axes have no more room

/// A clamp at this point, as one writes it.
std::string example_of_support(const std::string& point, InputLanguage language) {
  const std::string inside = "in \"Scene\" a list \"Supports\", like ";
  if (language == InputLanguage::yaml) return inside + "Supports: {base: {Point: " + excerpt(point) + "}}";
  if (language == InputLanguage::python) return "scene.supports[\"base\"] = dict(point=\"" + excerpt(point) + "\")";
  return inside +
         R"(<ParameterList name="Supports"><ParameterList name="base"><Parameter name="Point" type="string" )" +
         "value=\"" + excerpt(point) + R"("/></ParameterList></ParameterList>)";
}

}  // namespace

ListSpec scene_spec() {
  ListSpec spec(
      "The structure, its supports and its loads; any consistent units, angles in radians, global axes x, y, z.");
  spec.add_list("Variables", variables_spec(), Presence::optional);
  spec.add_list(
      "Sections",
      ListSpec("Cross sections; at least one here or by Import.").with_named_lists("section", section_spec()));
  spec.add_list("Points", ListSpec("Points of the undeformed structure; at least one here or by Import.")
                              .with_named_parameters(
                                  "point", bounded_vector("").required().means("Global coordinates [length].")));
  spec.add_list(
      "Members",
      ListSpec("Beams; at least one here or by Import.").with_named_lists("member", member_parameters().spec));
  spec.add_list("Import", import_spec(), Presence::optional);
  spec.add_list("Patterns", patterns_spec(), Presence::optional);
  spec.add_list("Imperfection", imperfection_spec(), Presence::optional);
  spec.add(real("Accuracy").above(kBestAccuracy).below(1.0),
           "Wanted error of displacements over the largest of them, at the end of the path: order and number of "
           "elements are chosen for every member that does not give them itself.");
  spec.add(
      text("Accuracy Of"),
      "With Accuracy: name of an entry of the list Quantities whose error over its size counts in place of that of "
      "displacements, or stress: the largest von Mises stress.");
  spec.add(text("Units"),
           "Units of length and force, as \"m, N\": words for the labels of pictures and for reports. Nothing is "
           "converted but the dimensions of a Profile.");
  add_condition_lists(spec);
  return spec;
}

Scene read_scene(Teuchos::ParameterList& scene_list, const ParameterSource& source, const ParameterPath& path,
                 const SceneRemarks& remarks) {
  Scene scene;
  source.collect([&] {
    static const ListSpec spec = scene_spec();
    Variables variables(scene_list, source, path);
    variables.resolve(scene_list, spec, path);
    validate(scene_list, spec, source, path);
    source.require_mended();
    SceneReader reader(scene_list, {source, path}, variables);
    scene = reader.read();
    if (remarks.notes != nullptr) *remarks.notes = reader.notes();
    source.require_none();
    try {
      if (scene.supports.empty())
        throw source.error(child(path, "Supports"),
                           "no support: the whole structure can move freely; needed: " +
                               example_of_support(scene.points.front().name, source.language()));
      check_supports(scene, source, path);
    } catch (const InputError& error) {
      if (remarks.loose == nullptr) throw;
      *remarks.loose = error.what();
    }
  });
  source.require_mended();
  return scene;
}

SceneReader::SceneReader(const List& list, const InputPlace& place, Variables& variables)
    : list_(list), place_(place), variables_(variables) {}

Scene SceneReader::read() {
  place_.source().collect([this] { read_lists(); });
  return std::move(scene_);
}

void SceneReader::read_lists() {
  scene_.name = place_.source().root_name();
  if (list_.isParameter("Accuracy")) scene_.accuracy = list_.get<double>("Accuracy");
  const ParameterSource& source = place_.source();
  if (list_.isParameter("Accuracy Of")) scene_.accuracy_of = list_.get<std::string>("Accuracy Of");
  place_["Accuracy Of"].attempt([this] {
    if (!scene_.accuracy_of.empty() && !scene_.accuracy)
      throw place_["Accuracy Of"].error("given without \"Accuracy\"; allowed: with it");
  });
  place_["Units"].attempt([this] { read_units(); });
  read_sections();
  read_points();
  import_points();
  read_members();
  import_members();
  source.require_mended();
  if (scene_.members.empty()) throw place_["Members"].error("no member; allowed: at least one, here or by \"Import\"");
  place_members();
  share_out_elements();
  check_members();
  source.require_mended();
  std::vector<CopiedPattern> copies;
  if (list_.isSublist("Patterns") || list_.isSublist("Imperfection")) source.require_none();
  if (list_.isSublist("Patterns")) copies = apply_patterns(list_.sublist("Patterns"), place_["Patterns"], scene_);
  if (list_.isSublist("Imperfection"))
    apply_imperfection(list_.sublist("Imperfection"), place_["Imperfection"], scene_);
  notes_ = read_conditions(list_, place_, scene_, copies);
  if (!source.has_mistakes()) check_points_are_used();
}

void SceneReader::read_units() {
  if (!list_.isParameter("Units")) return;
  scene_.units = list_.get<std::string>("Units");
  const std::size_t comma = scene_.units.find(',');
  const auto is_word = [](const std::string& word) {
    const bool is_line = std::none_of(word.begin(), word.end(), [](unsigned char c) { return c < ' ' || c == 127; });
    return is_line && !trimmed(word).empty() && word.size() <= kLongestUnit && word.find(',') == std::string::npos;
  };
  if (comma != std::string::npos && is_word(scene_.units.substr(0, comma)) && is_word(scene_.units.substr(comma + 1)))
    return;
  throw place_["Units"].error("value \"" + excerpt(scene_.units) +
                              "\"; allowed: a unit of length, a comma and a unit of force, as \"m, N\"");
}

void SceneReader::read_sections() {
  scene_.sections = mixbeam::read_sections(list_.sublist("Sections"), place_["Sections"],
                                           profile_finder(list_, place_, scene_.units));
  if (scene_.sections.empty())
    throw place_["Sections"].error("no section; allowed: at least one, here or by \"Import\"");
  for (std::size_t i = 0; i < scene_.sections.size(); ++i) section_index_.emplace(scene_.sections[i].name, i);
}

void SceneReader::read_points() {
  const List& points = list_.sublist("Points");
  for (const std::string& name : names_of(points)) {
    place_["Points"][name].attempt([&] { check_name(name, place_["Points"]); });
    add_point(name, get_vector(points, name));
  }
}

/// Of an entry of the list at `path`.
void SceneReader::check_name(const std::string& name, const InputPlace& place) const {
  const Problem problem = result_name_problem(name);
  if (!problem.empty()) throw place[name].error("name " + problem);
}

bool SceneReader::add_point(const std::string& name, const Vector3& position) {
  if (!point_index_.emplace(name, scene_.points.size()).second) return false;
  scene_.points.push_back(Point{name, position});
  return true;
}

void SceneReader::import_points() {
  declared_points_ = scene_.points.size();
  if (!list_.isSublist("Import") || !list_.sublist("Import").isParameter("Points File")) return;
  const ImportTable table = points_table(list_.sublist("Import"), place_["Import"]);
  table.for_each([&](const CsvRecord& record) {
    const Point point = imported_point(table, record, variables_);
    if (add_point(point.name, point.position)) return;
    throw table.error(record, "name",
                      "value \"" + excerpt(point.name) + "\" is the name of another point; allowed: names that differ");
  });
}

/// A table may hold more points than members use; a point written in the scene itself without use is a slip.
void SceneReader::check_points_are_used() {
  for (std::size_t i = origins_.size(); i < scene_.members.size(); ++i) {  // copies of patterns
    const Member& copy = scene_.members[i];
    touch_point(copy.start_point);
    touch_point(copy.end_point);
    for (const InnerPoint& inner : copy.inner_points) touch_point(inner.point);
  }
  for (std::size_t i = 0; i < declared_points_; ++i) {
    if (point_touched_[i]) continue;
    const InputPlace place = place_["Points"][scene_.points[i].name];
    place.source().keep(
        place.error("unused: no member, imported or copied ones included, starts or ends here; allowed: points of "
                    "members"));
  }
}

void SceneReader::touch_point(const std::string& point) {
  const auto found = point_index_.find(point);  // patterns make points of their own, too
  if (found != point_index_.end()) point_touched_[found->second] = true;
}

InputError SceneReader::member_error(std::size_t member, const ParameterPath& parameter,
                                     const std::string& problem) const {
  const std::string& name = scene_.members[member].name;
  const Origin& origin = origins_[member];
  if (origin.is_imported) {
    std::string column = parameter.empty() ? "name" : parameter.front();
    column[0] = static_cast<char>(std::tolower(static_cast<unsigned char>(column[0])));
    return imported_members_->error(static_cast<int>(origin.place), column,
                                    "member \"" + excerpt(name) + "\": " + problem);
  }
  const std::string& list_name = list_names_[origin.place];
  InputPlace place = place_["Members"][list_name];
  for (const std::string& part : parameter) place = place[part];
  return place.error((name == list_name ? "" : "line \"" + excerpt(name) + "\": ") + problem);
}

const Vector3& SceneReader::position_of(const std::string& point) const {
  const auto found = point_index_.find(point);  // its mistake may have been kept
  if (found == point_index_.end()) throw place_["Points"].error("no point \"" + excerpt(point) + "\"");
  return scene_.points[found->second].position;
}

}  // namespace mixbeam
