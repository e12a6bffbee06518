// Start of every test executable: MPI, Kokkos and Tpetra around Google Test, on one rank or on several.
#include <gtest/gtest.h>
#include <mpi.h>

#include <Tpetra_Core.hpp>
#include <cstdio>
#include <cstdlib>

namespace {

// Without mpirun, Open MPI searches for a network and a daemon for 0.3 s before it finds that it is alone.
void tell_open_mpi_that_it_is_alone() {
  if (std::getenv("OMPI_COMM_WORLD_SIZE") != nullptr) return;  // started by mpirun
  const int keep_the_users_choice = 0;
  setenv("OMPI_MCA_ess_singleton_isolated", "1", keep_the_users_choice);
  setenv("OMPI_MCA_pml", "ob1", keep_the_users_choice);
  setenv("OMPI_MCA_btl", "self,vader", keep_the_users_choice);
  setenv("OMPI_MCA_mtl", "^ofi", keep_the_users_choice);
}

// Rank 0 reports the progress. The other ranks say only what failed.
class FailuresOfRank : public testing::EmptyTestEventListener {
 public:
  explicit FailuresOfRank(int rank) : rank_(rank) {}

 private:
  void OnTestPartResult(const testing::TestPartResult& result) override {
    if (!result.failed()) return;
    const char* file = result.file_name() == nullptr ? "unknown file" : result.file_name();
    std::fprintf(stderr, "rank %d: %s:%d: failure in %s.%s\n%s\n", rank_, file, result.line_number(),
                 testing::UnitTest::GetInstance()->current_test_info()->test_suite_name(),
                 testing::UnitTest::GetInstance()->current_test_info()->name(), result.message());
  }

  int rank_;
};

int run_tests(int rank) {
  if (rank != 0) {
    auto& listeners = testing::UnitTest::GetInstance()->listeners();
    delete listeners.Release(listeners.default_result_printer());
    listeners.Append(new FailuresOfRank(rank));
  }
  int result = RUN_ALL_TESTS();
  if (testing::UnitTest::GetInstance()->test_to_run_count() == 0 && !testing::GTEST_FLAG(list_tests)) {
    if (rank == 0) std::fprintf(stderr, "No test matches the filter: nothing was tested.\n");
    result = 1;
  }
  int worst_result = 0;
  MPI_Allreduce(&result, &worst_result, 1, MPI_INT, MPI_MAX, MPI_COMM_WORLD);
  return worst_result;
}

}  // namespace

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  tell_open_mpi_that_it_is_alone();
  int provided = MPI_THREAD_SINGLE;
  // Tpetra would call plain MPI_Init; kernels run on threads, MPI is called by the main thread only.
  MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &provided);
  int rank = 0;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  int result = 0;
  {
    const Tpetra::ScopeGuard tpetra_and_kokkos(&argc, &argv);
    result = run_tests(rank);
  }
  MPI_Finalize();
  return result;
}
