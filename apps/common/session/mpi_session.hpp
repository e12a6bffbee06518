/// MPI, Kokkos and Tpetra for the life of a program.
#pragma once

#include "discretization/mesh/tpetra_types.hpp"

#include <memory>

namespace Tpetra {
class ScopeGuard;
}

namespace mixbeam {

class MpiSession {
 public:
  /// Starts MPI for use by the main thread beside OpenMP threads, then Kokkos and Tpetra.
  MpiSession();
  ~MpiSession();
  MpiSession(const MpiSession&) = delete;
  MpiSession& operator=(const MpiSession&) = delete;

  const Communicator& communicator() const { return communicator_; }

 private:
  std::unique_ptr<Tpetra::ScopeGuard> guard_;
  Communicator communicator_;
};

/// For a library in the process of another program: MPI (a process alone), Kokkos and Tpetra, once, and to the end of
/// the process. Environment, signals and the allocator of the host stay as they were. Where the host has started MPI
/// already, this process is alone all the same. Throws InputError under mpirun with several ranks.
Communicator start_as_guest();

}  // namespace mixbeam
