/// MPI of a single process, started only when needed: a small scene is solved in less time than that takes.
#pragma once

#include "discretization/mesh/communicator.hpp"

#include <mpi.h>

namespace mixbeam {

/// True if mpirun started this process.
bool is_under_mpirun();

/// Points Open MPI to the folder `mpi` beside its library, where a package puts its files, if there is one. Call before
/// MPI starts.
void find_packaged_mpi();

/// Starts MPI for a single process, unless it runs. Restores signal handlers and environment: Open MPI leaves settings
/// in the latter that programs started later would inherit.
void require_mpi();

/// Communicator for direct calls of MPI, which is started if necessary.
MPI_Comm mpi_of(const Teuchos::Comm<int>& comm);

}  // namespace mixbeam
