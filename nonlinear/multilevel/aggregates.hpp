/// Groups of neighbouring nodes of a network, groups of those, and so on: the parts of the coarse spaces of
/// hierarchy.hpp.
#pragma once

#include "discretization/scene/scene.hpp"

#include <array>
#include <vector>

namespace mixbeam {

/// Two nodes for each link.
using LinkEnds = std::vector<std::array<int, 2>>;

/// Nodes of each level are numbered so that those of an aggregate follow each other, and neighbours lie close in memory
/// on every level.
struct Nesting {
  std::vector<int> order;               ///< (place on the finest level): number of the node
  std::vector<std::vector<int>> first;  ///< (level)(aggregate, and one more): place of its first node
};

/// Aggregates of about eight nodes, theory (63), level by level until the graph is small or coarsens no more: cubes
/// where the network is a cubic lattice, displaced or not. `places`: of the nodes. Deterministic.
Nesting nest(const std::vector<Vector3>& places, const LinkEnds& ends);

}  // namespace mixbeam
