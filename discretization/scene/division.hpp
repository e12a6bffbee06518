/// Vertices of a member: equal elements, elements between inner points, or stations given by the user.
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

/// Distance, over the member's length, up to which an inner point is a station: positions are written with a dozen
/// digits.
constexpr double kStationTolerance = 1e-9;

/// Vertices of a member: its `stations`, or its `elements` distributed over the pieces between inner points: one for
/// each piece, and each further one where the elements are longest, so that lengths are as equal as the inner points
/// permit. There are more elements than requested if there are more pieces. Throws std::invalid_argument for positions
/// that do not ascend inside (0, 1), for stations that do not ascend from 0 to 1, for a number of stations other than
/// elements + 1, and for an inner point that is not a station.
ElementDivision divide(const Member& member);

}  // namespace mixbeam
