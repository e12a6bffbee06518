/// Which cases of a batch are solved side by side.
#pragma once

#include "apps/mixbeam/case_scenes.hpp"

namespace mixbeam {

/// Cases of a group differ by this factor at most in length, in load, and in the load that their stiffness takes
/// (EI / L^2): one Newton iteration and one limit of rotations serve all of them, and residuals are scaled with what is
/// largest in the group. With 2 a decade of loads makes four groups.
inline constexpr double kLikeness = 2.0;

/// Elements of a group: enough for all threads and vector lanes; with more, memory and what one failing case costs its
/// neighbours grow.
inline constexpr int kElementsPerGroup = 40'000;

/// The scenes of all cases of a batch, and which of them are solved side by side.
struct GroupedCases {
  std::vector<Scene> scenes{};
  std::vector<std::vector<std::size_t>> groups{};
};

/// Every case in one group, its neighbours there as like it as can be. The groups do not depend on the number of
/// threads. Throws as CaseScenes.
GroupedCases grouped_cases(CaseScenes& scenes, std::size_t cases);

}  // namespace mixbeam
