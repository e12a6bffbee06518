#include "discretization/scene/names.hpp"

#include "discretization/text/message_text.hpp"

#include <algorithm>

namespace mixbeam {

SceneNames::SceneNames(const Scene& scene) : scene_(scene) {
  for (std::size_t i = 0; i < scene.points.size(); ++i) points_.emplace(scene.points[i].name, i);
  for (std::size_t i = 0; i < scene.members.size(); ++i) {
    const Member& member = scene.members[i];
    members_.emplace(member.name, i);
    members_at_[member.start_point].push_back(&member);
    members_at_[member.end_point].push_back(&member);
    for (const InnerPoint& inner : member.inner_points) members_at_[inner.point].push_back(&member);
  }
}

const Member* SceneNames::member(const std::string& name) const {
  const auto found = members_.find(name);
  return found == members_.end() ? nullptr : &scene_.members[found->second];
}

const std::vector<const Member*>* SceneNames::members_at(const std::string& point) const {
  const auto found = members_at_.find(point);
  return found == members_at_.end() ? nullptr : &found->second;
}

std::vector<std::string> SceneNames::member_names() const {
  std::vector<std::string> names;
  for (const Member& member : scene_.members)
    if (member.section != kRigidArm) names.push_back(member.name);
  return names;
}

std::vector<std::string> SceneNames::point_names() const {
  std::vector<std::string> names;
  for (const Point& point : scene_.points) {
    const std::vector<const Member*>* members = members_at(point.name);
    const auto ends_here = [&](const Member* one) { return one->section == kRigidArm && one->end_point == point.name; };
    if (members == nullptr || std::none_of(members->begin(), members->end(), ends_here)) names.push_back(point.name);
  }
  return names;
}

bool has_one_end_at(const Member& member, const std::string& point) {
  return (member.start_point == point) != (member.end_point == point);
}

InputError unknown_name(const InputPlace& place, const std::string& what, const std::string& name,
                        const std::vector<std::string>& known) {
  return place.error("value \"" + excerpt(name) + "\" is not a " + what +
                     " of the scene; allowed: " + quoted_list(known) + did_you_mean(name, known) +
                     (has_wildcard(name) ? "; in patterns " + kWildcards : ""));
}

}  // namespace mixbeam
