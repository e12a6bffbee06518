/// A curved member as a chain of straight ones.
#pragma once

#include "discretization/scene/scene.hpp"

namespace mixbeam {

/// Every circular arc replaced by straight members of one element each, between the vertices that the elements of the
/// arc have. The corners are kinks of the undeformed structure.
Scene with_polygons(const Scene& scene);

}  // namespace mixbeam
