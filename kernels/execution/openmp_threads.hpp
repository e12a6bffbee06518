// Kokkos execution space on OpenMP threads, for a Kokkos that was built with its Serial back end only, as on Debian 12.
// Use it through kernels/execution/execution_space.hpp.
//
// Supports what mixbeam's kernels use: RangePolicy with parallel_for, parallel_reduce and parallel_scan. Each returns
// when all its work is done. A call from inside a kernel runs on the calling thread alone.
//
// Views on threads. The reference counts of Views are compiled into libkokkoscore, here without atomic operations.
// Inside a kernel use only
//   - Views that the functor or lambda captured by value, and subviews of them: Kokkos does not count those;
//   - unmanaged Views.
// Never reach a View through a pointer, a reference or `this`, never allocate one, and never copy one inside a bare
// `#pragma omp parallel`: the count is corrupted and memory is freed while in use. Teuchos::RCP has the same limit.
//
// Bitwise identical results for any number of threads: parallel_for gives them if each index writes to its own place,
// because every index executes the same machine instructions (see for_each_index). parallel_reduce joins one partial
// result per thread in thread order. This repeats exactly for a given number of threads, but the last bits of a sum
// change with that number: reduce only with Max, Min and the like, and add up long sums in a fixed order on one thread.
#pragma once

#include <Kokkos_Core.hpp>

#if KOKKOS_VERSION >= 30500
#error "openmp_threads.hpp specialises internals of Kokkos 3.4: use a Kokkos built with OpenMP, or port this file"
#endif
#if !defined(_OPENMP)
#error "openmp_threads.hpp needs the compiler's OpenMP option (-fopenmp): link to the CMake target mixbeam_kokkos"
#endif
#if defined(KOKKOS_ENABLE_SERIAL_ATOMICS)
#error "this Kokkos would run its atomic operations without locking: define KOKKOS_ENABLE_GNU_ATOMICS for every file"
#endif

#include <omp.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <iosfwd>
#include <limits>
#include <mutex>
#include <ostream>
#include <type_traits>
#include <utility>
#include <vector>

namespace mixbeam {

// Members required of an execution space by Kokkos 3.4.
class OpenMPThreads {
 public:
  using execution_space = OpenMPThreads;
  using memory_space = Kokkos::HostSpace;
  using device_type = Kokkos::Device<OpenMPThreads, memory_space>;
  using array_layout = Kokkos::LayoutRight;
  using size_type = memory_space::size_type;
  using scratch_memory_space = Kokkos::ScratchMemorySpace<OpenMPThreads>;

  static const char* name() { return "OpenMPThreads"; }
  static int concurrency() { return in_parallel() ? 1 : number_of_threads(); }
  static bool in_parallel(const OpenMPThreads& = OpenMPThreads()) { return omp_in_parallel() != 0; }
  void fence() const {}  // each call has finished when it returns
  static void impl_static_fence() {}
  static bool impl_is_initialized() { return true; }
  std::uint32_t impl_instance_id() const noexcept { return 0; }
  static void print_configuration(std::ostream& out, bool /*detail*/ = false) {
    out << name() << ", threads: " << number_of_threads() << '\n';
  }

  // OMP_NUM_THREADS, or the number of processors, unless a number has been set. Set it outside of kernels.
  static int number_of_threads() { return chosen_number() > 0 ? chosen_number() : omp_get_max_threads(); }
  static void set_number_of_threads(int number) { chosen_number() = number; }

 private:
  static int& chosen_number() {
    static int number = 0;
    return number;
  }
};

namespace openmp_threads {

// Carries an exception from a thread to the caller. If several throw, the one at the lowest index wins, as in a loop on
// a single thread.
class FirstException {
 public:
  template <class Work>
  void guard(long long position, const Work& work) noexcept {
    try {
      work();
    } catch (...) {
      const std::lock_guard<std::mutex> lock(mutex_);
      if (position < position_) {
        position_ = position;
        exception_ = std::current_exception();
      }
    }
  }
  void rethrow_if_any() const {
    if (exception_) std::rethrow_exception(exception_);
  }

 private:
  std::mutex mutex_;
  std::exception_ptr exception_;
  long long position_ = std::numeric_limits<long long>::max();
};

template <class Index>
struct Range {
  Index begin;
  Index end;
};

// Part number `part` of `parts` nearly equal parts of a range; the first parts take one index more.
template <class Index>
Range<Index> part_of(const Range<Index>& range, int part, int parts) {
  const auto size = static_cast<long long>(range.end - range.begin);
  const long long quotient = size / parts;
  const long long remainder = size % parts;
  const long long first = part * quotient + (part < remainder ? part : remainder);
  const long long last = first + quotient + (part < remainder ? 1 : 0);
  return {static_cast<Index>(range.begin + first), static_cast<Index>(range.begin + last)};
}

// Runs body(range, thread) once for each thread.
template <class Index, class Body>
void run_in_equal_parts(const Range<Index>& range, const Body& body) {
  if (range.end <= range.begin) return;
  const int threads = OpenMPThreads::concurrency();
  if (threads == 1) {
    body(range, 0);
    return;
  }
  FirstException first_exception;
#pragma omp parallel num_threads(threads)
  {
    const int thread = omp_get_thread_num();
    const Range<Index> part = part_of(range, thread, omp_get_num_threads());
    if (part.begin < part.end) first_exception.guard(thread, [&] { body(part, thread); });
  }
  first_exception.rethrow_if_any();
}

// Runs body(range, thread) for chunks that the threads fetch as they become free.
template <class Index, class Body>
void run_in_chunks(const Range<Index>& range, long long chunk_size, const Body& body) {
  if (range.end <= range.begin) return;
  const int threads = OpenMPThreads::concurrency();
  if (threads == 1) {
    body(range, 0);
    return;
  }
  const auto size = static_cast<long long>(range.end - range.begin);
  chunk_size = chunk_size > 0 ? chunk_size : 1;
  FirstException first_exception;
#pragma omp parallel for num_threads(threads) schedule(dynamic, 1)
  for (long long first = 0; first < size; first += chunk_size) {
    const long long last = size - first < chunk_size ? size : first + chunk_size;
    const Range<Index> chunk{static_cast<Index>(range.begin + first), static_cast<Index>(range.begin + last)};
    first_exception.guard(first, [&] { body(chunk, omp_get_thread_num()); });
  }
  first_exception.rethrow_if_any();
}

#if defined(__GNUC__) && !defined(__clang__)
#define MIXBEAM_ONE_INSTANCE [[gnu::noinline, gnu::noclone]]
#else
#define MIXBEAM_ONE_INSTANCE [[gnu::noinline]]
#endif

// Runs body(i) over one part of a range. Compiled once, not separately for one thread and for several, and never
// vectorised over indices with single ones at the ends of a part: in each copy of a formula the compiler chooses anew
// which products it fuses with which sums, and that changes last bits.
template <class Index, class Body>
MIXBEAM_ONE_INSTANCE void for_each_index(const Range<Index>& part, const Body& body) {
  for (Index i = part.begin; i < part.end; ++i) {
    body(i);
    asm volatile("" : : : "memory");  // a barrier without an instruction: keeps the indices apart
  }
}
#undef MIXBEAM_ONE_INSTANCE

template <class Tag, class Functor, class... Arguments>
void call(const Functor& functor, Arguments&&... arguments) {
  if constexpr (std::is_void_v<Tag>) {
    functor(std::forward<Arguments>(arguments)...);
  } else {
    functor(Tag(), std::forward<Arguments>(arguments)...);
  }
}

// Memory for one partial result per thread, spaced so that threads do not share a cache line.
class PartialResults {
 public:
  PartialResults(int number, std::size_t bytes)
      : lines_per_result_((bytes + sizeof(Line) - 1) / sizeof(Line)), lines_(number * lines_per_result_) {}
  void* operator[](int i) { return lines_.data() + i * lines_per_result_; }

 private:
  struct alignas(128) Line {  // two lines: the processor prefetches pairs
    std::array<unsigned char, 128> bytes;
  };
  std::size_t lines_per_result_;
  std::vector<Line> lines_;
};

}  // namespace openmp_threads
}  // namespace mixbeam

namespace Kokkos {

namespace Tools::Experimental {
template <>
struct DeviceTypeTraits<mixbeam::OpenMPThreads> {
  static constexpr DeviceType id = DeviceType::OpenMP;
};
}  // namespace Tools::Experimental

namespace Impl {

template <>
struct MemorySpaceAccess<Kokkos::HostSpace, mixbeam::OpenMPThreads::scratch_memory_space> {
  enum : bool { assignable = false };
  enum : bool { accessible = true };
  enum : bool { deepcopy = false };
};

template <class Functor, class... Traits>
class ParallelFor<Functor, Kokkos::RangePolicy<Traits...>, mixbeam::OpenMPThreads> {
  using Policy = Kokkos::RangePolicy<Traits...>;
  using Index = typename Policy::member_type;
  using Range = mixbeam::openmp_threads::Range<Index>;

 public:
  ParallelFor(const Functor& functor, const Policy& policy) : functor_(functor), policy_(policy) {}

  void execute() const {
    const Range range{policy_.begin(), policy_.end()};
    const auto body = [this](const Range& part, int /*thread*/) {
      mixbeam::openmp_threads::for_each_index(
          part, [this](Index i) { mixbeam::openmp_threads::call<typename Policy::work_tag>(functor_, i); });
    };
    if constexpr (std::is_same_v<typename Policy::schedule_type::type, Kokkos::Dynamic>) {
      mixbeam::openmp_threads::run_in_chunks(range, static_cast<long long>(policy_.chunk_size()), body);
    } else {
      mixbeam::openmp_threads::run_in_equal_parts(range, body);
    }
  }

 private:
  const Functor functor_;
  const Policy policy_;
};

// Always in equal parts, even for a dynamic policy: chunks would be joined in a different order in each run.
template <class Functor, class Reducer, class... Traits>
class ParallelReduce<Functor, Kokkos::RangePolicy<Traits...>, Reducer, mixbeam::OpenMPThreads> {
  using Policy = Kokkos::RangePolicy<Traits...>;
  using Tag = typename Policy::work_tag;
  using Index = typename Policy::member_type;
  using Range = mixbeam::openmp_threads::Range<Index>;
  using Analysis = FunctorAnalysis<FunctorPatternInterface::REDUCE, Policy, Functor>;
  using pointer_type = typename Analysis::pointer_type;
  using reference_type = typename Analysis::reference_type;

  // init, join and final come from the reducer if there is one, else from the functor
  static constexpr bool kHasReducer = !std::is_same_v<Reducer, InvalidType>;
  using Select = if_c<!kHasReducer, Functor, Reducer>;
  using Operations = typename Select::type;
  using OperationsTag = std::conditional_t<kHasReducer, void, Tag>;

 public:
  template <class ResultView>
  ParallelReduce(const Functor& functor, const Policy& policy, const ResultView& result,
                 std::enable_if_t<Kokkos::is_view<ResultView>::value && !kHasReducer, void*> = nullptr)
      : functor_(functor), policy_(policy), reducer_(InvalidType()), result_(result.data()) {}
  ParallelReduce(const Functor& functor, const Policy& policy, const Reducer& reducer)
      : functor_(functor), policy_(policy), reducer_(reducer), result_(reducer.view().data()) {}

  void execute() const {
    const Operations& operations = Select::select(functor_, reducer_);
    const int threads = mixbeam::OpenMPThreads::concurrency();
    mixbeam::openmp_threads::PartialResults memory(threads, Analysis::value_size(operations));
    const auto partial = [&memory](int thread) { return static_cast<pointer_type>(memory[thread]); };

    for (int thread = 0; thread < threads; ++thread)
      FunctorValueInit<Operations, OperationsTag>::init(operations, partial(thread));
    const auto body = [&](const Range& part, int thread) {
      reference_type value = as_reference(partial(thread));
      mixbeam::openmp_threads::for_each_index(part,
                                              [&](Index i) { mixbeam::openmp_threads::call<Tag>(functor_, i, value); });
    };
    mixbeam::openmp_threads::run_in_equal_parts(Range{policy_.begin(), policy_.end()}, body);
    for (int thread = 1; thread < threads; ++thread)
      FunctorValueJoin<Operations, OperationsTag>::join(operations, partial(0), partial(thread));
    FunctorFinal<Operations, OperationsTag>::final(operations, partial(0));

    if (result_ == nullptr) return;
    const unsigned count = Analysis::value_count(operations);
    for (unsigned i = 0; i < count; ++i) result_[i] = partial(0)[i];
  }

 private:
  // Array reductions pass the pointer itself to the functor.
  static reference_type as_reference(pointer_type pointer) {
    if constexpr (std::is_pointer_v<reference_type>) {
      return pointer;
    } else {
      return *pointer;
    }
  }

  const Functor functor_;
  const Policy policy_;
  const Reducer reducer_;
  const pointer_type result_;
};

// Runs on the calling thread: scans only number items once, at set-up.
template <class Functor, class... Traits>
class ParallelScan<Functor, Kokkos::RangePolicy<Traits...>, mixbeam::OpenMPThreads> {
  using Policy = Kokkos::RangePolicy<Traits...>;
  using Tag = typename Policy::work_tag;
  using Index = typename Policy::member_type;
  using Analysis = FunctorAnalysis<FunctorPatternInterface::SCAN, Policy, Functor>;

 public:
  ParallelScan(const Functor& functor, const Policy& policy) : functor_(functor), policy_(policy) {}

  void execute() const {
    constexpr bool kIsFinalPass = true;
    mixbeam::openmp_threads::PartialResults memory(1, Analysis::value_size(functor_));
    auto* sum = static_cast<typename Analysis::pointer_type>(memory[0]);
    typename Analysis::reference_type value = FunctorValueInit<Functor, Tag>::init(functor_, sum);
    for (Index i = policy_.begin(); i < policy_.end(); ++i)
      mixbeam::openmp_threads::call<Tag>(functor_, i, value, kIsFinalPass);
  }

 private:
  const Functor functor_;
  const Policy policy_;
};

}  // namespace Impl
}  // namespace Kokkos
