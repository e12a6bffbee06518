/// Converts a state to the plain numbers of a result file, and back, bit by bit.
#pragma once

#include "discretization/assembly/model.hpp"
#include "discretization/state/resume_point.hpp"

namespace mixbeam {

/// Offsets of the interior unknowns of every element of a mesh in a snapshot, and the total number at the end.
std::vector<size_t> interior_places(const Scene& scene, const Mesh& mesh);

/// The share of this rank: its own vertices, and the elements that start at one of them.
StateShare share_of(const Model& model, const State& state);

/// Whole state on rank 0, empty elsewhere. Collective.
StateSnapshot snapshot_of(const Model& model, const State& state);

/// Restores the state of a snapshot on the current number of ranks; `snapshot` is only read on rank 0. Throws
/// std::invalid_argument on every rank if its sizes do not match the mesh. Collective.
State restore(const Model& model, const StateSnapshot& snapshot);
/// Restores an equilibrium at a load factor including its full turns (State::turns), found from the moments of springs.
State restore(const Model& model, const StateSnapshot& snapshot, double load_factor);

}  // namespace mixbeam
