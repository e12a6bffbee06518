/// Transfer of a state between two discretizations of one scene: the same members on the same curves, with other
/// elements or orders.
#pragma once

#include "discretization/state/snapshot.hpp"

namespace mixbeam {

/// Scene and its mesh.
struct Discretization {
  const Scene& scene;
  const Mesh& mesh;
};

/// Transfers the fields of `state` to the elements of another mesh, which need not be finer or nested.
///
/// Displacement: values at the vertices; inside an element the slope is projected (L2) on the polynomials of its
/// degree. N and M: projected likewise, N on the polynomial through its Gauss points. Rotations: the change since the
/// undeformed state is transferred, Lambda_E(s) Lambda_E0(s)^T, with the discrete undeformed rotations Lambda_E0 of
/// each mesh; Lambda_lo and psi are fitted to it (mean of psi zero). A vertex of both meshes keeps its Lambda_V, which
/// is not a value of Lambda_E; a new one inside an element rotates with Lambda_E.
///
/// An undeformed state thus remains undeformed and a rigid motion the same rigid motion, and the part of the old fields
/// that the new elements can represent is transferred to rounding: all of it where elements coincide and no order is
/// lowered, except for a relative rotation whose Lambda_E0 changes with the order (curvature that varies along the
/// member, and order 1 on an arc).
///
/// Throws std::invalid_argument if the two are not meshes of one scene, or if the state rotates by more than about half
/// a turn inside a new element.
StateSnapshot transfer(const Discretization& from, const StateSnapshot& state, const Discretization& to);

/// Transfers between models, on any number of ranks: locally if all elements coincide and have the same distribution,
/// else through rank 0. Collective.
State transfer(const Model& from, const State& state, const Model& to);

}  // namespace mixbeam
