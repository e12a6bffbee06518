/// The part of ConditionReader that reads joints.

#include "discretization/reading/conditions/condition_reader.hpp"
#include "discretization/scene/limits.hpp"
#include "discretization/text/message_text.hpp"

#include <algorithm>

namespace mixbeam {
namespace {

BoundList<Joint> joint_parameters() {
  BoundList<Joint> joint(
      "A connection that is not rigid: each listed member ends in its own joint with the rest of what meets at the "
      "point; "
      "members not listed stay rigidly connected, and supports and loads of the point act on them.");
  joint.bind(&Joint::point, text("Point").required(), "Name of the point.");
  joint.bind(&Joint::members, array("Members", ParameterType::text_array).required(),
             "Names of members that have one end at the point, like {strut 1, strut 2}" + kWildcard);
  joint.bind(
      &Joint::kind, text("Kind").required(),
      "hinge: free rotation about Axis; ball: free rotation about any axis; slider: free translation along Axis, "
      "no rotation.",
      {{"hinge", JointKind::hinge}, {"ball", JointKind::ball}, {"slider", JointKind::slider}});
  joint.bind(&Joint::axis, direction("Axis"),
             "hinge, slider: direction in the undeformed structure, in global components, of any length; it rotates "
             "with the members not listed.");
  joint.bind(&Joint::stiffness, real("Stiffness").at_least(0.0).by_default(),
             "hinge, slider: of a spring against the free motion [force * length / radian, force / length].");
  joint.bind(&Joint::together, boolean("Together").by_default(),
             "Whether the listed members stay rigidly connected to each other and share one joint, like the halves of "
             "a bar that crosses another one at a pin; otherwise each has its own.");
  const Form about_axis{{"Axis"}, {"Stiffness"}};
  joint.spec.with_forms("Kind", {{"hinge", {about_axis}}, {"slider", {about_axis}}, {"ball", {Form{}}}});
  return joint;
}

}  // namespace

const BoundList<Joint> kJointParameters = joint_parameters();
void ConditionReader::read_joints() {
  for_each("Joints", [this](const std::string& name, const List& list, const InputPlace& place) {
    scene_.joints.push_back(read_joint(list, place));
    scene_.joints.back().name = name;
  });
  copy_joints();
  if (place_.source().has_mistakes()) return;
  // Only now: several joints at a point must not take its last member.
  for (const Joint& joint : scene_.joints) check_someone_is_left(joint);
}

bool ConditionReader::is_someone_left(const Joint& joint) const {
  std::set<std::string> touching;
  for (const Member* member : *names_.members_at(joint.point)) touching.insert(member->name);
  return joined_at_.at(joint.point).size() < touching.size();
}

void ConditionReader::check_someone_is_left(const Joint& joint) const {
  if (is_someone_left(joint)) return;
  throw place_["Joints"][joint.name]["Members"].error(
      "all members at \"" + excerpt(joint.point) +
      "\" are in joints, and none is left that they could be joined to; allowed: at least one of them not listed");
}

Joint ConditionReader::read_joint(const List& list, const InputPlace& place) {
  Joint joint = kJointParameters.read(list);
  if (names_.members_at(joint.point) == nullptr)
    throw unknown_name(place["Point"], "point with members", joint.point, names_.point_names());
  for (const std::string& text : std::exchange(joint.members, {})) join(text, joint, place);
  if (joint.together && joint.members.size() < 2)
    throw place["Together"].error("value true, but \"Members\" names only \"" + excerpt(joint.members.front()) +
                                  "\"; allowed: for two members or more");
  return joint;
}

/// Adds the members that `text` means.
void ConditionReader::join(const std::string& text, Joint& joint, const InputPlace& joint_place) {
  const InputPlace place = joint_place["Members"];
  std::vector<std::string> candidates;
  for (const Member* member : *names_.members_at(joint.point))
    if (has_one_end_at(*member, joint.point)) candidates.push_back(member->name);
  const std::vector<std::string> meant = names_meant(text, candidates);
  if (meant.empty() && names_.member(text) == nullptr && !has_wildcard(text))
    throw unknown_name(place, "member", text, names_.member_names());
  if (meant.empty()) {
    throw place.error("value \"" + excerpt(text) + "\"; allowed: members with one end at \"" + excerpt(joint.point) +
                      "\": " + quoted_list(candidates) + did_you_mean(text, candidates));
  }
  count(meant.size(), place);
  for (const std::string& member : meant) {
    if (!joined_at_[joint.point].insert(member).second) {
      throw place.error("member \"" + excerpt(member) + "\" is in a joint at \"" + excerpt(joint.point) +
                        "\" already; allowed: once");
    }
    joint.members.push_back(member);
  }
}

}  // namespace mixbeam
