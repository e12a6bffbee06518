/// MPI and Kokkos for the life of a program.
#pragma once

#include "discretization/mesh/tpetra_types.hpp"

namespace mixbeam {

class MpiSession {
 public:
  /// Starts Kokkos; under mpirun first MPI, for calls by the main thread beside OpenMP threads. A single process starts
  /// MPI only when needed (discretization/mesh/mpi_at_need.hpp).
  MpiSession();
  ~MpiSession();
  MpiSession(const MpiSession&) = delete;
  MpiSession& operator=(const MpiSession&) = delete;

  const Communicator& communicator() const { return communicator_; }

 private:
  Communicator communicator_;
};

/// Starts Kokkos once for a library in the process of another program, until the process ends. Does not change
/// environment and signals of the host. Uses a serial communicator even if the host has started MPI. Throws InputError
/// under mpirun with several ranks.
Communicator start_as_guest();

}  // namespace mixbeam
