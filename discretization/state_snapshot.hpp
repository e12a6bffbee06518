/// From a state to the plain numbers that a result file keeps, and back, without changing a bit.
#pragma once

#include "discretization/assembler.hpp"
#include "discretization/resume_point.hpp"

namespace mixbeam {

/// Complete on rank 0, empty elsewhere. Collective.
StateSnapshot snapshot_of(const Assembler& assembler, const State& state);

/// The state that a snapshot was made of, on as many ranks as there are now; `snapshot` counts on rank 0 only. Throws
/// std::invalid_argument on every rank when its sizes are not those of the mesh. Collective.
State restore(const Assembler& assembler, const StateSnapshot& snapshot);

}  // namespace mixbeam
