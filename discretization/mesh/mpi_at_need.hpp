/// MPI for a process alone, started by what needs it: a small scene is solved in less time than that takes.
#pragma once

#include "discretization/mesh/communicator.hpp"

#include <mpi.h>

namespace mixbeam {

/// Whether the process is one of those that mpirun has started.
bool is_under_mpirun();

/// Names Open MPI the folder `mpi` beside its library, where a package has put its files; nothing where there is none.
/// Before MPI starts.
void find_packaged_mpi();

/// Starts MPI for a process alone, unless it runs. Signals and environment stay as they are: Open MPI leaves settings
/// of its own there, which programs that are started later would inherit.
void require_mpi();

/// For calls of MPI itself, which runs from then on.
MPI_Comm mpi_of(const Teuchos::Comm<int>& comm);

}  // namespace mixbeam
