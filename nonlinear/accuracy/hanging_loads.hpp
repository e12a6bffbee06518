/// Loads that statics alone hands to single elements.
#pragma once

#include "discretization/mesh/mesh.hpp"

#include <optional>
#include <vector>

namespace mixbeam {

/// Sums of loads by their sizes, whatever their directions, and where they act on average.
struct LoadSum {
  double force = 0.0, moment = 0.0;
  Vector3 force_moment{};  ///< sum of |force| x place

  void add(const LoadSum& other);
  Vector3 place() const;  ///< of a force that is not zero
};

/// (mesh element): the loads that it carries to the supports alone, because without it they would have none; nothing
/// for elements beside which others carry. `load`: (vertex). Supported vertices are the ends of all ways; joints lead
/// on like rigid corners.
std::vector<std::optional<LoadSum>> hanging_loads(const Scene& scene, const Mesh& mesh,
                                                  const std::vector<LoadSum>& load);

}  // namespace mixbeam
