/// How far the loads bend a structure: a guess without solving anything, to choose a start mesh with.
#pragma once

#include "discretization/mesh/mesh.hpp"

#include <vector>

namespace mixbeam {

/// (member): angle that it seems to turn by from its start to its end, judged by the errors of its elements. `mesh`:
/// any one of the scene. [radian]
std::vector<double> turning_by_loads(const Scene& scene, const Mesh& mesh);

/// Compliance of a member in bending and twisting: 1 / EI or 1 / GIt, the larger one.
double bending_compliance(const Scene& scene, const Member& member);

}  // namespace mixbeam
