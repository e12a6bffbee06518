#include "apps/common/session/mpi_session.hpp"

#include "discretization/results/result_file.hpp"
#include "kernels/execution/execution_space.hpp"

#include <malloc.h>
#include <mpi.h>

#include <Tpetra_Core.hpp>

#include <algorithm>
#include <cstdlib>

namespace mixbeam {

namespace {

// Without mpirun, Open MPI searches for a network and a daemon for 0.3 s before it finds that it is alone; a small
// scene is solved in a tenth of that.
void tell_open_mpi_that_it_is_alone() {
  if (std::getenv("OMPI_COMM_WORLD_SIZE") != nullptr) return;  // started by mpirun
  const int keep_the_users_choice = 0;
  setenv("OMPI_MCA_ess_singleton_isolated", "1", keep_the_users_choice);
  setenv("OMPI_MCA_pml", "ob1", keep_the_users_choice);
  setenv("OMPI_MCA_btl", "self,vader", keep_the_users_choice);
  setenv("OMPI_MCA_mtl", "^ofi", keep_the_users_choice);
  // All programs that are alone would share one folder of this name, and the first to end removes it under the others.
  setenv("OMPI_MCA_orte_create_session_dirs", "false", keep_the_users_choice);
}

/// Vectors and states of large models come and go in every iteration. By default glibc returns such blocks to the
/// system, and the page faults of getting them back cost as much as the arithmetic.
void keep_freed_memory() {
#ifdef __GLIBC__
  constexpr int kNever = 2'000'000'000;
  mallopt(M_MMAP_THRESHOLD, kNever);
  mallopt(M_TRIM_THRESHOLD, kNever);
#endif
}

/// Several ranks on one node share its cores; OpenMP would give all of them to each rank, and waiting threads spin.
void share_cores_between_ranks() {
  if (std::getenv("OMP_NUM_THREADS") != nullptr) return;  // the user's choice
  MPI_Comm node = MPI_COMM_NULL;
  MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &node);
  int ranks = 1;
  MPI_Comm_size(node, &ranks);
  MPI_Comm_free(&node);
  if (ranks > 1) set_number_of_threads(std::max(1, number_of_threads() / ranks));
}

}  // namespace

MpiSession::MpiSession() {
  keep_freed_memory();
  tell_open_mpi_that_it_is_alone();
  begin_results_library();
  int provided = MPI_THREAD_SINGLE;
  // Tpetra would call plain MPI_Init; kernels run on threads, MPI is called by the main thread only.
  MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &provided);
  // Kokkos would take "--threads 2" for one of its own options and abort: it sees a program's name only.
  int names = 1;
  char name[] = "mixbeam";
  char* arguments[] = {name, nullptr};
  char** argv = arguments;
  guard_ = std::make_unique<Tpetra::ScopeGuard>(&names, &argv);
  communicator_ = Tpetra::getDefaultComm();
  share_cores_between_ranks();
}

MpiSession::~MpiSession() {
  communicator_ = Teuchos::null;
  guard_.reset();
  MPI_Finalize();
}

}  // namespace mixbeam
