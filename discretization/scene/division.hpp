/// Where the vertices of a member are: equal elements, elements between inner points, or stations that a user gives.
#pragma once

#include "discretization/scene/scene.hpp"

#include <vector>

namespace mixbeam {

struct ElementDivision {
  std::vector<double> station;    ///< relative arc length of every vertex: 0, ascending, 1
  std::vector<int> inner_vertex;  ///< place in `station` of every inner point of the member
  bool is_equal = false;          ///< all elements have the same length: station i is i / elements

  int elements() const { return static_cast<int>(station.size()) - 1; }
};

/// An inner point counts as one of the stations up to this share of the member's length: positions are written with a
/// dozen digits.
constexpr double kStationTolerance = 1e-9;

/// Vertices of a member, its `stations` or else its `elements` shared out between the inner points: one element for
/// each piece between two of them, and each further element where the elements are longest, so that the lengths come
/// out as equal as the inner points permit. There are more elements than the member asks for when it has more pieces.
/// Throws std::invalid_argument for positions that do not ascend inside (0, 1), for stations that do not ascend from 0
/// to 1, for a number of stations other than elements + 1, and for an inner point that is no station.
ElementDivision divide(const Member& member);

}  // namespace mixbeam
