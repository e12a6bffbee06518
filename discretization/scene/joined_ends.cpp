#include "discretization/scene/joined_ends.hpp"

#include "kernels/math/vector_algebra.hpp"

#include <cmath>
#include <stdexcept>
#include <unordered_map>

namespace mixbeam {

namespace {

[[noreturn]] void refuse(const Joint& joint, const std::string& reason) {
  throw std::invalid_argument("joint \"" + joint.name + "\" at point \"" + joint.point + "\": " + reason);
}

int joined_member(const Scene& scene, const Joint& joint, const std::string& name,
                  const std::unordered_map<std::string, int>& members) {
  const auto found = members.find(name);
  if (found == members.end()) refuse(joint, "there is no member named \"" + name + "\"");
  const Member& member = scene.members[found->second];
  const int ends = (member.start_point == joint.point) + (member.end_point == joint.point);
  if (ends != 1)
    refuse(joint, "member \"" + name + "\" has " + (ends == 0 ? "no end" : "both ends") +
                      " there; a joint takes members with one end at its point");
  return found->second;
}

/// Number of times that members meet each point, with ends and inner points.
std::map<std::string, int> passages(const Scene& scene, const JointTable& table) {
  std::map<std::string, int> count;
  for (const auto& entry : table) count[entry.first] = 0;
  const auto see = [&](const std::string& point) {
    const auto found = count.find(point);
    if (found != count.end()) ++found->second;
  };
  for (const Member& member : scene.members) {
    see(member.start_point);
    see(member.end_point);
    for (const InnerPoint& inner : member.inner_points) see(inner.point);
  }
  return count;
}

}  // namespace

JointTable joined_ends(const Scene& scene) {
  JointTable table;
  if (scene.joints.empty()) return table;
  std::unordered_map<std::string, int> members;
  for (std::size_t m = 0; m < scene.members.size(); ++m) members.emplace(scene.members[m].name, static_cast<int>(m));
  for (std::size_t j = 0; j < scene.joints.size(); ++j) {
    const Joint& joint = scene.joints[j];
    if (joint.members.empty()) refuse(joint, "it lists no member");
    std::vector<JoinedEnd>& ends = table[joint.point];
    for (const std::string& name : joint.members) {
      const int member = joined_member(scene, joint, name, members);
      for (const JoinedEnd& other : ends)
        if (other.member == member) refuse(joint, "member \"" + name + "\" is joined there twice");
      const bool shares = joint.together && !ends.empty() && ends.back().joint == static_cast<int>(j);
      ends.push_back({static_cast<int>(j), member, shares});
    }
  }
  const std::map<std::string, int> count = passages(scene, table);
  for (const Joint& joint : scene.joints)
    if (static_cast<std::size_t>(count.at(joint.point)) <= table.at(joint.point).size())
      refuse(joint,
             "all members there are joined on their own; at least one must be left that supports and loads of the "
             "point act on");
  return table;
}

Axes joint_frame(const Joint& joint) {
  const Vec3<double> axis = vector_algebra::to_vec3(joint.axis);
  const double length = norm(axis);
  if (!(length > 0.0)) throw std::invalid_argument("joint \"" + joint.name + "\": its axis has no direction");
  const Vec3<double> a = (1.0 / length) * axis;
  int smallest = 0;
  for (int i = 1; i < 3; ++i)
    if (std::abs(a[i]) < std::abs(a[smallest])) smallest = i;
  Vec3<double> across{{0.0, 0.0, 0.0}};
  across[smallest] = 1.0;
  const Vec3<double> normal = cross(a, across), b1 = (1.0 / norm(normal)) * normal, b2 = cross(a, b1);
  using vector_algebra::to_array;
  return {to_array(b1), to_array(b2), to_array(a)};
}

}  // namespace mixbeam
