// Execution space of all kernels and its number of threads; only this file knows the back ends of Kokkos.
#pragma once

#include <Kokkos_Core.hpp>
#include <stdexcept>
#include <string>

#if !defined(KOKKOS_ENABLE_OPENMP) && !defined(KOKKOS_ENABLE_THREADS) && !defined(KOKKOS_ENABLE_HPX) && \
    !defined(KOKKOS_ENABLE_CUDA) && !defined(KOKKOS_ENABLE_HIP) && !defined(KOKKOS_ENABLE_SYCL) &&      \
    !defined(KOKKOS_ENABLE_OPENMPTARGET)
#define MIXBEAM_OWN_OPENMP_THREADS
#include "kernels/execution/openmp_threads.hpp"
#endif

namespace mixbeam {

#if defined(MIXBEAM_OWN_OPENMP_THREADS)
using ExecutionSpace = OpenMPThreads;
#elif defined(KOKKOS_ENABLE_OPENMP) && !defined(KOKKOS_ENABLE_CUDA) && !defined(KOKKOS_ENABLE_HIP) && \
    !defined(KOKKOS_ENABLE_SYCL) && !defined(KOKKOS_ENABLE_OPENMPTARGET)
using ExecutionSpace = Kokkos::OpenMP;
#else
using ExecutionSpace = Kokkos::DefaultExecutionSpace;
#endif
using MemorySpace = ExecutionSpace::memory_space;

// Number of threads of a kernel started from outside of kernels.
inline int number_of_threads() {
#if defined(MIXBEAM_OWN_OPENMP_THREADS)
  return OpenMPThreads::number_of_threads();
#else
  return ExecutionSpace().concurrency();
#endif
}

// Sets the number of threads, between kernels. A back end of Kokkos has a fixed number from its start (OMP_NUM_THREADS
// or --kokkos-threads) and refuses any other.
inline void set_number_of_threads(int number) {
  if (number < 1) throw std::invalid_argument("number of threads: " + std::to_string(number) + " is less than 1");
#if defined(MIXBEAM_OWN_OPENMP_THREADS)
  OpenMPThreads::set_number_of_threads(number);
#else
  if (number != number_of_threads())
    throw std::invalid_argument("number of threads: Kokkos was started with " + std::to_string(number_of_threads()) +
                                " and cannot change to " + std::to_string(number) + "; set OMP_NUM_THREADS instead");
#endif
}

}  // namespace mixbeam
