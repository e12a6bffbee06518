/// A structure as rigid parts that joints connect, which move without any strain.
#pragma once

#include "discretization/scene/scene.hpp"

#include <cstddef>
#include <string>
#include <vector>

namespace mixbeam {

/// Members that are rigidly joined, with the points and supports on them. A point with joints is on several parts; its
/// support is on the part of the members that the joints do not list.
struct RigidPart {
  std::vector<std::size_t> members;   ///< in Scene::members
  std::vector<std::size_t> supports;  ///< in Scene::supports
  std::vector<std::string> points;    ///< names, in the order in which the members meet them
  std::vector<Vector3> positions;     ///< of `points`
  Vector3 center{};                   ///< mean of the positions
  double size = 0.0;                  ///< largest distance from the centre
};

/// One end of a member at a joint, or several that stay together.
struct RigidLink {
  std::size_t master = 0, slave = 0;  ///< parts of the assembly
  std::size_t joint = 0;              ///< in Scene::joints
  Vector3 position{};
};

/// Parts that are connected through joints; without joints a single part.
struct RigidAssembly {
  std::vector<RigidPart> parts;
  std::vector<RigidLink> links;
};

/// None where a member has numbers that make no curve. Throws as build_mesh does for members without a place and joints
/// that join nothing.
std::vector<RigidAssembly> rigid_assemblies(const Scene& scene);

}  // namespace mixbeam
