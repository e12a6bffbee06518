/// The same scene in a space that holds more: what the error of a discretization is measured with.
#pragma once

#include "discretization/mesh/mesh.hpp"

namespace mixbeam {

struct RicherScene {
  Scene scene;
  std::vector<unsigned char> is_halved;  ///< (member): two elements in place of each one, else one order more
};

/// One order more in every member; where the order is the highest there is, two elements of it in place of each one.
/// `mesh`: that of `scene`.
RicherScene richer_scene(const Scene& scene, const Mesh& mesh);

}  // namespace mixbeam
