/// Products of small dense blocks, column-major, in tiles and lanes.
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

/// C (m x n) += A (m x k) B (k x n); A and C have contiguous columns `a_stride` and `c_stride` apart, B any strides.
void add_product(int m, int k, int n, const double* a, int a_stride, const double* b, int b_row, int b_column,
                 double* c, int c_stride);
/// Lower triangle of C (m x m) += that of A (m x k) B (k x m), columns of C m apart; some entries above it change too.
void add_lower_product(int m, int k, const double* a, int a_stride, const double* b, int b_row, int b_column,
                       double* c);
/// Inverse of the Cholesky factor L of a (m x m, lower triangle read); false where a is not positive definite.
bool inverse_cholesky(int m, double* a, double* inverse);

/// transposed (n) = A^T z and, where x (n) is given, y (m) += A x, with one reading of A (m x n); see add_columns().
/// For double and single precision.
template <bool WithProduct, class Value>
void multiply_both_ways(int m, int n, const Value* a, const double* z, double* transposed, const double* x = nullptr,
                        double* y = nullptr);

/// y (m) += A x, A (m x n) with contiguous columns.
inline void add_times_vector(int m, int n, const double* __restrict__ a, const double* __restrict__ x,
                             double* __restrict__ y) {
  for (int j = 0; j < n; ++j)
#pragma GCC ivdep
    for (int i = 0; i < m; ++i) y[i] += a[static_cast<size_t>(m) * j + i] * x[j];
}

/// Multiplies columns side by side: sums = A^T z, and y += A x where x is given. Reads and writes in whole lanes: z
/// must be zero and y have room up to kLanes - 1 numbers behind m, and the numbers behind A must be finite.
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
