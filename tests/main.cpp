// Start of every test executable: MPI, Kokkos and Tpetra around Google Test, on one rank or on several.
#include "apps/common/session/mpi_session.hpp"

#include <gtest/gtest.h>
#include <mpi.h>

#include <cstdio>

namespace {

// Rank 0 reports the progress. The other ranks say only what failed.
class FailuresOfRank : public testing::EmptyTestEventListener {
 public:
  explicit FailuresOfRank(int rank) : rank_(rank) {}

 private:
  // which test it is cannot be asked for while a result is reported: Google Test holds a lock
  void OnTestStart(const testing::TestInfo& test) override { test_ = &test; }
  void OnTestPartResult(const testing::TestPartResult& result) override {
    if (!result.failed()) return;
    const char* file = result.file_name() == nullptr ? "unknown file" : result.file_name();
    std::fprintf(stderr, "rank %d: %s:%d: failure in %s.%s\n%s\n", rank_, file, result.line_number(),
                 test_ == nullptr ? "" : test_->test_suite_name(), test_ == nullptr ? "" : test_->name(),
                 result.message());
  }

  int rank_;
  const testing::TestInfo* test_ = nullptr;
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
  const mixbeam::MpiSession session;
  return run_tests(session.communicator()->getRank());
}
