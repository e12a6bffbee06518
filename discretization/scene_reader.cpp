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
namespace {

using Teuchos::ParameterList;
using namespace vector_algebra;

const std::map<std::string, ForceIntegration> kForceIntegrations = {{"full", ForceIntegration::full},
                                                                    {"axial reduced", ForceIntegration::axial_reduced},
                                                                    {"shear reduced", ForceIntegration::shear_reduced},
                                                                    {"both reduced", ForceIntegration::both_reduced}};
const std::map<std::string, CurveShape> kShapes = {
    {"line", CurveShape::line}, {"arc", CurveShape::circular_arc}, {"helix", CurveShape::helix}};

}  // namespace

Scene read_scene(ParameterList& scene_list, const ParameterSource& source, const ParameterPath& path) {
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
  place_curve_ends();
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
    point_index_.emplace(name, scene_.points.size());
    scene_.points.push_back(Point{name, get_vector(points, name)});
  }
}

void SceneReader::read_members() {
  const List& members = list_.sublist("Members");
  long long elements = 0;
  for (const std::string& name : names_of(members)) {
    const List& list = members.sublist(name);
    Member member;
    member.name = name;
    member.start_point = list.get<std::string>("Start");
    member.end_point = list.get<std::string>("End");
    member.curve = read_curve(list.sublist("Curve"), child(member_path(member), "Curve"));
    member.section = list.get<std::string>("Section");
    member.order = list.get<int>("Order");
    member.elements = list.get<int>("Elements");
    member.force_integration = translated(list, "Force Integration", kForceIntegrations);
    member.second_axis = get_vector_or_zero(list, "Second Axis");
    elements += member.elements;
    if (elements > kMostElements) {
      throw source_.error(member_path(member, "Elements"), "value " + std::to_string(member.elements) +
                                                               " brings the scene to " + std::to_string(elements) +
                                                               " elements; allowed: " + std::to_string(kMostElements));
    }
    member_index_.emplace(name, scene_.members.size());
    scene_.members.push_back(member);
  }
}

Curve SceneReader::read_curve(const List& list, const ParameterPath& path) const {
  const std::map<std::string, std::vector<std::string>> needed = {
      {"line", {}}, {"arc", {"Center", "Axis", "Angle"}}, {"helix", {"Center", "Axis", "Angle", "Rise"}}};
  const auto& shape = list.get<std::string>("Shape");
  const std::vector<std::string>& names = needed.at(shape);
  for (const std::string name : {"Center", "Axis", "Angle", "Rise"}) {
    const bool wanted = std::find(names.begin(), names.end(), name) != names.end();
    if (wanted == list.isParameter(name)) continue;
    const std::string problem = wanted ? "missing; needed for" : "given, but has no meaning for";
    const std::string allowed = names.empty() ? "nothing else" : quoted_list(names);
    throw source_.error(child(path, name), problem + R"( "Shape" = ")" + shape + "\"; allowed with it: " + allowed);
  }
  Curve curve;
  curve.shape = kShapes.at(shape);
  if (curve.shape == CurveShape::line) return curve;
  curve.center = get_vector(list, "Center");
  curve.axis = get_vector(list, "Axis");
  curve.angle = list.get<double>("Angle");
  if (curve.shape == CurveShape::helix) curve.rise = list.get<double>("Rise");
  if (norm(curve.axis) < kShortestLength) {
    throw source_.error(child(path, "Axis"),
                        "value " + to_text(curve.axis) + " has no direction; allowed: any vector but zero");
  }
  return curve;
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

ParameterPath SceneReader::member_path(const Member& member, const std::string& parameter) const {
  ParameterPath path = child(child(path_, "Members"), member.name);
  if (!parameter.empty()) path.push_back(parameter);
  return path;
}

const Vector3& SceneReader::position_of(const std::string& point) const {
  return scene_.points[point_index_.at(point)].position;
}

}  // namespace mixbeam
