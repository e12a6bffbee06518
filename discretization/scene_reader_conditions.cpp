#include "discretization/scene_reader_conditions.hpp"

#include "discretization/message_text.hpp"
#include "discretization/nearest_name.hpp"
#include "discretization/number_text.hpp"
#include "discretization/parameter_access.hpp"
#include "discretization/scene_names.hpp"
#include "discretization/vector_algebra.hpp"

#include <algorithm>
#include <unordered_map>
#include <utility>

namespace mixbeam {
namespace {

using namespace vector_algebra;

const std::vector<std::string> kAxes = {"x", "y", "z"};
const std::map<std::string, LoadFrame> kFrames = {{"dead", LoadFrame::dead}, {"follower", LoadFrame::follower}};

std::array<bool, 3> get_axes(const Teuchos::ParameterList& list, const std::string& name) {
  const auto& words = list.get<Teuchos::Array<std::string>>(name);
  std::array<bool, 3> axes{};
  for (std::size_t i = 0; i < 3; ++i) axes[i] = std::find(words.begin(), words.end(), kAxes[i]) != words.end();
  return axes;
}

/// One pass over what acts on a scene whose points and members are complete.
class ConditionReader {
 public:
  ConditionReader(const Teuchos::ParameterList& scene_list, const ParameterSource& source, const ParameterPath& path,
                  Scene& scene)
      : scene_list_(scene_list), source_(source), path_(path), scene_(scene), names_(scene) {}

  void read();

 private:
  using List = Teuchos::ParameterList;

  void read_supports();
  void read_point_loads();
  void read_distributed_loads();
  void check_stages();

  void check_support(const Support& support, const List& list, const ParameterPath& path);
  void check_follower(const PointLoad& load, const ParameterPath& path) const;
  void check_loaded(const List& list, const std::string& first, const std::string& second,
                    const ParameterPath& path) const;
  /// Throws unless `point` is a point that a member touches.
  void check_touched_point(const std::string& point, const ParameterPath& path) const;
  void use_stage(Stage stage, const ParameterPath& path) { stages_used_.emplace_back(stage, path); }

  const List& scene_list_;
  const ParameterSource& source_;
  const ParameterPath& path_;
  Scene& scene_;
  const SceneNames names_;
  std::unordered_map<std::string, std::string> support_at_;  ///< point -> name of its support
  std::vector<std::pair<Stage, ParameterPath>> stages_used_;
};

void ConditionReader::read() {
  read_supports();
  read_point_loads();
  read_distributed_loads();
  check_stages();
}

void ConditionReader::read_supports() {
  const List& supports = scene_list_.sublist("Supports");
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

void ConditionReader::check_support(const Support& support, const List& list, const ParameterPath& path) {
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

void ConditionReader::read_point_loads() {
  const List& loads = scene_list_.sublist("Point Loads");
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

void ConditionReader::check_follower(const PointLoad& load, const ParameterPath& path) const {
  const Member* const member = names_.member(load.member);
  if (member != nullptr && has_one_end_at(*member, load.point)) return;
  std::vector<std::string> touching;
  for (const Member* candidate : *names_.members_at(load.point)) {
    if (has_one_end_at(*candidate, load.point)) touching.push_back(candidate->name);
  }
  const bool closed = member != nullptr && member->start_point == load.point;
  const std::string seen =
      load.member.empty() ? "missing for a follower load" : "value \"" + excerpt(load.member) + "\"";
  throw source_.error(child(path, "Member"), seen + (closed ? " has both ends at the point" : "") +
                                                 "; allowed: a member with one end at \"" + excerpt(load.point) +
                                                 "\": " + quoted_list(touching) + did_you_mean(load.member, touching));
}

void ConditionReader::read_distributed_loads() {
  const List& loads = scene_list_.sublist("Distributed Loads");
  for (const std::string& name : names_of(loads)) {
    const List& list = loads.sublist(name);
    const ParameterPath path = child(child(path_, "Distributed Loads"), name);
    DistributedLoad load;
    load.member = list.get<std::string>("Member");
    load.force = get_vector(list, "Force");
    load.couple = get_vector(list, "Couple");
    load.stage = list.get<int>("Stage");
    if (names_.member(load.member) == nullptr)
      throw unknown_name(source_, child(path, "Member"), "member", load.member, names_.member_names());
    check_loaded(list, "Force", "Couple", path);
    use_stage(load.stage, child(path, "Stage"));
    scene_.distributed_loads.push_back(load);
  }
}

void ConditionReader::check_loaded(const List& list, const std::string& first, const std::string& second,
                                   const ParameterPath& path) const {
  if (is_given(list, first) || is_given(list, second)) return;
  throw source_.error(path, "loads nothing; allowed: \"" + first + "\" or \"" + second + "\" or both");
}

void ConditionReader::check_stages() {
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

void ConditionReader::check_touched_point(const std::string& point, const ParameterPath& path) const {
  if (names_.members_at(point) != nullptr) return;
  if (!names_.has_point(point)) throw unknown_name(source_, child(path, "Point"), "point", point, names_.point_names());
  throw source_.error(child(path, "Point"), "value \"" + excerpt(point) +
                                                "\": no member starts or ends there; allowed: "
                                                "points of members");
}

}  // namespace

void read_conditions(const Teuchos::ParameterList& scene_list, const ParameterSource& source, const ParameterPath& path,
                     Scene& scene) {
  ConditionReader(scene_list, source, path, scene).read();
}

}  // namespace mixbeam
