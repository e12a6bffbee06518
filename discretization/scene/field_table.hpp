/// Vectors along a member given by their values at points, element by element: strains that follow from a computation.
#pragma once

#include "kernels/math/vector_algebra.hpp"

#include <vector>

namespace mixbeam {

/// In each piece the polynomial through its values, so that the mesh from whose Gauss points they come reads them back
/// without a change.
struct FieldTable {
  struct Piece {
    std::vector<double> s{};  ///< arc lengths from the start of the member, ascending
    std::vector<Vector3> value{};
  };
  std::vector<Piece> pieces{};  ///< ascending, one at least

  /// In the piece that holds s, or is next to it.
  Vector3 at(double s) const;
};

}  // namespace mixbeam
