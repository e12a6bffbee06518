#include "nonlinear/multilevel/dense.hpp"

#include "nonlinear/linear/blas_setup.hpp"

#include <algorithm>
#include <cmath>
#include <type_traits>

extern "C" void dgemm_(const char*, const char*, const int*, const int*, const int*, const double*, const double*,
                       const int*, const double*, const int*, const double*, double*, const int*);

namespace mixbeam::dense {

namespace {

/// Adds C += A B for a tile of Packs * Width rows and Columns columns of C, which is kept in registers.
template <int Packs, int Width, int Columns>
void add_tile(int k, const double* a, int a_stride, const double* b, int b_row, int b_column, double* c, int c_stride) {
  Pack<Width> sum[Columns][Packs];
  for (int j = 0; j < Columns; ++j)
    for (int q = 0; q < Packs; ++q) sum[j][q] = Pack<Width>::loaded(c + static_cast<size_t>(c_stride) * j + Width * q);
  for (int p = 0; p < k; ++p) {
    Pack<Width> from[Packs];
    for (int q = 0; q < Packs; ++q) from[q] = Pack<Width>::loaded(a + static_cast<size_t>(a_stride) * p + Width * q);
    for (int j = 0; j < Columns; ++j) {
      const Pack<Width> factor = b[static_cast<size_t>(b_row) * p + static_cast<size_t>(b_column) * j];
      for (int q = 0; q < Packs; ++q) sum[j][q] += from[q] * factor;
    }
  }
  for (int j = 0; j < Columns; ++j)
    for (int q = 0; q < Packs; ++q) store(sum[j][q], c + static_cast<size_t>(c_stride) * j + Width * q);
}

/// Multiplications above which BLAS computes a product: from about 50 rows on.
constexpr double kLargeProduct = 1e5;

void add_large_product(int m, int k, int n, const double* a, int a_stride, const double* b, const char* b_form,
                       int b_stride, double* c, int c_stride) {
  const double one = 1.0;
  const auto turn = turn_for_blas();
  dgemm_("N", b_form, &m, &n, &k, &one, a, &a_stride, b, &b_stride, &one, c, &c_stride);
}

}  // namespace

/// Uses tiles except for large products: most blocks have 6 to 40 rows, for which a call of BLAS gains nothing.
void add_product(int m, int k, int n, const double* a, int a_stride, const double* b, int b_row, int b_column,
                 double* c, int c_stride) {
  constexpr int kColumns = 4;
  if (static_cast<double>(m) * k * n > kLargeProduct && (b_row == 1 || b_column == 1))
    return add_large_product(m, k, n, a, a_stride, b, b_row == 1 ? "N" : "T", b_row == 1 ? b_column : b_row, c,
                             c_stride);
  int i = 0;
  const auto add_rows = [&](auto packs, auto width) {
    constexpr int kPacks = decltype(packs)::value, kWidth = decltype(width)::value;
    for (; i + kPacks * kWidth <= m; i += kPacks * kWidth) {
      int j = 0;
      for (; j + kColumns <= n; j += kColumns)
        add_tile<kPacks, kWidth, kColumns>(k, a + i, a_stride, b + static_cast<size_t>(b_column) * j, b_row, b_column,
                                           c + static_cast<size_t>(c_stride) * j + i, c_stride);
      for (; j < n; ++j)
        add_tile<kPacks, kWidth, 1>(k, a + i, a_stride, b + static_cast<size_t>(b_column) * j, b_row, b_column,
                                    c + static_cast<size_t>(c_stride) * j + i, c_stride);
    }
  };
  using One = std::integral_constant<int, 1>;
  add_rows(std::integral_constant<int, 2>(), std::integral_constant<int, kLanes>());
  add_rows(One(), std::integral_constant<int, kLanes>());
  if constexpr (kLanes > 4) add_rows(One(), std::integral_constant<int, 4>());
  if constexpr (kLanes > 2) add_rows(One(), std::integral_constant<int, 2>());
  add_rows(One(), One());
}

void add_lower_product(int m, int k, const double* a, int a_stride, const double* b, int b_row, int b_column,
                       double* c) {
  constexpr int kPanel = 8;
  for (int j = 0; j < m; j += kPanel)
    add_product(m - j, k, std::min(kPanel, m - j), a + j, a_stride, b + static_cast<size_t>(b_column) * j, b_row,
                b_column, c + static_cast<size_t>(m) * j + j, m);
}

bool inverse_cholesky(int m, double* a, double* inverse) {
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

template <bool WithProduct, class Value>
void multiply_both_ways(int m, int n, const Value* a, const double* z, double* transposed, const double* x, double* y) {
  int j = 0;
  const auto add = [&](auto columns) {
    constexpr int kColumns = decltype(columns)::value;
    for (; j + kColumns <= n; j += kColumns)
      add_columns<kColumns, WithProduct>(m, a + static_cast<size_t>(m) * j, z, transposed + j,
                                         x + (WithProduct ? j : 0), y);
  };
  add(std::integral_constant<int, 8>());
  add(std::integral_constant<int, 4>());
  add(std::integral_constant<int, 2>());
  add(std::integral_constant<int, 1>());
}

template void multiply_both_ways<true>(int, int, const double*, const double*, double*, const double*, double*);
template void multiply_both_ways<true>(int, int, const float*, const double*, double*, const double*, double*);
template void multiply_both_ways<false>(int, int, const double*, const double*, double*, const double*, double*);

}  // namespace mixbeam::dense
