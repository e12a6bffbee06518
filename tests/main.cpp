// Start of every test executable: MPI, Kokkos and Tpetra around Google Test, on one rank or on several.
#include "apps/common/session/mpi_session.hpp"
#include "discretization/mesh/mpi_at_need.hpp"
#include "nonlinear/newton/thresholds.hpp"
#include "nonlinear/path/thresholds.hpp"
#include "nonlinear/stability/thresholds.hpp"

#include <gtest/gtest.h>
#include <mpi.h>

#include <cstdio>
#include <stdexcept>
#include <string>

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

// --threshold=path:4:9.7 sets the fifth number of nonlinear/path/thresholds.hpp. The tables hold nothing but numbers.
template <class Table>
void move_threshold(Table& table, const std::string& room, const std::string& argument) {
  static_assert(sizeof(Table) % sizeof(double) == 0);
  const std::string option = "--threshold=" + room + ":";
  const size_t end = argument.find(':', option.size());
  if (argument.compare(0, option.size(), option) != 0 || end == std::string::npos) return;
  const size_t place = std::stoul(argument.substr(option.size()));
  if (place >= sizeof(Table) / sizeof(double)) throw std::out_of_range(argument);
  reinterpret_cast<double*>(&table)[place] = std::stod(argument.substr(end + 1));
}

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
  for (int i = 1; i < argc; ++i) {
    move_threshold(mixbeam::path_limit, "path", argv[i]);
    move_threshold(mixbeam::newton_limit, "newton", argv[i]);
    move_threshold(mixbeam::stability_limit, "stability", argv[i]);
  }
  const mixbeam::MpiSession session;
  mixbeam::require_mpi();  // tests divide ranks themselves
  return run_tests(session.communicator()->getRank());
}
