/// Products of small dense blocks, column-major, by register tiles and SIMD lanes.
#pragma once

#include "kernels/execution/pack.hpp"

#include <cstddef>

namespace mixbeam::dense {

template <int Width>
inline void store(const Pack<Width>& numbers, double* to) {
  if constexpr (Width == 1)
    *to = numbers[0];
  else
    numbers.store(to);
}

/// Adds C (m x n) += A (m x k) B (k x n); A and C have contiguous columns of these strides, B any strides.
void add_product(int m, int k, int n, const double* a, int a_stride, const double* b, int b_row, int b_column,
                 double* c, int c_stride);
/// Adds A (m x k) B (k x m) to the lower triangle of C (m x m, stride m); changes some entries above it too.
void add_lower_product(int m, int k, const double* a, int a_stride, const double* b, int b_row, int b_column,
                       double* c);
/// Inverts the Cholesky factor L of a (m x m, lower triangle read); false if a is not positive definite.
bool inverse_cholesky(int m, double* a, double* inverse);

/// Computes transposed (n) = A^T z and, if x (n) is given, y (m) += A x, reading A (m x n) once; see add_columns().
/// For A in double and single precision.
template <bool WithProduct, class Value>
void multiply_both_ways(int m, int n, const Value* a, const double* z, double* transposed, const double* x = nullptr,
                        double* y = nullptr);

/// Adds y (m) += A x, A (m x n) with contiguous columns.
inline void add_times_vector(int m, int n, const double* __restrict__ a, const double* __restrict__ x,
                             double* __restrict__ y) {
  for (int j = 0; j < n; ++j)
#pragma GCC ivdep
    for (int i = 0; i < m; ++i) y[i] += a[static_cast<size_t>(m) * j + i] * x[j];
}

/// Multiplies several columns at once: sums = A^T z, and y += A x if x is given. Reads and writes whole lanes: behind
/// the m numbers of z and y there must be kLanes - 1 more, zero in z, and the numbers behind A must be finite.
template <int Columns, bool WithProduct, class Value>
inline void add_columns(int m, const Value* a, const double* z, double* sums, const double* x, double* y) {
  Pack<kLanes> sum[Columns];
  for (int c = 0; c < Columns; ++c) sum[c] = 0.0;
  for (int i = 0; i < m; i += kLanes) {
    const Pack<kLanes> some = Pack<kLanes>::loaded(z + i);
    Pack<kLanes> even = 0.0, odd = 0.0;
    for (int c = 0; c < Columns; ++c) {
      const Pack<kLanes> entries = Pack<kLanes>::loaded(a + static_cast<size_t>(m) * c + i);
      sum[c] += some * entries;
      if constexpr (WithProduct) (c % 2 == 0 ? even : odd) += entries * Pack<kLanes>(x[c]);
    }
    if constexpr (WithProduct) store(Pack<kLanes>::loaded(y + i) + (even + odd), y + i);
  }
  for (int c = 0; c < Columns; ++c) {
    double total = 0.0;
    for (int l = 0; l < kLanes; ++l) total += sum[c][l];
    sums[c] = total;
  }
}

}  // namespace mixbeam::dense
