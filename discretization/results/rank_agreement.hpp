/// Ranks that succeed or fail together.
#pragma once

#include "discretization/mesh/communicator.hpp"

#include <functional>
#include <string>

namespace mixbeam {

/// For what a single process does, with or without MPI.
Communicator one_rank();

/// Runs `action` on every rank. Empty when it threw nothing anywhere; otherwise, on every rank, what the first rank on
/// which it failed has to say, with the number of that rank where it is not 0. So a rank that meets a full disk leaves
/// none waiting. `action` must not communicate. Collective.
std::string first_problem(const Teuchos::Comm<int>& communicator, const std::function<void()>& action);

}  // namespace mixbeam
