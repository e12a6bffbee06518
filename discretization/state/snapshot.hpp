/// Converts a state to the plain numbers that a result file keeps, and back, without changing a bit.
#pragma once

#include "discretization/assembly/model.hpp"
#include "discretization/state/resume_point.hpp"

namespace mixbeam {

/// Places at which the interior unknowns of every element of a mesh begin in a snapshot, and their number after the
/// last one.
std::vector<size_t> interior_places(const Scene& scene, const Mesh& mesh);

/// The share of this rank: its own vertices, and the elements that start at one of them.
StateShare share_of(const Model& model, const State& state);

/// Complete on rank 0, empty elsewhere. Collective.
StateSnapshot snapshot_of(const Model& model, const State& state);

/// The state that a snapshot was made of, on as many ranks as there are now; `snapshot` counts on rank 0 only. Throws
/// std::invalid_argument on every rank when its sizes are not those of the mesh. Collective.
State restore(const Model& model, const StateSnapshot& snapshot);
/// Restores an equilibrium at a load factor: with its full turns (State::turns), which the moments of springs tell.
State restore(const Model& model, const StateSnapshot& snapshot, double load_factor);

}  // namespace mixbeam
