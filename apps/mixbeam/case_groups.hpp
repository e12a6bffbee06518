/// Which cases of a batch are solved side by side.
#pragma once

#include "discretization/scene/scene.hpp"

#include <cstddef>
#include <vector>

namespace mixbeam {

/// Cases of a group differ by this factor at most in length, in load, and in the load that their stiffness takes
/// (EI / L^2): one Newton iteration and one limit of rotations serve all of them, and residuals are scaled with what is
/// largest in the group. With 2 a decade of loads makes four groups.
inline constexpr double kLikeness = 2.0;

/// Elements of a group: enough for all threads and vector lanes; with more, memory and what one failing case costs its
/// neighbours grow.
inline constexpr int kElementsPerGroup = 40'000;

/// Properties that decide which cases are alike.
struct CaseLikeness {
  std::vector<long> structure{};                     ///< stages, and numbers and kinds of all that a scene holds
  double length = 0.0, load = 0.0, stiffness = 0.0;  ///< load and EI / L^2 are forces
  int elements = 0;
};

CaseLikeness likeness_of(const Scene& scene);

/// Every case in one group, its neighbours there as like it as can be. The groups do not depend on the number of
/// threads.
std::vector<std::vector<std::size_t>> group_cases(const std::vector<CaseLikeness>& cases);

}  // namespace mixbeam
