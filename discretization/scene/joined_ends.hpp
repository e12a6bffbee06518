/// Which ends of members the joints of a scene connect.
#pragma once

#include "discretization/scene/scene.hpp"

#include <map>
#include <string>
#include <vector>

namespace mixbeam {

struct JoinedEnd {
  int joint = 0;        ///< in Scene::joints
  int member = 0;       ///< in Scene::members
  bool shares = false;  ///< the vertex of the end before it, in a joint of ends that stay together
};

/// By the name of the point, in the order of the scene.
using JointTable = std::map<std::string, std::vector<JoinedEnd>>;

/// Throws std::invalid_argument when a joint lists no member, one that is unknown, that does not have exactly one end
/// at the point, or that another joint has there already, and when no member is left for the rest of the point.
JointTable joined_ends(const Scene& scene);

}  // namespace mixbeam
