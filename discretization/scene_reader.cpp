#include "discretization/scene_reader.hpp"

#include "discretization/message_text.hpp"
#include "discretization/number_text.hpp"
#include "discretization/parameter_access.hpp"
#include "discretization/scene_names.hpp"
#include "discretization/scene_parameters.hpp"
#include "discretization/scene_reader_conditions.hpp"
#include "discretization/scene_reader_sections.hpp"
#include "discretization/validate.hpp"
#include "discretization/vector_algebra.hpp"

#include <algorithm>
#include <map>

namespace mixbeam {

Scene read_scene(Teuchos::ParameterList& scene_list, const ParameterSource& source, const ParameterPath& path) {
  validate(scene_list, scene_spec(), source, path);
  return SceneReader(scene_list, source, path).read();
}

SceneReader::SceneReader(const List& list, const ParameterSource& source, ParameterPath path)
    : list_(list), source_(source), path_(std::move(path)) {}

Scene SceneReader::read() {
  scene_.name = source_.root_name();
  read_sections();
  read_points();
  read_members();
  place_members();
  share_out_elements();
  check_members();
  read_conditions(list_, source_, path_, scene_);
  check_points_are_used();
  return std::move(scene_);
}

void SceneReader::read_sections() {
  scene_.sections = mixbeam::read_sections(list_.sublist("Sections"), source_, child(path_, "Sections"));
  for (std::size_t i = 0; i < scene_.sections.size(); ++i) section_index_.emplace(scene_.sections[i].name, i);
}

void SceneReader::read_points() {
  const List& points = list_.sublist("Points");
  for (const std::string& name : names_of(points)) {
    add_point(name, get_vector(points, name));
  }
}

bool SceneReader::add_point(const std::string& name, const Vector3& position) {
  if (!point_index_.emplace(name, scene_.points.size()).second) return false;
  scene_.points.push_back(Point{name, position});
  return true;
}

void SceneReader::check_points_are_used() const {
  for (std::size_t i = 0; i < scene_.points.size(); ++i) {
    if (point_touched_[i]) continue;
    const std::string& name = scene_.points[i].name;
    throw source_.error(child(child(path_, "Points"), name),
                        "unused: no member starts or ends here; allowed: points of members");
  }
}

InputError SceneReader::unknown(const ParameterPath& path, const std::string& what, const std::string& name,
                                const Index& known) const {
  std::vector<std::string> names(known.size());  // in the order of the scene
  for (const auto& [known_name, index] : known) names[index] = known_name;
  return unknown_name(source_, path, what, name, names);
}

ParameterPath SceneReader::member_path(std::size_t member, const ParameterPath& parameter) const {
  ParameterPath path = child(child(path_, "Members"), list_names_[list_name_[member]]);
  path.insert(path.end(), parameter.begin(), parameter.end());
  return path;
}

InputError SceneReader::member_error(std::size_t member, const ParameterPath& parameter,
                                     const std::string& problem) const {
  const std::string& name = scene_.members[member].name;
  const bool is_part = name != list_names_[list_name_[member]];
  return source_.error(member_path(member, parameter), (is_part ? "line \"" + excerpt(name) + "\": " : "") + problem);
}

const Vector3& SceneReader::position_of(const std::string& point) const {
  return scene_.points[point_index_.at(point)].position;
}

}  // namespace mixbeam
