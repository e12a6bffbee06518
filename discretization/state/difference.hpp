/// States as estimates of the error need them: how far apart two of one discretization are, and rotations inside
/// elements made more accurate by those of their vertices.
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
  std::vector<ElementDifference> elements{};   ///< (local element)
  std::vector<Vector3> vertex_displacement{};  ///< (owned vertex), second state less first
  // Over all ranks:
  double largest_displacement = 0.0;  ///< |u| of the second state at any vertex or middle of an element
  double largest_change = 0.0;        ///< of the displacement of a vertex
  int farthest_vertex = 0;            ///< whose it is, the first of equal ones
};

/// Measures the difference of two states: the same numbers for any number of ranks and threads. Collective.
StateDifference difference(const Model& model, const State& first, const State& second);

/// The increment that leads from one state to another, as Model::apply takes it: a function of their bits, and of how
/// `near` they are only by whole turns. The way that has led there, a sum of increments, tells how often rotations went
/// around; a path that goes on from a file knows it but for its rounding.
MixedVector increment_between(const Model& model, const State& first, const State& second, const MixedVector& near);

/// A state whose orders were raised by one, with the relative rotation that the new degree has room for.
///
/// In a solution of order k the rotation Lambda_E of an element differs from the exact one by about c P_k(xi), an error
/// of h^k, while the vertices are right to h^2k. So the jumps phi at the ends are c and (-1)^k c up to higher orders,
/// which gives psi_k by theory (51). The slope of the centerline follows its tangent.
///
/// `raised`: (member) elements of which members have it done.
State with_recovered_rotations(const Model& model, const State& state, const std::vector<unsigned char>& raised);

}  // namespace mixbeam
