/// The BLAS and LAPACK of the system: which one the program meets is the system's choice, and none of them needs
/// anything of this. Two things decide about results, one about time, one about whether a run ends.
#pragma once

#include <mutex>

namespace mixbeam {

/// Makes a BLAS that has threads of its own work with one: a sum shared out among threads has other bits. An OpenBLAS
/// that is older than the processor and works with the instructions of 2004 is told to use those of AVX2 or AVX-512,
/// unless the environment names others (OPENBLAS_CORETYPE): three to eight times as fast. Not while other
/// threads call BLAS. An OpenBLAS takes its buffer here, once. Throws std::bad_alloc with a text where a limit of memory
/// leaves no room for it: OpenBLAS itself would wait for ever.
void set_up_blas();

/// Addresses that OpenBLAS has still to take for its buffer, of which it touches what it needs. [byte]
double blas_room_to_come();

/// To be held around calls of BLAS or LAPACK from several threads at once. It is a turn of one after the other where
/// OpenBLAS was built for one thread (Debian's libopenblas0-serial): there two threads are now and then given the same
/// room to work in, and their results are wrong (11 of 400 calls of dsyevx with 300 rows); and where a limit of memory
/// does not leave a buffer for every thread. Nothing elsewhere.
std::unique_lock<std::mutex> turn_for_blas();

}  // namespace mixbeam
