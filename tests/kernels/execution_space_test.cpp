// The execution space against Kokkos::Serial: the same bits with 1, 2 and 4 threads.
#include "kernels/execution/execution_space.hpp"

#include "tests/support/same_bits.hpp"

#include <gtest/gtest.h>

#include <Kokkos_Core.hpp>
#include <cmath>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>

namespace mixbeam {
namespace {

using Values = Kokkos::View<double*, Kokkos::HostSpace>;

constexpr int kSize = 10007;  // a prime: no number of threads divides it

// Chaotic, so that a single different rounding shows.
double some_value(int i) {
  double x = 0.1 + 0.8 * i / kSize;
  for (int repeat = 0; repeat < 20; ++repeat) x = 3.9 * x * (1.0 - x) + 1e-3 * std::sin(x + i);
  return x;
}

template <class Policy>
Values computed_with(const Policy& policy) {
  Values values("values", kSize);
  Kokkos::parallel_for(
      "some_values", policy, KOKKOS_LAMBDA(const int i) { values(i) = some_value(i); });
  return values;
}

std::string message_of_exception_in_kernel(int size, int first_bad_index, bool dynamic) {
  const auto kernel = KOKKOS_LAMBDA(const int i) {
    if (i >= first_bad_index) throw std::runtime_error("bad index " + std::to_string(i));
  };
  try {
    if (dynamic) {
      Kokkos::parallel_for("throws", Kokkos::RangePolicy<ExecutionSpace, Kokkos::Schedule<Kokkos::Dynamic>>(0, size),
                           kernel);
    } else {
      Kokkos::parallel_for("throws", Kokkos::RangePolicy<ExecutionSpace>(0, size), kernel);
    }
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "no exception";
}

class ExecutionSpaceTest : public testing::TestWithParam<int> {
 protected:
  ExecutionSpaceTest() : threads_before_(number_of_threads()) { set_number_of_threads(GetParam()); }
  ~ExecutionSpaceTest() override { set_number_of_threads(threads_before_); }

 private:
  int threads_before_;
};

TEST_P(ExecutionSpaceTest, HasTheNumberOfThreadsThatWasSet) {
  EXPECT_EQ(number_of_threads(), GetParam());
  const Kokkos::View<int*, Kokkos::HostSpace> thread_of("thread", kSize);
  Kokkos::parallel_for(
      "threads", Kokkos::RangePolicy<ExecutionSpace>(0, kSize),
      KOKKOS_LAMBDA(const int i) { thread_of(i) = omp_get_thread_num(); });
  const std::set<int> threads(thread_of.data(), thread_of.data() + kSize);
  EXPECT_EQ(static_cast<int>(threads.size()), GetParam());
}

TEST_P(ExecutionSpaceTest, StaticForHasTheBitsOfSerial) {
  const Values expected = computed_with(Kokkos::RangePolicy<Kokkos::Serial>(0, kSize));
  const Values values = computed_with(Kokkos::RangePolicy<ExecutionSpace>(0, kSize));
  EXPECT_TRUE(test::same_bits(values, expected));
}

TEST_P(ExecutionSpaceTest, DynamicForHasTheBitsOfSerial) {
  using Policy = Kokkos::RangePolicy<ExecutionSpace, Kokkos::Schedule<Kokkos::Dynamic>>;
  const Values expected = computed_with(Kokkos::RangePolicy<Kokkos::Serial>(0, kSize));
  EXPECT_TRUE(test::same_bits(computed_with(Policy(0, kSize)), expected));
  for (const int chunk_size : {1, 7, 20000})
    EXPECT_TRUE(test::same_bits(computed_with(Policy(0, kSize, Kokkos::ChunkSize(chunk_size))), expected))
        << "chunk size " << chunk_size;
}

// A body this small invites the compiler to compute several indices at once, except at the ends of a thread's part, and
// leaves it free which product to fuse with which sum. No number of threads may make a difference all the same.
TEST_P(ExecutionSpaceTest, SmallBodyHasTheBitsOfOneThread) {
  const Values x = computed_with(Kokkos::RangePolicy<Kokkos::Serial>(0, kSize));
  const Values expected("expected", kSize);
  const Values values("values", kSize);
  const auto compute = [&x](const Values& y) {
    const auto body = [x, y](const int i) {
      y(i) = (x(i) * 0.3 + 1.7) * x(i) - x(i) / (x(i) + 2.1) + 0.7 * x(i) * x(i);
    };
    Kokkos::parallel_for("small_body", Kokkos::RangePolicy<ExecutionSpace>(0, kSize), body);
  };
  set_number_of_threads(1);
  compute(expected);
  set_number_of_threads(GetParam());
  compute(values);
  EXPECT_TRUE(test::same_bits(values, expected));
}

TEST_P(ExecutionSpaceTest, RangeMayBeginAnywhere) {
  const Kokkos::View<int*, Kokkos::HostSpace> visits("visits", kSize);
  Kokkos::parallel_for(
      "visit", Kokkos::RangePolicy<ExecutionSpace>(13, 113), KOKKOS_LAMBDA(const int i) { ++visits(i); });
  for (int i = 0; i < kSize; ++i) ASSERT_EQ(visits(i), i >= 13 && i < 113 ? 1 : 0) << "index " << i;
}

TEST_P(ExecutionSpaceTest, EmptyRangeDoesNothing) {
  const auto must_not_run = KOKKOS_LAMBDA(const int) { throw std::logic_error("ran"); };
  using Dynamic = Kokkos::Schedule<Kokkos::Dynamic>;
  EXPECT_NO_THROW(Kokkos::parallel_for("empty", Kokkos::RangePolicy<ExecutionSpace>(5, 5), must_not_run));
  EXPECT_NO_THROW(Kokkos::parallel_for("empty", Kokkos::RangePolicy<ExecutionSpace, Dynamic>(5, 5), must_not_run));
  double sum = 1.0;
  Kokkos::parallel_reduce(
      "empty", Kokkos::RangePolicy<ExecutionSpace>(5, 5), KOKKOS_LAMBDA(const int, double& s) { s += 1.0; }, sum);
  EXPECT_EQ(sum, 0.0);
}

TEST_P(ExecutionSpaceTest, RangeSmallerThanTheNumberOfThreads) {
  int sum = 0;
  Kokkos::parallel_reduce(
      "two", Kokkos::RangePolicy<ExecutionSpace>(0, 2), KOKKOS_LAMBDA(const int i, int& s) { s += i + 1; }, sum);
  EXPECT_EQ(sum, 3);
}

TEST_P(ExecutionSpaceTest, MaxAndMinHaveTheBitsOfSerial) {
  const auto greater = KOKKOS_LAMBDA(const int i, double& largest) { largest = std::fmax(largest, some_value(i)); };
  const auto smaller = KOKKOS_LAMBDA(const int i, double& smallest) { smallest = std::fmin(smallest, some_value(i)); };
  double largest = 0.0, expected_largest = 0.0, smallest = 0.0, expected_smallest = 0.0;
  Kokkos::parallel_reduce("max", Kokkos::RangePolicy<Kokkos::Serial>(0, kSize), greater,
                          Kokkos::Max<double>(expected_largest));
  Kokkos::parallel_reduce("max", Kokkos::RangePolicy<ExecutionSpace>(0, kSize), greater, Kokkos::Max<double>(largest));
  Kokkos::parallel_reduce("min", Kokkos::RangePolicy<Kokkos::Serial>(0, kSize), smaller,
                          Kokkos::Min<double>(expected_smallest));
  Kokkos::parallel_reduce("min", Kokkos::RangePolicy<ExecutionSpace>(0, kSize), smaller, Kokkos::Min<double>(smallest));
  EXPECT_EQ(largest, expected_largest);
  EXPECT_EQ(smallest, expected_smallest);
}

TEST_P(ExecutionSpaceTest, MaxLocationIsFound) {
  using Location = Kokkos::MaxLoc<double, int>;
  const auto kernel = KOKKOS_LAMBDA(const int i, Location::value_type& location) {
    const double distance = -std::fabs(i - 7003.0);
    if (distance > location.val) location = {distance, i};
  };
  Location::value_type location;
  Kokkos::parallel_reduce("location", Kokkos::RangePolicy<ExecutionSpace>(0, kSize), kernel, Location(location));
  EXPECT_EQ(location.loc, 7003);
}

// Also with a dynamic schedule, where chunks fall to threads by chance.
TEST_P(ExecutionSpaceTest, SumRepeatsExactly) {
  const auto sum_once = [] {
    double sum = 0.0;
    Kokkos::parallel_reduce(
        "sum", Kokkos::RangePolicy<ExecutionSpace, Kokkos::Schedule<Kokkos::Dynamic>>(0, kSize),
        KOKKOS_LAMBDA(const int i, double& s) { s += some_value(i); }, sum);
    return sum;
  };
  double expected = 0.0;
  for (int i = 0; i < kSize; ++i) expected += some_value(i);
  const double first = sum_once();
  EXPECT_NEAR(first, expected, 1e-12 * expected);  // kSize roundings of random sign
  for (int repeat = 0; repeat < 20; ++repeat) ASSERT_EQ(sum_once(), first);
}

TEST_P(ExecutionSpaceTest, ScanNumbersLikeSerial) {
  const Kokkos::View<int*, Kokkos::HostSpace> offsets("offsets", kSize);
  Kokkos::parallel_scan(
      "offsets", Kokkos::RangePolicy<ExecutionSpace>(0, kSize), KOKKOS_LAMBDA(const int i, int& offset, bool is_final) {
        if (is_final) offsets(i) = offset;
        offset += i % 5;
      });
  int expected = 0;
  for (int i = 0; i < kSize; ++i) {
    ASSERT_EQ(offsets(i), expected) << "index " << i;
    expected += i % 5;
  }
}

struct Doubled {};
struct Tripled {};
struct TaggedKernel {
  Kokkos::View<int*, Kokkos::HostSpace> result;  // (index)
  KOKKOS_FUNCTION void operator()(Doubled, const int i) const { result(i) = 2 * i; }
  KOKKOS_FUNCTION void operator()(Tripled, const int i) const { result(i) = 3 * i; }
};

TEST_P(ExecutionSpaceTest, WorkTagsSelectTheOperator) {
  const TaggedKernel kernel{Kokkos::View<int*, Kokkos::HostSpace>("result", 100)};
  Kokkos::parallel_for("doubled", Kokkos::RangePolicy<ExecutionSpace, Doubled>(0, 100), kernel);
  EXPECT_EQ(kernel.result(99), 198);
  Kokkos::parallel_for("tripled", Kokkos::RangePolicy<ExecutionSpace, Tripled>(0, 100), kernel);
  EXPECT_EQ(kernel.result(99), 297);
}

TEST_P(ExecutionSpaceTest, ExceptionOfTheLowestIndexReachesTheCaller) {
  for (const bool dynamic : {false, true})
    for (const int first_bad_index : {0, 1, kSize / 2, kSize - 1})
      EXPECT_EQ(message_of_exception_in_kernel(kSize, first_bad_index, dynamic),
                "bad index " + std::to_string(first_bad_index));
}

TEST_P(ExecutionSpaceTest, RunsAgainAfterAnException) {
  ASSERT_EQ(message_of_exception_in_kernel(10, 3, false), "bad index 3");
  EXPECT_EQ(message_of_exception_in_kernel(10, 10, false), "no exception");
}

TEST_P(ExecutionSpaceTest, NestedCallRunsOnTheCallingThread) {
  constexpr int kOuter = 64, kInner = 50;
  const Kokkos::View<int**, Kokkos::HostSpace> on_caller("on_caller", kOuter, kInner);  // (outer, inner)
  const Kokkos::View<int*, Kokkos::HostSpace> sum_of("sum", kOuter);
  Kokkos::parallel_for(
      "outer", Kokkos::RangePolicy<ExecutionSpace>(0, kOuter), KOKKOS_LAMBDA(const int i) {
        const std::thread::id caller = std::this_thread::get_id();
        Kokkos::parallel_for("inner", Kokkos::RangePolicy<ExecutionSpace>(0, kInner),
                             [=](const int j) { on_caller(i, j) = std::this_thread::get_id() == caller ? 1 : 0; });
        int sum = 0;
        for (int j = 0; j < kInner; ++j) sum += on_caller(i, j);
        sum_of(i) = sum;
      });
  for (int i = 0; i < kOuter; ++i) EXPECT_EQ(sum_of(i), kInner) << "outer index " << i;
}

TEST_P(ExecutionSpaceTest, AtomicAddLosesNothing) {
  constexpr int kAdditions = 1000000;
  const Kokkos::View<double, Kokkos::HostSpace> counter("counter");
  const Kokkos::View<double, Kokkos::HostSpace, Kokkos::MemoryTraits<Kokkos::Atomic>> atomic_counter = counter;
  Kokkos::parallel_for(
      "atomic_add", Kokkos::RangePolicy<ExecutionSpace>(0, kAdditions),
      KOKKOS_LAMBDA(const int) { Kokkos::atomic_add(&counter(), 1.0); });
  EXPECT_EQ(counter(), kAdditions);
  Kokkos::parallel_for(
      "atomic_trait", Kokkos::RangePolicy<ExecutionSpace>(0, kAdditions),
      KOKKOS_LAMBDA(const int) { atomic_counter() += 1.0; });
  EXPECT_EQ(counter(), 2 * kAdditions);
}

// Views that the lambda captured, and subviews of them, are not counted: the one thing threads may do with Views.
TEST_P(ExecutionSpaceTest, SubviewsInAKernelLeaveTheReferenceCountAlone) {
  const Kokkos::View<double**, Kokkos::LayoutRight, Kokkos::HostSpace> matrix("matrix", kSize, 12);
  const int references = matrix.use_count();
  Kokkos::parallel_for(
      "rows", Kokkos::RangePolicy<ExecutionSpace>(0, kSize), KOKKOS_LAMBDA(const int i) {
        const auto row = Kokkos::subview(matrix, i, Kokkos::ALL());
        for (int j = 0; j < 12; ++j) row(j) = i + j;
      });
  EXPECT_EQ(matrix.use_count(), references);
  EXPECT_EQ(matrix(kSize - 1, 11), kSize + 10);
}

INSTANTIATE_TEST_SUITE_P(Threads, ExecutionSpaceTest, testing::Values(1, 2, 4));

TEST(NumberOfThreads, LessThanOneIsRefused) {
  const int threads_before = number_of_threads();
  EXPECT_THROW(set_number_of_threads(0), std::invalid_argument);
  EXPECT_THROW(set_number_of_threads(-1), std::invalid_argument);
  EXPECT_EQ(number_of_threads(), threads_before);
}

}  // namespace
}  // namespace mixbeam
