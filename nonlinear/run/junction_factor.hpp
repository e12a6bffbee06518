/// How large the factors of the matrix become that chains leave, from the scene alone.
#pragma once

#include "discretization/scene/scene.hpp"

namespace mixbeam {

struct JunctionFactor {
  double entries = 0.0;     ///< numbers of the factor L of L D L^T
  double operations = 0.0;  ///< multiplications of a factorisation
  double matrix = 0.0;      ///< numbers of the matrix, both triangles
  double junctions = 0.0;   ///< vertices that chains leave
};

/// Symbolic factorisation over the junctions, supports and loaded points of the scene in the order of METIS' nested
/// dissection. Where the factor is larger than any machine holds it is not followed to its end: a lower bound.
JunctionFactor junction_factor(const Scene& scene);

}  // namespace mixbeam
