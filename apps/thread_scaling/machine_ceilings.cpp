#include "apps/thread_scaling/measurement.hpp"
#include "kernels/execution/pack.hpp"
#include "kernels/loops/block.hpp"

#include <algorithm>
#include <chrono>
#include <limits>
#include <string>

namespace mixbeam {

namespace {

using Register = Pack<kLanes>;

/// Number of independent sums: latency (4 cycles) times units (2) of present processors is 8, and with two constants
/// they must fit into 16 registers.
constexpr int kIndependentSums = 10;
constexpr long kMultiplyAdds = 2'000'000;  ///< per sum: some ten milliseconds
/// Length of each of three arrays, 64 MB: several times the last-level cache of a desktop or a core complex.
constexpr long kTriadNumbers = 8L << 20;
constexpr int kTriadBlock = 512;  ///< numbers per index, so that the outer loop costs nothing
/// Duration of the attempts: long enough for one that other processes do not disturb.
constexpr double kSecondsOfAttempts = 0.7;

/// Kernel with one index per thread. Values stay near one: x <- x f + (1 - f).
struct MultiplyAddLoop {
  KernelView<double*> value;  ///< (thread): read and written, so that the compiler cannot remove the work
  double factor, summand;

  void operator()(int thread) const {
    Register sum[kIndependentSums];
    for (int i = 0; i < kIndependentSums; ++i) sum[i] = value(thread) + i;
    const Register f = factor, s = summand;
    for (long n = 0; n < kMultiplyAdds; ++n)
#pragma GCC unroll 16
      for (int i = 0; i < kIndependentSums; ++i) sum[i] = sum[i] * f + s;
    Register total = 0.0;
    for (int i = 0; i < kIndependentSums; ++i) total += sum[i];
    for (int lane = 0; lane < kLanes; ++lane) value(thread) += total[lane] - 1.0;
  }
};

template <class Work>
double shortest_seconds(const Work& work) {
  using Clock = std::chrono::steady_clock;
  const auto seconds_since = [](Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
  };
  const auto begin = Clock::now();
  double shortest = std::numeric_limits<double>::max();
  while (seconds_since(begin) < kSecondsOfAttempts) {
    const auto start = Clock::now();
    work();
    shortest = std::min(shortest, seconds_since(start));
  }
  return shortest;
}

double multiply_add_peak(int threads) {
  const MultiplyAddLoop loop{KernelView<double*>("mixbeam::ceiling::value", threads), 0.999, 0.001};
  const double seconds = shortest_seconds([&] {
    Kokkos::parallel_for("mixbeam::ceiling::multiply_add", Kokkos::RangePolicy<ExecutionSpace>(0, threads), loop);
  });
  return 2.0 * kLanes * kIndependentSums * kMultiplyAdds * threads / seconds;
}

double triad_peak() {
  using Range = Kokkos::RangePolicy<ExecutionSpace>;
  const auto array = [](const std::string& name) {
    return KernelView<double*>(Kokkos::view_alloc(name, Kokkos::WithoutInitializing), kTriadNumbers);
  };
  const auto a = array("mixbeam::ceiling::a"), b = array("mixbeam::ceiling::b"), c = array("mixbeam::ceiling::c");
  const Range blocks(0, kTriadNumbers / kTriadBlock);
  Kokkos::parallel_for(
      "mixbeam::ceiling::fill", blocks, KOKKOS_LAMBDA(long block) {  // first touch by the threads that use them
        for (long i = block * kTriadBlock; i < (block + 1) * kTriadBlock; ++i) a(i) = b(i) = c(i) = 1.0;
      });
  const double seconds = shortest_seconds([&] {
    Kokkos::parallel_for(
        "mixbeam::ceiling::triad", blocks, KOKKOS_LAMBDA(long block) {
          const double *from_b = b.data() + block * kTriadBlock, *from_c = c.data() + block * kTriadBlock;
          double* to = a.data() + block * kTriadBlock;
#pragma GCC ivdep
          for (int i = 0; i < kTriadBlock; ++i) to[i] = from_b[i] + 0.5 * from_c[i];
        });
  });
  return 3.0 * sizeof(double) * kTriadNumbers / seconds;
}

}  // namespace

MachineCeilings measure_ceilings(int threads) {
  const int before = number_of_threads();
  set_number_of_threads(threads);
  const MachineCeilings ceilings{multiply_add_peak(threads), triad_peak()};
  set_number_of_threads(before);
  return ceilings;
}

}  // namespace mixbeam
