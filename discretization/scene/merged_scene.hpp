/// Several scenes as one, side by side without touching, to be solved together.
#pragma once

#include "discretization/scene/scene.hpp"

namespace mixbeam {

/// Scenes of one load case each and of the same number of stages, merged: members, supports, loads, ... of the first,
/// then those of the second, and so on, each in its own order.
struct MergedScene {
  Scene scene{};
  std::vector<int> part_of_member{};  ///< which of the scenes a member comes from

  /// Name in the merged scene of a point, section, member or joint of a part.
  static std::string name_in_part(int part, const std::string& name) { return std::to_string(part) + ":" + name; }
};

MergedScene merge_scenes(const std::vector<const Scene*>& scenes);

}  // namespace mixbeam
