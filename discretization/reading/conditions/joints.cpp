/// The part of ConditionReader that reads joints.

#include "discretization/geometry/vector_algebra.hpp"
#include "discretization/parameters/access.hpp"
#include "discretization/reading/conditions/condition_reader.hpp"
#include "discretization/text/message_text.hpp"
#include "discretization/text/name_pattern.hpp"
#include "discretization/text/nearest_name.hpp"
#include "discretization/text/number_text.hpp"

#include <algorithm>

namespace mixbeam {
namespace {

using namespace vector_algebra;

const std::map<std::string, JointKind> kKinds = {
    {"hinge", JointKind::hinge}, {"ball", JointKind::ball}, {"slider", JointKind::slider}};

}  // namespace

void ConditionReader::read_joints() {
  const List& joints = scene_list_.sublist("Joints");
  for (const std::string& name : names_of(joints)) {
    const List& list = joints.sublist(name);
    Joint joint = read_joint(list, child(child(path_, "Joints"), name));
    joint.name = name;
    scene_.joints.push_back(joint);
  }
  // Only now: several joints at a point must not take its last member.
  for (const Joint& joint : scene_.joints) check_someone_is_left(joint);
}

void ConditionReader::check_someone_is_left(const Joint& joint) const {
  std::set<std::string> touching;
  for (const Member* member : *names_.members_at(joint.point)) touching.insert(member->name);
  if (joined_at_.at(joint.point).size() < touching.size()) return;
  throw source_.error(child(child(child(path_, "Joints"), joint.name), "Members"),
                      "all members at \"" + excerpt(joint.point) +
                          "\" are in joints, and none is left that they could be joined to; allowed: at least one of "
                          "them not listed");
}

Joint ConditionReader::read_joint(const List& list, const ParameterPath& path) {
  Joint joint;
  joint.point = list.get<std::string>("Point");
  joint.kind = translated(list, "Kind", kKinds);
  joint.stiffness = list.get<double>("Stiffness");
  if (names_.members_at(joint.point) == nullptr)
    throw unknown_name(source_, child(path, "Point"), "point with members", joint.point, names_.point_names());
  check_joint_axis(list, path);
  if (joint.kind != JointKind::ball) joint.axis = get_vector(list, "Axis");
  for (const std::string& text : list.get<Teuchos::Array<std::string>>("Members")) join(text, joint, path);
  joint.together = list.get<bool>("Together");
  if (joint.together && joint.members.size() < 2)
    throw source_.error(child(path, "Together"), "value true, but \"Members\" names only \"" +
                                                     excerpt(joint.members.front()) +
                                                     "\"; allowed: for two members or more");
  return joint;
}

/// A ball has neither axis nor spring, the others need an axis.
void ConditionReader::check_joint_axis(const List& list, const ParameterPath& path) const {
  const bool ball = list.get<std::string>("Kind") == "ball";
  for (const std::string parameter : {"Axis", "Stiffness"}) {
    if (ball && is_given(list, parameter))
      throw source_.error(child(path, parameter), "given, but has no meaning for a ball; allowed: hinge, slider");
  }
  if (ball) return;
  if (!list.isParameter("Axis"))
    throw source_.error(child(path, "Axis"),
                        "missing; needed for \"Kind\" = \"" + list.get<std::string>("Kind") + "\"");
  const Vector3 axis = get_vector(list, "Axis");
  if (norm(axis) >= kShortestLength) return;
  throw source_.error(child(path, "Axis"),
                      "value " + to_text(axis) + " has no direction; allowed: any vector but zero");
}

/// Adds the members that `text` means.
void ConditionReader::join(const std::string& text, Joint& joint, const ParameterPath& joint_path) {
  const ParameterPath path = child(joint_path, "Members");
  std::vector<std::string> candidates;
  for (const Member* member : *names_.members_at(joint.point))
    if (has_one_end_at(*member, joint.point)) candidates.push_back(member->name);
  const std::vector<std::string> meant = names_meant(text, candidates);
  if (meant.empty() && names_.member(text) == nullptr && !has_wildcard(text))
    throw unknown_name(source_, path, "member", text, names_.member_names());
  if (meant.empty()) {
    throw source_.error(path, "value \"" + excerpt(text) + "\"; allowed: members with one end at \"" +
                                  excerpt(joint.point) + "\": " + quoted_list(candidates) +
                                  did_you_mean(text, candidates));
  }
  count(meant.size(), path);
  for (const std::string& member : meant) {
    if (!joined_at_[joint.point].insert(member).second) {
      throw source_.error(path, "member \"" + excerpt(member) + "\" is in a joint at \"" + excerpt(joint.point) +
                                    "\" already; allowed: once");
    }
    joint.members.push_back(member);
  }
}

}  // namespace mixbeam
