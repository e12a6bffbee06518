#include "apps/common/session/mpi_session.hpp"

#include "apps/common/session/machine_room.hpp"
#include "discretization/mesh/mpi_at_need.hpp"
#include "discretization/results/result_file.hpp"
#include "discretization/text/errors.hpp"
#include "kernels/execution/execution_space.hpp"

#include <mpi.h>

#include <Kokkos_Core.hpp>
#include <Teuchos_DefaultMpiComm.hpp>
#include <Teuchos_DefaultSerialComm.hpp>

#include <algorithm>
#include <cstdlib>
#include <string>

namespace mixbeam {

namespace {

/// Raises the thresholds of glibc as its own rule would (mallopt(3), M_MMAP_THRESHOLD) once the host had freed a block
/// this large: else what each run frees goes back to the system, and the next run spends half its time in page faults.
void raise_thresholds_of_malloc() {
  constexpr std::size_t kLargest = (std::size_t{32} << 20U) - (std::size_t{8} << 10U);
  void* volatile block = std::malloc(kLargest);  // volatile: else the compiler drops both calls
  std::free(block);
}

/// Divides the cores of a node among its ranks; OpenMP would give all of them to each rank, and waiting threads spin.
void share_cores_between_ranks() {
  if (std::getenv("OMP_NUM_THREADS") != nullptr) return;  // the user's choice
  MPI_Comm node = MPI_COMM_NULL;
  MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &node);
  int ranks = 1;
  MPI_Comm_size(node, &ranks);
  MPI_Comm_free(&node);
  if (ranks > 1) set_number_of_threads(std::max(1, number_of_threads() / ranks));
}

// Kernels run on threads; only the main thread calls MPI.
void start_mpi() {
  find_packaged_mpi();
  int provided = MPI_THREAD_SINGLE;
  MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &provided);
}

/// A command line with a program name only; Kokkos would take "--threads 2" for one of its own options and abort.
struct NameOnly {
  char name[8] = "mixbeam";
  char* words[2] = {name, nullptr};
  char** values = words;
  int count = 1;
};

// Tpetra::initialize() would start MPI.
void start_kokkos() {
  NameOnly line;
  Kokkos::initialize(line.count, line.values);
}

Communicator start_alone() {
  start_kokkos();
  return Teuchos::rcp(new Teuchos::SerialComm<int>());
}

}  // namespace

Communicator start_as_guest() {
  static const Communicator communicator = [] {
    int is_started = 0;
    MPI_Initialized(&is_started);
    begin_results_library();
    raise_thresholds_of_malloc();
    const char* ranks = std::getenv("OMPI_COMM_WORLD_SIZE");
    if (is_started == 0 && ranks != nullptr && std::string(ranks) != "1")
      throw InputError(std::string(ranks) + " ranks of mpirun; a library in another program runs on one; allowed: no " +
                       "mpirun, or the program itself, mpirun mixbeam run");
    return start_alone();
  }();
  return communicator;
}

MpiSession::MpiSession() {
  keep_freed_memory();
  begin_results_library();
  if (!is_under_mpirun()) {
    communicator_ = start_alone();
    return;
  }
  start_mpi();
  communicator_ = Teuchos::rcp(new Teuchos::MpiComm<int>(MPI_COMM_WORLD));
  start_kokkos();
  share_cores_between_ranks();
}

MpiSession::~MpiSession() {
  communicator_ = Teuchos::null;
  Kokkos::finalize();
  int is_started = 0;
  MPI_Initialized(&is_started);
  if (is_started != 0) MPI_Finalize();
}

}  // namespace mixbeam
