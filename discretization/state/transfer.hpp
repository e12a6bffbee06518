/// The state of one discretization of a scene carried over to another one of the same scene: the same members on the
/// same curves, in other elements or of other orders.
#pragma once

#include "discretization/state/snapshot.hpp"

namespace mixbeam {

/// A scene and its elements.
struct Discretization {
  const Scene& scene;
  const Mesh& mesh;
};

/// The fields of `state` in the elements of another mesh, which need not be finer or nested.
///
/// Displacement: values at the vertices; inside an element the slope is projected (L2) on the polynomials of its
/// degree. N and M: projected likewise, N on the polynomial through its Gauss points. Rotations: the change since the
/// undeformed state is carried over, Lambda_E(s) Lambda_E0(s)^T, with the discrete rotations Lambda_E0 that each mesh
/// has in its undeformed state; Lambda_lo and psi are fitted to it (mean of psi zero). A vertex that both meshes have
/// keeps its Lambda_V, which is not a value of Lambda_E; a new one inside an element turns with Lambda_E.
///
/// So an undeformed state becomes the undeformed state and a rigid motion the same rigid motion, and the part of the
/// old fields that the elements of the other mesh can express comes over to rounding: all of it where elements coincide
/// and no order falls, except for a relative rotation whose Lambda_E0 changes with the order (curvature that varies
/// along the member, and order 1 on an arc).
///
/// Throws std::invalid_argument when the two are not meshes of one scene, or when the state turns by more than about
/// half a turn inside a new element.
StateSnapshot transfer(const Discretization& from, const StateSnapshot& state, const Discretization& to);

/// Transfers between models, on any number of ranks: each for itself where all elements coincide and are shared out
/// alike, else through rank 0. Collective.
State transfer(const Model& from, const State& state, const Model& to);

}  // namespace mixbeam
