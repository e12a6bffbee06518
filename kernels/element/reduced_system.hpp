/// What remains of an element after N and M are eliminated, and its solution for the interior unknowns: theory (29).
#pragma once

#include "kernels/element/condensed_layout.hpp"
#include "kernels/element/layout.hpp"
#include "kernels/execution/pack.hpp"
#include "kernels/math/small_algebra.hpp"

#include <cmath>
#include <limits>
#include <utility>

namespace mixbeam {

/// Unknowns of the reduced system in blocks of three, all in the element frame:
///   w | psi_1 .. psi_{k-1} | slope_1 .. slope_{k-1} || slope_0 | spin of vertex a | spin of vertex b.
/// The first 2k - 1 blocks are interior; slope_0 = Lambda_lo^T (u_b - u_a)/h carries both vertex displacements.
template <int K>
struct ReducedBlocks {
  static constexpr int kInterior = 2 * K - 1;
  static constexpr int kCount = 2 * K + 2;
  KOKKOS_INLINE_FUNCTION static constexpr int spin() { return 0; }
  KOKKOS_INLINE_FUNCTION static constexpr int psi(int j) { return j; }
  KOKKOS_INLINE_FUNCTION static constexpr int slope(int j) { return j == 0 ? 2 * K - 1 : K - 1 + j; }
  KOKKOS_INLINE_FUNCTION static constexpr int vertex(int end) { return 2 * K + end; }
};

/// The symmetric reduced system: block lower triangle of the matrix, and the reduced gradient.
template <int K, class Real = double>
struct ReducedSystem {
  static constexpr int kBlocks = ReducedBlocks<K>::kCount;
  Mat3<Real> block[kBlocks * (kBlocks + 1) / 2];
  Vec3<Real> rhs[kBlocks];

  /// row >= column
  KOKKOS_FORCEINLINE_FUNCTION Mat3<Real>& operator()(int row, int column) {
    return block[row * (row + 1) / 2 + column];
  }
  KOKKOS_FORCEINLINE_FUNCTION const Mat3<Real>& operator()(int row, int column) const {
    return block[row * (row + 1) / 2 + column];
  }
  KOKKOS_FORCEINLINE_FUNCTION void add(int row, int column, const Mat3<Real>& m) { (*this)(row, column) += m; }
  KOKKOS_FORCEINLINE_FUNCTION void add(int row, int column, const Real& factor, const Mat3<Real>& m) {
    (*this)(row, column) += factor * m;
  }
  KOKKOS_FORCEINLINE_FUNCTION void clear() {
    for (int b = 0; b < kBlocks * (kBlocks + 1) / 2; ++b) block[b] = zero_matrix<Real>();
    for (int b = 0; b < kBlocks; ++b) rhs[b] = {{Real(0.0), Real(0.0), Real(0.0)}};
  }
};

/// Response of the interior unknowns: their change for a unit change of slope_0 and of either vertex spin, and the
/// constant part.
template <int K, class Real = double>
struct InteriorResponse {
  static constexpr int kInterior = ReducedBlocks<K>::kInterior;
  Mat3<Real> by[kInterior][3];
  Vec3<Real> constant[kInterior];
  /// Row of three numbers of one interior unknown: column < 9 or the constant part.
  KOKKOS_FORCEINLINE_FUNCTION const Real& operator()(int row, int column) const {
    return column < 9 ? by[row / 3][column / 3](row % 3, column % 3) : constant[row / 3][row % 3];
  }
};

/// What is left for slope_0 and both vertex spins.
template <class Real = double>
struct VertexSystem {
  Mat3<Real> matrix[3][3];  ///< a symmetric system has its lower triangle only
  Vec3<Real> gradient[3];
};

/// The reduced system in double with all of its entries: it need not be symmetric.
template <int K>
struct FullSystem {
  static constexpr int kSize = 3 * ReducedBlocks<K>::kCount;
  static constexpr int kInteriorSize = 3 * ReducedBlocks<K>::kInterior;
  double matrix[kSize][kSize];
  double rhs[kSize];

  /// One lane of a symmetric system.
  template <int W>
  KOKKOS_INLINE_FUNCTION FullSystem(const ReducedSystem<K, Pack<W>>& symmetric, int lane) {
    for (int i = 0; i < kSize; ++i) {
      for (int j = 0; j <= i; ++j) matrix[i][j] = matrix[j][i] = symmetric(i / 3, j / 3)(i % 3, j % 3)[lane];
      rhs[i] = symmetric.rhs[i / 3][i % 3][lane];
    }
  }
  KOKKOS_INLINE_FUNCTION void add(int row, int column, double factor, const Mat3<double>& m) {
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) matrix[3 * row + i][3 * column + j] += factor * m(i, j);
  }
};

/// Gaussian elimination with row pivoting of N rows and M columns: the first N columns become upper triangular. A zero
/// pivot leaves non-finite numbers, which the residual test of the same iteration reports. Returns whether the
/// determinant of these columns is negative. Always inlined: a copy of a file that is not optimised might be the one
/// that the linker takes for all.
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

/// Response -H_ii^-1 [H_ir | R_i] of the interior blocks, and the system condensed with it, theory (29). Inlined, as
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

/// A pivot below this multiple of the largest one, rows scaled to entries of one, may owe its sign to rounding.
constexpr double kUncertainPivot = 1e-13;

/// What an element adds to J0 of theory (47): eigenvalues below zero of its interior while its vertices stand still.
struct InteriorSigns {
  int negative = 0;        ///< without a potential: their parity alone
  bool uncertain = false;  ///< a pivot is zero within rounding
};

/// Of a symmetric matrix in the first N rows and columns of `a`, which is overwritten. Sylvester's law of inertia with
/// the pivots of Bunch and Parlett: blocks of two, which have one eigenvalue of either sign, where no diagonal entry is
/// large enough.
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
    if (!(size > kUncertainPivot * largest_pivot)) {  // also not a number
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
    exchange(k + 1, row);  // column < row, so that the first exchange leaves it
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

/// Loads without a potential that are small, or zero, leave a matrix that is taken as symmetric (see Stability).
constexpr double kInteriorAsymmetry = 1e-9;

/// Of the interior of a system. `has_potential` false: it need not be symmetric.
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

/// A pivot that is not above this multiple of the entry that was on the diagonal before the elimination may owe its
/// sign to rounding. As long as all pivots are above it the interior matrix is positive definite, and elimination
/// without pivoting then loses no more than one with it, whatever the condition number (Higham, Accuracy and Stability
/// of Numerical Algorithms, theorem 10.3): about the rounding of as many products as the largest matrix has rows.
constexpr double kSmallestPivot = 50 * std::numeric_limits<double>::epsilon();

/// c -= a b^T
template <class Real>
KOKKOS_FORCEINLINE_FUNCTION void subtract_product_transposed(const Mat3<Real>& a, const Mat3<Real>& b, Mat3<Real>& c) {
  c = {{{c(0, 0) - a(0, 0) * b(0, 0) - a(0, 1) * b(0, 1) - a(0, 2) * b(0, 2),
         c(0, 1) - a(0, 0) * b(1, 0) - a(0, 1) * b(1, 1) - a(0, 2) * b(1, 2),
         c(0, 2) - a(0, 0) * b(2, 0) - a(0, 1) * b(2, 1) - a(0, 2) * b(2, 2)},
        {c(1, 0) - a(1, 0) * b(0, 0) - a(1, 1) * b(0, 1) - a(1, 2) * b(0, 2),
         c(1, 1) - a(1, 0) * b(1, 0) - a(1, 1) * b(1, 1) - a(1, 2) * b(1, 2),
         c(1, 2) - a(1, 0) * b(2, 0) - a(1, 1) * b(2, 1) - a(1, 2) * b(2, 2)},
        {c(2, 0) - a(2, 0) * b(0, 0) - a(2, 1) * b(0, 1) - a(2, 2) * b(0, 2),
         c(2, 1) - a(2, 0) * b(1, 0) - a(2, 1) * b(1, 1) - a(2, 2) * b(1, 2),
         c(2, 2) - a(2, 0) * b(2, 0) - a(2, 1) * b(2, 1) - a(2, 2) * b(2, 2)}}};
}
/// c -= a^T b
template <class Real>
KOKKOS_FORCEINLINE_FUNCTION void subtract_transposed_product(const Mat3<Real>& a, const Mat3<Real>& b, Mat3<Real>& c) {
  c = {{{c(0, 0) - a(0, 0) * b(0, 0) - a(1, 0) * b(1, 0) - a(2, 0) * b(2, 0),
         c(0, 1) - a(0, 0) * b(0, 1) - a(1, 0) * b(1, 1) - a(2, 0) * b(2, 1),
         c(0, 2) - a(0, 0) * b(0, 2) - a(1, 0) * b(1, 2) - a(2, 0) * b(2, 2)},
        {c(1, 0) - a(0, 1) * b(0, 0) - a(1, 1) * b(1, 0) - a(2, 1) * b(2, 0),
         c(1, 1) - a(0, 1) * b(0, 1) - a(1, 1) * b(1, 1) - a(2, 1) * b(2, 1),
         c(1, 2) - a(0, 1) * b(0, 2) - a(1, 1) * b(1, 2) - a(2, 1) * b(2, 2)},
        {c(2, 0) - a(0, 2) * b(0, 0) - a(1, 2) * b(1, 0) - a(2, 2) * b(2, 0),
         c(2, 1) - a(0, 2) * b(0, 1) - a(1, 2) * b(1, 1) - a(2, 2) * b(2, 1),
         c(2, 2) - a(0, 2) * b(0, 2) - a(1, 2) * b(1, 2) - a(2, 2) * b(2, 2)}}};
}
template <class Real>
KOKKOS_FORCEINLINE_FUNCTION void subtract_product(const Mat3<Real>& a, const Vec3<Real>& b, Vec3<Real>& c) {
  c = {{c[0] - a(0, 0) * b[0] - a(0, 1) * b[1] - a(0, 2) * b[2],
        c[1] - a(1, 0) * b[0] - a(1, 1) * b[1] - a(1, 2) * b[2],
        c[2] - a(2, 0) * b[0] - a(2, 1) * b[1] - a(2, 2) * b[2]}};
}
template <class Real>
KOKKOS_FORCEINLINE_FUNCTION void subtract_transposed_product(const Mat3<Real>& a, const Vec3<Real>& b, Vec3<Real>& c) {
  c = {{c[0] - a(0, 0) * b[0] - a(1, 0) * b[1] - a(2, 0) * b[2],
        c[1] - a(0, 1) * b[0] - a(1, 1) * b[1] - a(2, 1) * b[2],
        c[2] - a(0, 2) * b[0] - a(1, 2) * b[1] - a(2, 2) * b[2]}};
}

/// H_ii = L D L^T without pivoting, in lanes, on the triangle alone. The factor takes the place of the matrix: L in the
/// blocks below the diagonal and below the diagonal of the diagonal blocks, D^-1 on the diagonal.
template <int K, int W>
class InteriorFactor {
  using Real = Pack<W>;
  static constexpr int kInterior = ReducedBlocks<K>::kInterior, kCount = ReducedBlocks<K>::kCount;

 public:
  typename Real::Mask suspicious;  ///< lanes with a pivot that is not above kSmallestPivot; also those with NaN

  /// Factors the interior and leaves the condensed system.
  KOKKOS_FORCEINLINE_FUNCTION InteriorFactor(ReducedSystem<K, Real>& system, VertexSystem<Real>& condensed)
      : suspicious(Real(0.0) > Real(0.0)), factor_(system) {
    Mat3<Real> unscaled[kInterior];  // row I of L D
    for (int I = 0; I < kCount; ++I) {
      const int last = I < kInterior ? I : kInterior;
      for (int J = 0; J < last; ++J) {
        Mat3<Real> rest = remainder(unscaled, I, J, J);
        solve_right(factor_(J, J), rest);
        unscaled[J] = rest;
        scale_columns(factor_(J, J), rest);
        factor_(I, J) = rest;
      }
      if (I < kInterior)
        factor_diagonal(remainder(unscaled, I, I, I), factor_(I, I));
      else
        for (int J = kInterior; J <= I; ++J)
          condensed.matrix[I - kInterior][J - kInterior] = remainder(unscaled, I, J, kInterior);
    }
    solve_gradient(condensed);
  }

  /// Response -H_ii^-1 [H_ir | R_i].
  KOKKOS_FORCEINLINE_FUNCTION void solve(InteriorResponse<K, Real>& response) const {
    for (int J = kInterior - 1; J >= 0; --J) {
      for (int c = 0; c < 3; ++c) {
        Mat3<Real> x = -1.0 * transpose(factor_(kInterior + c, J));
        for (int k = J + 1; k < kInterior; ++k) subtract_transposed_product(factor_(k, J), response.by[k][c], x);
        const Mat3<Real>& l = factor_(J, J);
        for (int j = 0; j < 3; ++j) {
          x(1, j) -= l(2, 1) * x(2, j);
          x(0, j) -= l(1, 0) * x(1, j) + l(2, 0) * x(2, j);
        }
        response.by[J][c] = x;
      }
      const Mat3<Real>& l = factor_(J, J);
      const Vec3<Real>& y = gradient_[J];
      Vec3<Real> x{{-y[0] * l(0, 0), -y[1] * l(1, 1), -y[2] * l(2, 2)}};
      for (int k = J + 1; k < kInterior; ++k) subtract_transposed_product(factor_(k, J), response.constant[k], x);
      x[1] -= l(2, 1) * x[2];
      x[0] -= l(1, 0) * x[1] + l(2, 0) * x[2];
      response.constant[J] = x;
    }
  }

 private:
  ReducedSystem<K, Real>& factor_;
  Vec3<Real> gradient_[kInterior];  ///< L^-1 R_i

  /// H_IJ - sum over the blocks before `end` of (L D)_I L_J^T
  KOKKOS_FORCEINLINE_FUNCTION Mat3<Real> remainder(const Mat3<Real>* unscaled, int I, int J, int end) const {
    Mat3<Real> rest = factor_(I, J);
    for (int k = 0; k < end; ++k) subtract_product_transposed(unscaled[k], factor_(J, k), rest);
    return rest;
  }
  /// rest L_JJ^-T
  KOKKOS_FORCEINLINE_FUNCTION static void solve_right(const Mat3<Real>& l, Mat3<Real>& rest) {
    for (int i = 0; i < 3; ++i) {
      rest(i, 1) -= rest(i, 0) * l(1, 0);
      rest(i, 2) -= rest(i, 0) * l(2, 0) + rest(i, 1) * l(2, 1);
    }
  }
  KOKKOS_FORCEINLINE_FUNCTION static void scale_columns(const Mat3<Real>& l, Mat3<Real>& rest) {
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) rest(i, j) *= l(j, j);
  }
  /// `diagonal` holds the block of the matrix on entry.
  KOKKOS_FORCEINLINE_FUNCTION void factor_diagonal(const Mat3<Real>& rest, Mat3<Real>& diagonal) {
    const Real d0 = rest(0, 0), inverse0 = 1.0 / d0, l10 = rest(1, 0) * inverse0, l20 = rest(2, 0) * inverse0;
    const Real d1 = rest(1, 1) - l10 * rest(1, 0), inverse1 = 1.0 / d1, u21 = rest(2, 1) - l20 * rest(1, 0);
    const Real l21 = u21 * inverse1, d2 = rest(2, 2) - l20 * rest(2, 0) - l21 * u21;
    suspicious |= ~(d0 > kSmallestPivot * fabs(diagonal(0, 0)));
    suspicious |= ~(d1 > kSmallestPivot * fabs(diagonal(1, 1)));
    suspicious |= ~(d2 > kSmallestPivot * fabs(diagonal(2, 2)));
    diagonal(0, 0) = inverse0;
    diagonal(1, 0) = l10;
    diagonal(2, 0) = l20;
    diagonal(1, 1) = inverse1;
    diagonal(2, 1) = l21;
    diagonal(2, 2) = 1.0 / d2;
  }
  KOKKOS_FORCEINLINE_FUNCTION void solve_gradient(VertexSystem<Real>& condensed) {
    for (int I = 0; I < kCount; ++I) {
      Vec3<Real> rest = factor_.rhs[I];
      for (int k = 0; k < (I < kInterior ? I : kInterior); ++k) subtract_product(factor_(I, k), gradient_[k], rest);
      if (I < kInterior) {
        const Mat3<Real>& l = factor_(I, I);
        rest[1] -= l(1, 0) * rest[0];
        rest[2] -= l(2, 0) * rest[0] + l(2, 1) * rest[1];
        gradient_[I] = rest;
      } else {
        condensed.gradient[I - kInterior] = rest;
      }
    }
  }
};

/// Response and condensed system of one lane, by a system of its own, with row pivoting.
template <int K, int W>
KOKKOS_FUNCTION __attribute__((noinline)) void solve_one_lane(const FullSystem<K>& system, int lane,
                                                              InteriorResponse<K, Pack<W>>& response,
                                                              VertexSystem<Pack<W>>& condensed) {
  InteriorResponse<K> one;
  VertexSystem<> one_condensed;
  solve_with_row_pivoting(system, one, one_condensed);
  for (int b = 0; b < ReducedBlocks<K>::kInterior; ++b)
    for (int i = 0; i < 3; ++i) {
      for (int c = 0; c < 9; ++c) response.by[b][c / 3](i, c % 3).set(lane, one.by[b][c / 3](i, c % 3));
      response.constant[b][i].set(lane, one.constant[b][i]);
    }
  for (int I = 0; I < 3; ++I)
    for (int i = 0; i < 3; ++i) {
      for (int c = 0; c < 9; ++c)
        condensed.matrix[I][c / 3](i, c % 3).set(lane, one_condensed.matrix[I][c / 3](i, c % 3));
      condensed.gradient[I][i].set(lane, one_condensed.gradient[I][i]);
    }
}

/// As solve_with_row_pivoting for symmetric systems side by side: without pivoting, but for the lanes that need it.
/// `signs` (null, or W of them): of those lanes; all others are positive definite.
template <int K, int W>
KOKKOS_FORCEINLINE_FUNCTION void solve_in_lanes(const ReducedSystem<K, Pack<W>>& system,
                                                InteriorResponse<K, Pack<W>>& response,
                                                VertexSystem<Pack<W>>& condensed, InteriorSigns* signs = nullptr) {
  ReducedSystem<K, Pack<W>> factored = system;
  const InteriorFactor<K, W> factor(factored, condensed);
  factor.solve(response);
  if (any<W>(factor.suspicious))
    for (int lane = 0; lane < W; ++lane)
      if (factor.suspicious[lane] != 0) {
        const FullSystem<K> one(system, lane);
        solve_one_lane(one, lane, response, condensed);
        if (signs != nullptr) signs[lane] = interior_signs(one, true);
      }
}

}  // namespace mixbeam
