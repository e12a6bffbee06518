/// Sets up the BLAS and LAPACK of the system, whichever the program meets: its threads, which decide about bits, its
/// kernels, which decide about time, and its buffer, without which a run would not end.
#pragma once

#include <mutex>

namespace mixbeam {

/// Makes a BLAS that has threads of its own work with one: a sum shared out among threads has other bits. Selects
/// kernels of AVX2 or AVX-512 if OpenBLAS does not recognise the processor (3 to 8 times faster), unless the
/// environment names others (OPENBLAS_CORETYPE). Not while other threads call BLAS. An OpenBLAS takes its buffer here,
/// once. Throws std::bad_alloc with a text where a limit of memory leaves no room for it: OpenBLAS itself would wait
/// for ever.
void set_up_blas();

/// Addresses that OpenBLAS has still to take for its buffer, of which it touches what it needs. [byte]
double blas_room_to_come();

/// Lock to hold around calls of BLAS or LAPACK from several threads at once. It serialises them where OpenBLAS was
/// built for one thread (Debian's libopenblas0-serial): there two threads are now and then given the same room to work
/// in, and their results are wrong (11 of 400 calls of dsyevx with 300 rows); and where a limit of memory does not
/// leave a buffer for every thread. Nothing elsewhere.
std::unique_lock<std::mutex> turn_for_blas();

}  // namespace mixbeam
