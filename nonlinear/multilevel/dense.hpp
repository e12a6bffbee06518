/// Products of small dense blocks, column-major, in loops that compilers turn into vector instructions.
#pragma once

#include "kernels/execution/pack.hpp"

#include <cmath>
#include <cstddef>

namespace mixbeam::dense {

/// C (m x n) += A (m x k) B (k x n); A and C have contiguous columns `a_stride` and `c_stride` apart, B any strides.
template <int Rows = 0>
inline void add_product(int m, int k, int n, const double* a, int a_stride, const double* b, int b_row, int b_column,
                        double* c, int c_stride) {
  if constexpr (Rows == 0)
    if (m == 6) return add_product<6>(m, k, n, a, a_stride, b, b_row, b_column, c, c_stride);
  const int rows = Rows > 0 ? Rows : m;
  for (int j = 0; j < n; ++j) {
    double* __restrict__ to = c + static_cast<size_t>(c_stride) * j;
    for (int p = 0; p < k; ++p) {
      const double factor = b[static_cast<size_t>(b_row) * p + static_cast<size_t>(b_column) * j];
      const double* __restrict__ from = a + static_cast<size_t>(a_stride) * p;
#pragma GCC ivdep
      for (int i = 0; i < rows; ++i) to[i] += from[i] * factor;
    }
  }
}

/// y (m) += A x, A (m x n) with contiguous columns, of double or single precision.
template <int Rows = 0, class Value>
inline void add_times_vector(int m, int n, const Value* __restrict__ a, const double* __restrict__ x,
                             double* __restrict__ y) {
  const int rows = Rows > 0 ? Rows : m, columns = Rows > 0 ? Rows : n;
  for (int j = 0; j < columns; ++j)
#pragma GCC ivdep
    for (int i = 0; i < rows; ++i) y[i] += static_cast<double>(a[rows * j + i]) * x[j];
}

/// y += A^T x, A of fixed size.
template <int Size, class Value>
inline void add_transposed_times_vector(const Value* __restrict__ a, const double* __restrict__ x,
                                        double* __restrict__ y) {
  for (int j = 0; j < Size; ++j) {
    double sum = 0.0;
    for (int i = 0; i < Size; ++i) sum += static_cast<double>(a[Size * j + i]) * x[i];
    y[j] += sum;
  }
}

/// A^T x of several A (m x n), summed up: a block, its rows and its vector.
template <class Value>
struct TransposedFactor {
  const Value* a;
  int m;
  const double* x;
};

/// Columns that are summed up side by side.
inline constexpr int kColumnsAtOnce = 8;

/// Sums of A^T x in the rows from `first`. Reads up to kLanes - 1 numbers behind each A, which must be finite.
template <int Columns, class Value>
inline void add_transposed_columns(const TransposedFactor<Value>* factors, int count, int first, double* sums) {
  Pack<kLanes> sum[Columns];
  for (int c = 0; c < Columns; ++c) sum[c] = 0.0;
  for (int k = 0; k < count; ++k) {
    const int m = factors[k].m;
    const Value* a = factors[k].a + static_cast<size_t>(m) * first;
    const double* x = factors[k].x;
    int i = 0;
    for (; i + kLanes <= m; i += kLanes) {
      const Pack<kLanes> some = Pack<kLanes>::loaded(x + i);
      for (int c = 0; c < Columns; ++c) sum[c] += some * Pack<kLanes>::loaded(a + m * c + i);
    }
    if (i == m) continue;
    double rest[kLanes] = {};
    for (int l = 0; i + l < m; ++l) rest[l] = x[i + l];
    const Pack<kLanes> some = Pack<kLanes>::loaded(rest);
    for (int c = 0; c < Columns; ++c) sum[c] += some * Pack<kLanes>::loaded(a + m * c + i);
  }
  for (int c = 0; c < Columns; ++c) {
    double total = 0.0;
    for (int l = 0; l < kLanes; ++l) total += sum[c][l];
    sums[c] = total;
  }
}

/// y (n) += sum of A^T x.
template <class Value>
inline void add_transposed(const TransposedFactor<Value>* factors, int count, int n, double* y) {
  double sums[kColumnsAtOnce];
  if (count == 0) return;
  for (int j = 0; j < n;) {
    if (n < kColumnsAtOnce) {
      add_transposed_columns<1>(factors, count, j, sums);
      y[j++] += sums[0];
      continue;
    }
    const int first = j + kColumnsAtOnce <= n ? j : n - kColumnsAtOnce;  // the last ones overlap those before
    add_transposed_columns<kColumnsAtOnce>(factors, count, first, sums);
    for (; j < first + kColumnsAtOnce; ++j) y[j] += sums[j - first];
  }
}

/// Inverse of the Cholesky factor L of a (m x m, lower triangle read); false where a is not positive definite.
inline bool inverse_cholesky(int m, double* a, double* inverse) {
  for (int j = 0; j < m; ++j) {
    double pivot = a[m * j + j];
    for (int p = 0; p < j; ++p) pivot -= a[m * p + j] * a[m * p + j];
    if (!(pivot > 0.0)) return false;
    pivot = std::sqrt(pivot);
    a[m * j + j] = pivot;
    for (int i = j + 1; i < m; ++i) {
      double entry = a[m * j + i];
      for (int p = 0; p < j; ++p) entry -= a[m * p + i] * a[m * p + j];
      a[m * j + i] = entry / pivot;
    }
  }
  for (int j = 0; j < m; ++j)
    for (int i = 0; i < m; ++i) {
      if (i < j) {
        inverse[m * j + i] = 0.0;
        continue;
      }
      double entry = i == j ? 1.0 : 0.0;
      for (int p = j; p < i; ++p) entry -= a[m * p + i] * inverse[m * j + p];
      inverse[m * j + i] = entry / a[m * i + i];
    }
  return true;
}

}  // namespace mixbeam::dense
