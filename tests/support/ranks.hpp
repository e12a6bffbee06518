/// Communicators: a test runs on each rank by itself, or on all of them together.
#pragma once

#include "discretization/mesh/communicator.hpp"

#include <Teuchos_DefaultMpiComm.hpp>

namespace mixbeam::test {

inline Communicator this_rank() { return Teuchos::rcp(new Teuchos::MpiComm<int>(MPI_COMM_SELF)); }
inline Communicator all_ranks() { return Teuchos::rcp(new Teuchos::MpiComm<int>(MPI_COMM_WORLD)); }

}  // namespace mixbeam::test
