/// Set-up of whichever BLAS and LAPACK the system provides: number of threads (bitwise reproducibility), kernels
/// (speed) and work buffer (without which OpenBLAS may hang).
#pragma once

#include <mutex>

namespace mixbeam {

/// Restricts a multithreaded BLAS to one thread: sums split among threads differ in their bits. Selects AVX2 or AVX-512
/// kernels if OpenBLAS does not recognise the processor (3 to 8 times faster), unless the environment names others
/// (OPENBLAS_CORETYPE). Makes OpenBLAS allocate its buffer, once; throws std::bad_alloc with a text if a memory limit
/// does not permit it, where OpenBLAS itself would wait for ever. Do not call while other threads use BLAS.
void set_up_blas();

/// Address space that OpenBLAS has yet to reserve for its buffer; it touches only what it needs. [byte]
double blas_room_to_come();

/// Lock to hold around calls of BLAS or LAPACK from several threads at once. It serialises them if OpenBLAS was built
/// for one thread (Debian's libopenblas0-serial), which occasionally gives two threads the same buffer and returns
/// wrong results (11 of 400 calls of dsyevx with 300 rows), or if a memory limit does not permit a buffer for every
/// thread. Otherwise it locks nothing.
std::unique_lock<std::mutex> turn_for_blas();

}  // namespace mixbeam
