/// MPI and Kokkos for the life of a program.
#pragma once

#include "discretization/mesh/tpetra_types.hpp"

namespace mixbeam {

class MpiSession {
 public:
  /// Starts Kokkos; under mpirun MPI before, for use by the main thread beside OpenMP threads. A process
  /// alone starts MPI where something needs it (discretization/mesh/mpi_at_need.hpp).
  MpiSession();
  ~MpiSession();
  MpiSession(const MpiSession&) = delete;
  MpiSession& operator=(const MpiSession&) = delete;

  const Communicator& communicator() const { return communicator_; }

 private:
  Communicator communicator_;
};

/// For a library in the process of another program: Kokkos for a process alone, once, and to the end of the
/// process. Environment and signals of the host stay as they were. Where the host has started MPI, this
/// process is alone all the same. Throws InputError under mpirun with several ranks.
Communicator start_as_guest();

}  // namespace mixbeam
