/// How large the factors of the matrix become that chains leave, from the scene alone.
#pragma once

#include "discretization/scene/scene.hpp"

#include <limits>

namespace mixbeam {

struct JunctionFactor {
  double entries = 0.0;     ///< numbers of the factor L of L D L^T
  double operations = 0.0;  ///< multiplications of a factorisation
  double matrix = 0.0;      ///< numbers of the matrix, both triangles
  double junctions = 0.0;   ///< vertices that chains leave
  bool is_larger = false;   ///< than asked for: then entries and operations are zero
};

/// Symbolic factorisation over the junctions, supports and loaded points of the scene in the order of METIS' nested
/// dissection. Where the factor is larger than any machine holds it is not followed to its end: a lower bound. With
/// more than `most` entries by factor_entries(), in network_solver.hpp, it is not followed at all.
JunctionFactor junction_factor(const Scene& scene, double most = std::numeric_limits<double>::infinity());

}  // namespace mixbeam
