/// Difference of two solutions of the same structure on different meshes.
#pragma once

#include "nonlinear/run/simulation.hpp"

#include <vector>

namespace mixbeam {

/// Displacement at equally spaced places of the whole structure, member after member: `points_per_member` places from
/// start to end of each. `elements_per_member`: of the members before any of them was replaced by a polygon; it divides
/// points_per_member - 1. Complete on rank 0, empty on the others. Collective.
std::vector<Vector3> displacement_field(const Simulation& simulation, int elements_per_member, int points_per_member);

/// Root of the mean square of the difference over all members, which have about the same length. The same on all ranks.
double mean_difference(const std::vector<Vector3>& a, const std::vector<Vector3>& b, int points_per_member,
                       const Communicator& communicator);

}  // namespace mixbeam
