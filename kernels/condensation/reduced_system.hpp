/// Equations of an element after the elimination of N and M: theory (29).
#pragma once

#include "kernels/condensation/condensed_layout.hpp"
#include "kernels/element/layout.hpp"
#include "kernels/execution/pack.hpp"
#include "kernels/math/small_algebra.hpp"

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

/// Symmetric reduced system: block lower triangle of the matrix, and the reduced gradient.
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
  /// Entry of one interior unknown: column < 9, or 9 for the constant part.
  KOKKOS_FORCEINLINE_FUNCTION const Real& operator()(int row, int column) const {
    return column < 9 ? by[row / 3][column / 3](row % 3, column % 3) : constant[row / 3][row % 3];
  }
};

/// Equations of slope_0 and both vertex spins.
template <class Real = double>
struct VertexSystem {
  Mat3<Real> matrix[3][3];  ///< a symmetric system has its lower triangle only
  Vec3<Real> gradient[3];
};

/// Reduced system with all of its entries, not necessarily symmetric.
template <int K, class Real = double>
struct FullSystem {
  static constexpr int kSize = 3 * ReducedBlocks<K>::kCount;
  static constexpr int kInteriorSize = 3 * ReducedBlocks<K>::kInterior;
  Real matrix[kSize][kSize];
  Real rhs[kSize];

  /// Expands a symmetric system; `number` converts each entry.
  template <class Other, class Number>
  KOKKOS_INLINE_FUNCTION FullSystem(const ReducedSystem<K, Other>& symmetric, const Number& number) {
    for (int i = 0; i < kSize; ++i) {
      for (int j = 0; j <= i; ++j) matrix[i][j] = matrix[j][i] = number(symmetric(i / 3, j / 3)(i % 3, j % 3));
      rhs[i] = number(symmetric.rhs[i / 3][i % 3]);
    }
  }
  template <class Other, class Number>
  KOKKOS_INLINE_FUNCTION FullSystem(const FullSystem<K, Other>& system, const Number& number) {
    for (int i = 0; i < kSize; ++i) {
      for (int j = 0; j < kSize; ++j) matrix[i][j] = number(system.matrix[i][j]);
      rhs[i] = number(system.rhs[i]);
    }
  }
  KOKKOS_FORCEINLINE_FUNCTION Mat3<Real> block(int row, int column) const {
    Mat3<Real> m;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) m(i, j) = matrix[3 * row + i][3 * column + j];
    return m;
  }
  KOKKOS_FORCEINLINE_FUNCTION void set_block(int row, int column, const Mat3<Real>& m) {
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) matrix[3 * row + i][3 * column + j] = m(i, j);
  }
  KOKKOS_INLINE_FUNCTION void add(int row, int column, const Real& factor, const Mat3<Real>& m) {
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) matrix[3 * row + i][3 * column + j] += factor * m(i, j);
  }
};

}  // namespace mixbeam
