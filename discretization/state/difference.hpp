/// How far apart two states of one discretization are, element by element and vertex by vertex.
#pragma once

#include "discretization/assembly/model.hpp"

#include <vector>

namespace mixbeam {

/// int |.|^2 ds over one element, and how far its middle has moved.
struct ElementDifference {
  double displacement = 0.0, moment = 0.0;            ///< of u and of M (material components), second state less first
  double displacement_size = 0.0, moment_size = 0.0;  ///< of the second state itself
  double middle = 0.0;                                ///< |u| of the second state there
};

struct StateDifference {
  std::vector<ElementDifference> elements{};   ///< (mesh element)
  std::vector<Vector3> vertex_displacement{};  ///< (vertex), second state less first
  double largest_displacement = 0.0;           ///< |u| of the second state at any vertex or middle of an element
};

/// Complete on every rank, the same for any number of ranks and threads. Collective.
StateDifference difference(const Model& model, const State& first, const State& second);

}  // namespace mixbeam
