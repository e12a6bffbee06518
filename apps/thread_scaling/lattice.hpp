/// Lattices of equal struts, whose junctions stay when chains are gone.
#pragma once

#include "discretization/scene/scene.hpp"

#include <string>
#include <vector>

namespace mixbeam {

/// "cubic", "octet" (of face-centred cubes), "sheet" (squares in the plane of x and y).
const std::vector<std::string>& lattice_kinds();

/// Makes a lattice with about as many elements as asked for, two for each strut. Struts have the first section of
/// `scene` and a slenderness of 20; junctions on one side are clamped, a small force across pulls at each of those on
/// the opposite one.
Scene lattice_scene(const Scene& scene, const std::string& kind, int elements, int order);

}  // namespace mixbeam
