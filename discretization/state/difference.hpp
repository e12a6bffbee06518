/// Operations on states for error estimates: the difference of two states of one discretization, and a correction of
/// rotations inside elements by those of their vertices.
#pragma once

#include "discretization/assembly/model.hpp"

#include <vector>

namespace mixbeam {

/// int |.|^2 ds over one element, and the displacement of its middle.
struct ElementDifference {
  double displacement = 0.0, moment = 0.0;            ///< of u and of M (material components), second state minus first
  double displacement_size = 0.0, moment_size = 0.0;  ///< of the second state itself
  double middle = 0.0;                                ///< |u| of the second state at the middle
};

struct StateDifference {
  std::vector<ElementDifference> elements{};   ///< (local element)
  std::vector<Vector3> vertex_displacement{};  ///< (owned vertex), second state minus first
  // Over all ranks:
  double largest_displacement = 0.0;  ///< largest |u| of the second state at a vertex or element midpoint
  double largest_change = 0.0;        ///< largest change of displacement of a vertex
  int farthest_vertex = 0;            ///< vertex of the largest change, the first of equal ones
};

/// Measures the difference of two states, with the same bits for any number of ranks and threads. Collective.
StateDifference difference(const Model& model, const State& first, const State& second);

/// Increment from one state to another, for Model::apply: a function of their bits, and of `near` only by whole turns.
/// The sum of increments along the path determines how many turns rotations made; a path resumed from a file knows it
/// up to rounding.
MixedVector increment_between(const Model& model, const State& first, const State& second, const MixedVector& near);

/// State whose orders were raised by one, with the relative rotation of the new degree recovered.
///
/// In a solution of order k the rotation Lambda_E of an element differs from the exact one by about c P_k(xi), an error
/// of h^k, while vertices are accurate to h^2k. The jumps phi at the ends are thus c and (-1)^k c up to higher orders,
/// which gives psi_k by theory (51). The slope of the centerline follows its tangent.
///
/// `raised`: (member) 1 if its elements are to be corrected.
State with_recovered_rotations(const Model& model, const State& state, const std::vector<unsigned char>& raised);

}  // namespace mixbeam
