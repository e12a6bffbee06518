/// Solves the symmetric reduced system for the interior unknowns, several elements side by side.
#pragma once

#include "kernels/condensation/row_pivoting.hpp"

#include <limits>

namespace mixbeam {

/// The sign of a pivot may be due to rounding unless the pivot exceeds this multiple of the original diagonal entry. If
/// all pivots exceed it, the interior matrix is positive definite and elimination without pivoting is as accurate as
/// with it, whatever the condition number (Higham, Accuracy and Stability of Numerical Algorithms, theorem 10.3). The
/// value is about the rounding of as many products as the largest matrix has rows.
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

/// Factors H_ii = L D L^T without pivoting, in lanes, on the lower triangle. The factor overwrites the matrix: L in the
/// blocks below the diagonal and in the strict lower part of the diagonal blocks, D^-1 on the diagonal.
template <int K, int W>
class InteriorFactor {
  using Real = Pack<W>;
  static constexpr int kInterior = ReducedBlocks<K>::kInterior, kCount = ReducedBlocks<K>::kCount;

 public:
  typename Real::Mask suspicious;  ///< lanes with a pivot not above kSmallestPivot, or with NaN

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

/// Response and condensed system of one lane, solved separately with row pivoting.
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

/// Solves symmetric systems side by side like solve_with_row_pivoting: without pivoting, except in lanes that need it.
/// `signs` (null, or W of them) is set for those lanes; all others are positive definite.
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
        const FullSystem<K> one(system, [lane](const Pack<W>& x) { return x[lane]; });
        solve_one_lane(one, lane, response, condensed);
        if (signs != nullptr) signs[lane] = interior_signs(one, true);
      }
}

/// c -= a b
template <class Real>
KOKKOS_FORCEINLINE_FUNCTION void subtract_product(const Mat3<Real>& a, const Mat3<Real>& b, Mat3<Real>& c) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) c(i, j) = c(i, j) - a(i, 0) * b(0, j) - a(i, 1) * b(1, j) - a(i, 2) * b(2, j);
}

/// Interior of an unsymmetric system = L U by blocks of three, without pivoting, in lanes and in place: L with unit
/// diagonal below, U above the diagonal, which holds the inverse of that of U.
template <int K, int W>
class GeneralFactor {
  using Real = Pack<W>;
  static constexpr int kInterior = ReducedBlocks<K>::kInterior, kCount = ReducedBlocks<K>::kCount;

 public:
  typename Real::Mask suspicious;  ///< as in InteriorFactor, or with growing factors

  /// Overwrites the right-hand side by L^-1 rhs and the vertex block by the condensed system.
  KOKKOS_FORCEINLINE_FUNCTION explicit GeneralFactor(FullSystem<K, Real>& system)
      : suspicious(Real(0.0) > Real(0.0)), a_(system) {
    Real size[3 * kInterior];
    for (int i = 0; i < 3 * kInterior; ++i) size[i] = fabs(a_.matrix[i][i]);
    for (int I = 0; I < kCount; ++I) {
      Vec3<Real> rest = load_vector(a_.rhs + 3 * I);
      for (int J = 0; J < kCount; ++J) {
        const int smaller = I < J ? I : J, last = smaller < kInterior ? smaller : kInterior;
        Mat3<Real> block = a_.block(I, J);
        for (int k = 0; k < last; ++k) subtract_product(a_.block(I, k), a_.block(k, J), block);
        if (I == J && I < kInterior) factor_diagonal(&size[3 * I], block);
        if (I < J && I < kInterior) solve_left(a_.block(I, I), block);
        if (I > J && J < kInterior) solve_right(a_.block(J, J), block);
        a_.set_block(I, J, block);
        if (J < I && J < kInterior) subtract_product(block, load_vector(a_.rhs + 3 * J), rest);
      }
      const Mat3<Real> l = a_.block(I, I);
      for (int i = 1; i < 3 && I < kInterior; ++i)
        for (int k = 0; k < i; ++k) rest[i] -= l(i, k) * rest[k];
      store_vector(rest, a_.rhs + 3 * I);
    }
    watch_growth(size);
  }

  /// Overwrites the columns of the vertices and the right-hand side by H_ii^-1 [H_ir | R_i].
  KOKKOS_FORCEINLINE_FUNCTION void solve() const {
    for (int I = kInterior - 1; I >= 0; --I) {
      const Mat3<Real> u = a_.block(I, I);
      for (int c = kInterior; c < kCount; ++c) {
        Mat3<Real> x = a_.block(I, c);
        for (int k = I + 1; k < kInterior; ++k) subtract_product(a_.block(I, k), a_.block(k, c), x);
        for (int i = 2; i >= 0; --i)
          for (int j = 0; j < 3; ++j) {
            for (int k = i + 1; k < 3; ++k) x(i, j) -= u(i, k) * x(k, j);
            x(i, j) *= u(i, i);
          }
        a_.set_block(I, c, x);
      }
      Vec3<Real> x = load_vector(a_.rhs + 3 * I);
      for (int k = I + 1; k < kInterior; ++k) subtract_product(a_.block(I, k), load_vector(a_.rhs + 3 * k), x);
      for (int i = 2; i >= 0; --i) {
        for (int k = i + 1; k < 3; ++k) x[i] -= u(i, k) * x[k];
        x[i] *= u(i, i);
      }
      store_vector(x, a_.rhs + 3 * I);
    }
  }

 private:
  FullSystem<K, Real>& a_;

  KOKKOS_FORCEINLINE_FUNCTION void factor_diagonal(const Real* size, Mat3<Real>& m) {
    for (int k = 0; k < 3; ++k) {
      suspicious |= ~(m(k, k) > kSmallestPivot * size[k]);
      m(k, k) = Real(1.0) / m(k, k);
      for (int i = k + 1; i < 3; ++i) {
        m(i, k) *= m(k, k);
        for (int j = k + 1; j < 3; ++j) m(i, j) -= m(i, k) * m(k, j);
      }
    }
  }
  /// L^-1 x
  KOKKOS_FORCEINLINE_FUNCTION static void solve_left(const Mat3<Real>& l, Mat3<Real>& x) {
    for (int i = 1; i < 3; ++i)
      for (int k = 0; k < i; ++k)
        for (int j = 0; j < 3; ++j) x(i, j) -= l(i, k) * x(k, j);
  }
  /// x U^-1
  KOKKOS_FORCEINLINE_FUNCTION static void solve_right(const Mat3<Real>& u, Mat3<Real>& x) {
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        for (int k = 0; k < j; ++k) x(i, j) -= x(i, k) * u(k, j);
        x(i, j) *= u(j, j);
      }
  }
  /// Allows entries twice as large as in a positive definite matrix: |l_ik| sqrt(u_kk) <= 2 sqrt(a_ii), and |u_kj| /
  /// sqrt(u_kk) likewise.
  KOKKOS_FORCEINLINE_FUNCTION void watch_growth(const Real* size) {
    constexpr double kGrowth = 4.0;
    for (int i = 0; i < 3 * kInterior; ++i)
      for (int k = 0; k < i; ++k) {
        const Real &l = a_.matrix[i][k], &u = a_.matrix[k][i], &inverse = a_.matrix[k][k];
        suspicious |= ~(l * l <= kGrowth * size[i] * inverse);
        suspicious |= ~(u * u * inverse <= kGrowth * size[i]);
      }
  }
};

/// Solves systems that need not be symmetric side by side, in the lanes of `wanted`; response, condensed system and
/// signs of the others are kept. Without pivoting, except in lanes that need it. `system()` makes the systems; `signs`:
/// null, or W of them.
template <int K, int W, class System>
KOKKOS_FORCEINLINE_FUNCTION void solve_general_in_lanes(const System& system, const typename Pack<W>::Mask& wanted,
                                                        InteriorResponse<K, Pack<W>>& response,
                                                        VertexSystem<Pack<W>>& condensed, InteriorSigns* signs) {
  using Real = Pack<W>;
  constexpr int n = FullSystem<K>::kInteriorSize;
  FullSystem<K, Real> a = system();
  const GeneralFactor<K, W> factor(a);
  factor.solve();
  const auto take = [&wanted](const Real& x, Real& to) { to = select(wanted, x, to); };
  for (int i = 0; i < n; ++i) {
    for (int c = 0; c < 9; ++c) take(-a.matrix[i][n + c], response.by[i / 3][c / 3](i % 3, c % 3));
    take(-a.rhs[i], response.constant[i / 3][i % 3]);
  }
  for (int r = 0; r < 9; ++r) {
    for (int c = 0; c < 9; ++c) take(a.matrix[n + r][n + c], condensed.matrix[r / 3][c / 3](r % 3, c % 3));
    take(a.rhs[n + r], condensed.gradient[r / 3][r % 3]);
  }
  for (int lane = 0; lane < W; ++lane) {
    if (wanted[lane] == 0) continue;
    if (signs != nullptr) signs[lane] = {};  // pivots are positive
    if (factor.suspicious[lane] == 0) continue;
    const FullSystem<K> one(system(), [lane](const Real& x) { return x[lane]; });
    solve_one_lane(one, lane, response, condensed);
    if (signs != nullptr) signs[lane] = interior_signs(one, false);
  }
}

}  // namespace mixbeam
