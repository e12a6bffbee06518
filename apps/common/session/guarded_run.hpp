/// The last line of defence of every program: turns every error into a message and an exit code.
#pragma once

#include "discretization/mesh/tpetra_types.hpp"

#include <functional>
#include <string>

namespace mixbeam {

/// Exit code for a failed check and for unforeseen errors.
inline constexpr int kFailedExitCode = 1;

/// Runs `action`, which returns an exit code, once MPI has started. Errors are reported on stderr, once for all ranks:
/// `<program>: bad input: ...` (exit code 2), `no convergence` (3), `results cannot be written` (2), `not enough
/// memory` (2), `unforeseen error` (1).
int guarded_run(const Communicator& communicator, const std::string& program, const std::function<int()>& action);

/// Runs `action` on rank 0. Throws its InputError on every rank, since the others would wait for ever. Collective.
void on_first_rank(const Communicator& communicator, const std::function<void()>& action);

}  // namespace mixbeam
