/// Ends of members that the joints of a scene connect.
#pragma once

#include "discretization/scene/scene.hpp"

#include <map>
#include <string>
#include <vector>

namespace mixbeam {

struct JoinedEnd {
  int joint = 0;        ///< in Scene::joints
  int member = 0;       ///< in Scene::members
  bool shares = false;  ///< has the vertex of the end before it: Joint::together
};

/// Joined ends by the name of the point, in the order of the scene.
using JointTable = std::map<std::string, std::vector<JoinedEnd>>;

/// Throws std::invalid_argument if a joint lists no member, or one that is unknown, does not have exactly one end at
/// the point, or is in another joint there, and if all members at the point are listed.
JointTable joined_ends(const Scene& scene);

/// A right-handed orthonormal frame whose third direction is the axis; the first two do not depend on its length.
/// Throws std::invalid_argument where the axis is zero.
Axes joint_frame(const Joint& joint);

/// Whether a joint constrains a relative displacement (0 to 2) or rotation (3 to 5) in its frame.
inline bool joint_holds(JointKind kind, int component) {
  if (kind == JointKind::slider) return component != 2;
  return component < (kind == JointKind::hinge ? 5 : 3);
}

}  // namespace mixbeam
