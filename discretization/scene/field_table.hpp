/// Vectors along a member given by their values at points, element by element: strains computed elsewhere.
#pragma once

#include "kernels/math/vector_algebra.hpp"

#include <vector>

namespace mixbeam {

/// Polynomial in each piece through its values, so that a mesh reads back unchanged the values at its Gauss points.
struct FieldTable {
  struct Piece {
    std::vector<double> s{};  ///< arc lengths from the start of the member, ascending
    std::vector<Vector3> value{};
  };
  std::vector<Piece> pieces{};  ///< ascending, one at least

  /// Value in the piece that contains s, or in the nearest one.
  Vector3 at(double s) const;
};

}  // namespace mixbeam
