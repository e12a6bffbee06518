#include "discretization/scene_reader.hpp"

#include "discretization/message_text.hpp"
#include "discretization/nearest_name.hpp"
#include "discretization/number_text.hpp"
#include "discretization/scene_parameters.hpp"
#include "discretization/validate.hpp"
#include "discretization/vector_algebra.hpp"

#include <algorithm>
#include <limits>
#include <map>

namespace mixbeam {
namespace {

using Teuchos::ParameterList;
using namespace vector_algebra;

const std::vector<std::string> kAxes = {"x", "y", "z"};

std::vector<std::string> names_of(const ParameterList& list) {
  std::vector<std::string> names;
  for (auto entry = list.begin(); entry != list.end(); ++entry) names.push_back(list.name(entry));
  return names;
}

/// Whether the user gave this parameter, as opposed to its default.
bool is_given(const ParameterList& list, const std::string& name) {
  return list.isParameter(name) && !list.getEntry(name).isDefault();
}

Vector3 get_vector(const ParameterList& list, const std::string& name) {
  const auto& values = list.get<Teuchos::Array<double>>(name);
  return {values[0], values[1], values[2]};
}

Vector3 get_vector_or_zero(const ParameterList& list, const std::string& name) {
  return list.isParameter(name) ? get_vector(list, name) : Vector3{};
}

std::array<bool, 3> get_axes(const ParameterList& list, const std::string& name) {
  const auto& words = list.get<Teuchos::Array<std::string>>(name);
  std::array<bool, 3> axes{};
  for (std::size_t i = 0; i < 3; ++i) axes[i] = std::find(words.begin(), words.end(), kAxes[i]) != words.end();
  return axes;
}

template <typename Meaning>
Meaning translated(const ParameterList& list, const std::string& name, const std::map<std::string, Meaning>& meanings) {
  return meanings.at(list.get<std::string>(name));  // the declared choices are the keys
}

const std::map<std::string, ForceIntegration> kForceIntegrations = {{"full", ForceIntegration::full},
                                                                    {"axial reduced", ForceIntegration::axial_reduced},
                                                                    {"shear reduced", ForceIntegration::shear_reduced},
                                                                    {"both reduced", ForceIntegration::both_reduced}};
const std::map<std::string, CurveShape> kShapes = {
    {"line", CurveShape::line}, {"arc", CurveShape::circular_arc}, {"helix", CurveShape::helix}};
const std::map<std::string, LoadFrame> kFrames = {{"dead", LoadFrame::dead}, {"follower", LoadFrame::follower}};

/// A stiffness, or infinity when the switch rules the strain out.
double read_stiffness(const ParameterList& list, const std::string& name, const std::string& rigid_switch,
                      const ParameterSource& source, const ParameterPath& path) {
  const bool rigid = list.get<bool>(rigid_switch);
  const bool given = list.isParameter(name);
  if (rigid && given) {
    throw source.error(child(path, name), "value " + shortest(list.get<double>(name)) + ", but \"" + rigid_switch +
                                              "\" is true; allowed: one of the two");
  }
  if (!rigid && !given) {
    throw source.error(child(path, name), "missing; allowed: a double > 0, or inf, or \"" + rigid_switch + "\" = true");
  }
  return rigid ? std::numeric_limits<double>::infinity() : list.get<double>(name);
}

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
  read_supports();
  read_point_loads();
  read_distributed_loads();
  check_points_are_used();
  check_stages();
  return std::move(scene_);
}

void SceneReader::read_sections() {
  const List& sections = list_.sublist("Sections");
  for (const std::string& name : names_of(sections)) {
    const List& list = sections.sublist(name);
    const ParameterPath path = child(child(path_, "Sections"), name);
    Section section;
    section.name = name;
    section.axial_stiffness = read_stiffness(list, "EA", "Inextensible", source_, path);
    section.shear_stiffness = {read_stiffness(list, "GA2", "Shear Rigid", source_, path),
                               read_stiffness(list, "GA3", "Shear Rigid", source_, path)};
    section.torsional_stiffness = list.get<double>("GIt");
    section.bending_stiffness = {list.get<double>("EI2"), list.get<double>("EI3")};
    section_index_.emplace(name, scene_.sections.size());
    scene_.sections.push_back(section);
  }
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

void SceneReader::read_supports() {
  const List& supports = list_.sublist("Supports");
  for (const std::string& name : names_of(supports)) {
    const List& list = supports.sublist(name);
    const ParameterPath path = child(child(path_, "Supports"), name);
    Support support;
    support.point = list.get<std::string>("Point");
    support.displacement_fixed = get_axes(list, "Fixed Displacement");
    support.rotation_fixed = get_axes(list, "Fixed Rotation");
    support.prescribed_displacement = get_vector(list, "Prescribed Displacement");
    support.prescribed_rotation = get_vector(list, "Prescribed Rotation");
    support.stage = list.get<int>("Stage");
    check_touched_point(support.point, path);
    const auto [earlier, is_new] = support_at_.emplace(support.point, name);
    if (!is_new) {
      throw source_.error(child(path, "Point"), "value \"" + excerpt(support.point) + "\" is supported by \"" +
                                                    excerpt(earlier->second) +
                                                    "\" already; allowed: one support per point");
    }
    check_support(support, list, path);
    scene_.supports.push_back(support);
  }
}

void SceneReader::check_support(const Support& support, const List& list, const ParameterPath& path) {
  const auto count = [](const std::array<bool, 3>& fixed) { return std::count(fixed.begin(), fixed.end(), true); };
  const auto rotations = count(support.rotation_fixed);
  if (count(support.displacement_fixed) + rotations == 0)
    throw source_.error(path, "fixes nothing; allowed: at least one direction");
  if (rotations == 1) {
    throw source_.error(child(path, "Fixed Rotation"),
                        "one axis only, which leaves two to turn about (not supported); allowed: "
                        "{}, two axes (a hinge about the third), or {x, y, z}");
  }
  for (std::size_t i = 0; i < 3; ++i) {
    if (support.prescribed_displacement[i] == 0.0 || support.displacement_fixed[i]) continue;
    throw source_.error(child(path, "Prescribed Displacement"),
                        "value " + to_text(support.prescribed_displacement) + " moves direction " + kAxes[i] +
                            ", which \"Fixed Displacement\" leaves free; allowed: zero there, or " + kAxes[i] +
                            " fixed");
  }
  if (!is_zero(support.prescribed_rotation) && rotations != 3) {
    throw source_.error(child(path, "Prescribed Rotation"), "value " + to_text(support.prescribed_rotation) +
                                                                "; allowed: only with \"Fixed Rotation\" = {x, y, z}");
  }
  const bool moves = !is_zero(support.prescribed_displacement) || !is_zero(support.prescribed_rotation);
  if (moves) use_stage(support.stage, child(path, "Stage"));
  if (!moves && is_given(list, "Stage") && support.stage != 1) {
    throw source_.error(child(path, "Stage"), "value " + std::to_string(support.stage) +
                                                  ", but nothing is prescribed; a support holds from the beginning");
  }
}

void SceneReader::read_point_loads() {
  const List& loads = list_.sublist("Point Loads");
  for (const std::string& name : names_of(loads)) {
    const List& list = loads.sublist(name);
    const ParameterPath path = child(child(path_, "Point Loads"), name);
    PointLoad load;
    load.point = list.get<std::string>("Point");
    load.force = get_vector(list, "Force");
    load.moment = get_vector(list, "Moment");
    load.frame = translated(list, "Frame", kFrames);
    if (list.isParameter("Member")) load.member = list.get<std::string>("Member");
    load.stage = list.get<int>("Stage");
    check_touched_point(load.point, path);
    check_loaded(list, "Force", "Moment", path);
    if (load.frame == LoadFrame::follower) check_follower(load, path);
    if (load.frame == LoadFrame::dead && list.isParameter("Member")) {
      throw source_.error(child(path, "Member"), "value \"" + excerpt(load.member) +
                                                     "\" has no meaning for a dead load; "
                                                     "allowed: with \"Frame\" = \"follower\" only");
    }
    use_stage(load.stage, child(path, "Stage"));
    scene_.point_loads.push_back(load);
  }
}

void SceneReader::check_follower(const PointLoad& load, const ParameterPath& path) const {
  const auto known = member_index_.find(load.member);
  const Member* const member = known == member_index_.end() ? nullptr : &scene_.members[known->second];
  const bool starts = member != nullptr && member->start_point == load.point;
  const bool ends = member != nullptr && member->end_point == load.point;
  if (starts != ends) return;
  std::vector<std::string> touching;
  for (const Member& candidate : scene_.members) {
    if ((candidate.start_point == load.point) != (candidate.end_point == load.point))
      touching.push_back(candidate.name);
  }
  const std::string seen =
      load.member.empty() ? "missing for a follower load" : "value \"" + excerpt(load.member) + "\"";
  throw source_.error(child(path, "Member"), seen + (starts ? " has both ends at the point" : "") +
                                                 "; allowed: a member with one end at \"" + excerpt(load.point) +
                                                 "\": " + quoted_list(touching) + did_you_mean(load.member, touching));
}

void SceneReader::read_distributed_loads() {
  const List& loads = list_.sublist("Distributed Loads");
  for (const std::string& name : names_of(loads)) {
    const List& list = loads.sublist(name);
    const ParameterPath path = child(child(path_, "Distributed Loads"), name);
    DistributedLoad load;
    load.member = list.get<std::string>("Member");
    load.force = get_vector(list, "Force");
    load.couple = get_vector(list, "Couple");
    load.stage = list.get<int>("Stage");
    if (member_index_.count(load.member) == 0)
      throw unknown(child(path, "Member"), "member", load.member, member_index_);
    check_loaded(list, "Force", "Couple", path);
    use_stage(load.stage, child(path, "Stage"));
    scene_.distributed_loads.push_back(load);
  }
}

void SceneReader::check_loaded(const List& list, const std::string& first, const std::string& second,
                               const ParameterPath& path) const {
  if (is_given(list, first) || is_given(list, second)) return;
  throw source_.error(path, "loads nothing; allowed: \"" + first + "\" or \"" + second + "\" or both");
}

void SceneReader::check_points_are_used() const {
  for (std::size_t i = 0; i < scene_.points.size(); ++i) {
    if (point_touched_[i]) continue;
    const std::string& name = scene_.points[i].name;
    throw source_.error(child(child(path_, "Points"), name),
                        "unused: no member starts or ends here; allowed: points of members");
  }
}

void SceneReader::check_stages() {
  std::stable_sort(stages_used_.begin(), stages_used_.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  Stage last = 0;
  for (const auto& [stage, path] : stages_used_) {
    if (stage > last + 1) {
      throw source_.error(path, "value " + std::to_string(stage) + ", but nothing acts in stage " +
                                    std::to_string(last + 1) + "; allowed: stages 1, 2, 3, ... without gaps");
    }
    last = stage;
  }
  scene_.stages = std::max(last, 1);
}

void SceneReader::check_touched_point(const std::string& point, const ParameterPath& path) const {
  const auto known = point_index_.find(point);
  if (known == point_index_.end()) throw unknown(child(path, "Point"), "point", point, point_index_);
  if (point_touched_[known->second]) return;
  throw source_.error(child(path, "Point"), "value \"" + excerpt(point) +
                                                "\": no member starts or ends there; allowed: "
                                                "points of members");
}

InputError SceneReader::unknown(const ParameterPath& path, const std::string& what, const std::string& name,
                                const Index& known) const {
  std::vector<std::string> names(known.size());  // in the order of the scene
  for (const auto& [known_name, index] : known) names[index] = known_name;
  return source_.error(path, "value \"" + excerpt(name) + "\" is not a " + what +
                                 " of the scene; allowed: " + quoted_list(names) + did_you_mean(name, names));
}

ParameterPath SceneReader::member_path(const Member& member, const std::string& parameter) const {
  ParameterPath path = child(child(path_, "Members"), member.name);
  if (!parameter.empty()) path.push_back(parameter);
  return path;
}

const Vector3& SceneReader::position_of(const std::string& point) const {
  return scene_.points[point_index_.at(point)].position;
}

void SceneReader::use_stage(Stage stage, const ParameterPath& path) { stages_used_.emplace_back(stage, path); }

}  // namespace mixbeam
