/// Checks that supports and joints hold every part of the structure.
#pragma once

#include "discretization/parameters/source.hpp"
#include "discretization/scene/scene.hpp"

#include <string>
#include <vector>

namespace mixbeam {

/// Throws InputError if anything can move without strain in the undeformed structure: a connected part as a rigid body,
/// or parts against each other in their joints (a bar between two ball joints spins about its own axis). Supports in
/// any axes and springs hold, too. The message names the members, the motion and the point that moves most. `path`:
/// place of the scene below the root of `source`. Returns the reason if joints were left out of the check, else
/// nothing: the elimination is dense, so the number of joined parts is limited.
std::string check_supports(const Scene& scene, const ParameterSource& source, const ParameterPath& path = {"Scene"});

/// Velocity of a rigid body: translation + rotation x (position - center).
struct RigidVelocity {
  Vector3 translation{}, rotation{}, center{};
};

/// Parts and motions of a structure that is not held, for pictures.
struct LooseStructure {
  std::vector<int> part_of_member{};                  ///< connected parts, joints included, are numbered from 0
  std::vector<std::vector<RigidVelocity>> motions{};  ///< without strain; (motion, member)
};

/// The motions that check_supports() refuses, at most kMostShownMotions.
LooseStructure loose_structure(const Scene& scene);
inline constexpr std::size_t kMostShownMotions = 12;

}  // namespace mixbeam
