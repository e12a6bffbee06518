/// Rotations inside elements, made more accurate by those of their vertices.
#pragma once

#include "discretization/assembly/model.hpp"

#include <vector>

namespace mixbeam {

/// A state whose orders were raised by one, with the relative rotation that the new degree has room for.
///
/// In a solution of order k the rotation Lambda_E of an element differs from the exact one by about c P_k(xi), an error
/// of h^k, while the vertices are right to h^2k. So the jumps phi at the ends are c and (-1)^k c up to higher orders,
/// which gives psi_k by theory (51). The slope of the centerline follows its tangent.
///
/// `raised`: (member) elements of which members have it done.
State with_recovered_rotations(const Model& model, const State& state, const std::vector<unsigned char>& raised);

}  // namespace mixbeam
