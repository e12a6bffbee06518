/// The rods of the helix experiment: changes of the scene that the XML file gives.
#pragma once

#include "apps/helix/exact_helix.hpp"
#include "discretization/scene/scene.hpp"

namespace mixbeam {

/// L / (2 r) of a rod of circular section, for which EI / EA = r^2 / 4.
double slenderness_of(const Scene& scene, const ExactHelix& exact);

/// The same rod of another slenderness: its radius changes, E and G stay, and the moment that winds it grows with EI.
Scene with_slenderness(Scene scene, double slenderness, const ExactHelix& exact);

/// As the paper has it: the rod lies along e1 and its clamp turns by -arctan(c) about e2 while the moment grows.
Scene with_turned_clamp(Scene scene, const ExactHelix& exact);

}  // namespace mixbeam
