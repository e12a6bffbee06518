/// What the machine can do at most, measured in the same program that is judged by it.
#pragma once

namespace mixbeam {

struct MachineCeilings {
  double flops_per_second = 0.0;  ///< multiply-adds on full vector registers, two operations each
  double bytes_per_second = 0.0;  ///< a_i = b_i + s c_i from and to memory (McCalpin's triad: 24 bytes for each i)
};

/// The best of several attempts with that many threads; takes about two seconds.
MachineCeilings measure_ceilings(int threads);

}  // namespace mixbeam
