/// Solves the reduced system for the interior unknowns with row pivoting, symmetric or not, and counts the signs of its
/// interior: one element at a time.
#pragma once

#include "kernels/condensation/reduced_system.hpp"

#include <cmath>
#include <utility>

namespace mixbeam {

/// Gaussian elimination with row pivoting of N rows and M columns: the first N columns become upper triangular. Returns
/// true if the determinant of these columns is negative. A zero pivot leaves non-finite numbers, which the residual
/// test of the same iteration reports. Always inlined: the linker might otherwise keep a copy from a file that is not
/// optimised.
template <int N, int M>
KOKKOS_FORCEINLINE_FUNCTION bool eliminate_rows(double (*a)[M]) {
  bool is_negative = false;
  for (int k = 0; k < N; ++k) {
    int pivot = k;
    double largest = a[k][k] < 0 ? -a[k][k] : a[k][k];
    for (int i = k + 1; i < N; ++i) {
      const double size = a[i][k] < 0 ? -a[i][k] : a[i][k];
      if (size > largest) {
        largest = size;
        pivot = i;
      }
    }
    if (pivot != k)
      for (int j = k; j < M; ++j) {
        const double swap = a[k][j];
        a[k][j] = a[pivot][j];
        a[pivot][j] = swap;
      }
    is_negative ^= (pivot != k) != (a[k][k] < 0.0);
    const double inverse = 1.0 / a[k][k];
    for (int i = k + 1; i < N; ++i) {
      const double factor = a[i][k] * inverse;
#pragma omp simd
      for (int j = k + 1; j < M; ++j) a[i][j] -= factor * a[k][j];
    }
  }
  return is_negative;
}

/// Response -H_ii^-1 [H_ir | R_i] of the interior blocks, and the condensed system, theory (29). Inlined like
/// eliminate_rows().
template <int K>
KOKKOS_FORCEINLINE_FUNCTION void solve_with_row_pivoting(const FullSystem<K>& system, InteriorResponse<K>& response,
                                                         VertexSystem<>& condensed) {
  constexpr int n = FullSystem<K>::kInteriorSize, m = n + kResponseColumns;
  double a[n][m], x[n][kResponseColumns];
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n + 9; ++j) a[i][j] = system.matrix[i][j];
    a[i][n + 9] = system.rhs[i];
  }
  eliminate_rows<n, m>(a);
  for (int i = n - 1; i >= 0; --i) {
    const double inverse = 1.0 / a[i][i];
    double sum[kResponseColumns];
    for (int c = 0; c < kResponseColumns; ++c) sum[c] = -a[i][n + c];
    for (int j = i + 1; j < n; ++j)
#pragma omp simd
      for (int c = 0; c < kResponseColumns; ++c) sum[c] -= a[i][j] * x[j][c];
    for (int c = 0; c < kResponseColumns; ++c) x[i][c] = sum[c] * inverse;
  }
  for (int i = 0; i < n; ++i) {
    for (int c = 0; c < 9; ++c) response.by[i / 3][c / 3](i % 3, c % 3) = x[i][c];
    response.constant[i / 3][i % 3] = x[i][9];
  }
  for (int r = 0; r < 9; ++r) {
    double sum[kResponseColumns];
    for (int c = 0; c < 9; ++c) sum[c] = system.matrix[n + r][n + c];
    sum[9] = system.rhs[n + r];
    for (int i = 0; i < n; ++i)
      for (int c = 0; c < kResponseColumns; ++c) sum[c] += system.matrix[n + r][i] * x[i][c];
    for (int c = 0; c < 9; ++c) condensed.matrix[r / 3][c / 3](r % 3, c % 3) = sum[c];
    condensed.gradient[r / 3][r % 3] = sum[9];
  }
}

/// Relative to the largest pivot, rows scaled to entries of one: smaller pivots may owe their sign to rounding.
constexpr double kUncertainPivot = 1e-13;

/// Contribution of an element to J0 of theory (47): negative eigenvalues of its interior with fixed vertices.
struct InteriorSigns {
  int negative = 0;        ///< parity only, if there is no potential
  bool uncertain = false;  ///< a pivot is zero within rounding
};

/// Counts the signs of a symmetric matrix in the first N rows and columns of `a`, which is overwritten. Sylvester's law
/// of inertia with the pivots of Bunch and Parlett: where no diagonal entry is large enough, a block of two, which has
/// one eigenvalue of either sign.
template <int N, int M>
InteriorSigns count_negative(double (*a)[M]) {
  constexpr double kBunchParlett = 0.6403882032022076;  // (1 + sqrt(17)) / 8
  InteriorSigns signs;
  double scale[N], largest_pivot = 0.0;
  for (int i = 0; i < N; ++i) {
    double row = 0.0;
    for (int j = 0; j < N; ++j) row = std::fmax(row, std::fabs(a[i][j]));
    scale[i] = row > 0.0 ? 1.0 / std::sqrt(row) : 1.0;
  }
  for (int i = 0; i < N; ++i)
    for (int j = 0; j < N; ++j) a[i][j] *= scale[i] * scale[j];
  const auto exchange = [a](int k, int with) {
    if (k == with) return;
    for (int j = 0; j < N; ++j) std::swap(a[k][j], a[with][j]);
    for (int i = 0; i < N; ++i) std::swap(a[i][k], a[i][with]);
  };
  for (int k = 0; k < N;) {
    int diagonal = k, row = k, column = k;
    double beside = 0.0;
    for (int i = k; i < N; ++i) {
      if (std::fabs(a[i][i]) > std::fabs(a[diagonal][diagonal])) diagonal = i;
      for (int j = k; j < i; ++j)
        if (std::fabs(a[i][j]) > beside) {
          beside = std::fabs(a[i][j]);
          row = i;
          column = j;
        }
    }
    const double on_diagonal = std::fabs(a[diagonal][diagonal]), size = std::fmax(on_diagonal, beside);
    largest_pivot = std::fmax(largest_pivot, size);
    if (!(size > kUncertainPivot * largest_pivot)) {  // also NaN
      signs.uncertain = true;
      return signs;
    }
    if (on_diagonal >= kBunchParlett * beside) {
      exchange(k, diagonal);
      if (a[k][k] < 0.0) ++signs.negative;
      for (int i = k + 1; i < N; ++i)
        for (int j = k + 1; j < N; ++j) a[i][j] -= a[i][k] / a[k][k] * a[k][j];
      ++k;
      continue;
    }
    exchange(k, column);
    exchange(k + 1, row);  // column < row: the first exchange does not move it
    ++signs.negative;
    const double p = a[k][k], q = a[k + 1][k], r = a[k + 1][k + 1], inverse = 1.0 / (p * r - q * q);
    for (int i = k + 2; i < N; ++i) {
      const double x = (r * a[i][k] - q * a[i][k + 1]) * inverse, y = (p * a[i][k + 1] - q * a[i][k]) * inverse;
      for (int j = k + 2; j < N; ++j) a[i][j] -= x * a[k][j] + y * a[k + 1][j];
    }
    k += 2;
  }
  return signs;
}

/// Loads without a potential below this relative asymmetry leave a matrix that is treated as symmetric (see Stability).
constexpr double kInteriorAsymmetry = 1e-9;

/// Counts the signs of the interior of a system, which is symmetric if `has_potential`.
template <int K>
__attribute__((noinline)) InteriorSigns interior_signs(const FullSystem<K>& system, bool has_potential) {
  constexpr int n = FullSystem<K>::kInteriorSize;
  double a[n][n];
  bool symmetric = true;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      a[i][j] = system.matrix[i][j];
      const double scale = kInteriorAsymmetry * std::sqrt(std::fabs(system.matrix[i][i] * system.matrix[j][j]));
      if (!has_potential && std::fabs(a[i][j] - system.matrix[j][i]) > scale) symmetric = false;
    }
  if (symmetric) return count_negative<n, n>(a);
  return {eliminate_rows<n, n>(a) ? 1 : 0, false};
}

}  // namespace mixbeam
