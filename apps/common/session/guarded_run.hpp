/// The last line of defence of every program: whatever goes wrong becomes a message and an exit code.
#pragma once

#include "discretization/mesh/tpetra_types.hpp"

#include <functional>
#include <string>

namespace mixbeam {

/// Exit code for a failed check, and for what no one foresaw.
inline constexpr int kFailedExitCode = 1;

/// Runs `action`, which returns an exit code, once MPI has started. Errors are reported on stderr, once for all ranks:
/// `<program>: bad input: ...` (exit code 2), `no convergence` (3), `results cannot be written` (2), `not enough memory`
/// (2), `unforeseen error` (1).
int guarded_run(const Communicator& communicator, const std::string& program, const std::function<int()>& action);

/// An InputError of rank 0 is thrown on every rank; otherwise the others would wait for it for ever.
void on_first_rank(const Communicator& communicator, const std::function<void()>& action);

}  // namespace mixbeam
