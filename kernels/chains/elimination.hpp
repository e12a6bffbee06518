/// Elimination of one vertex from a chain, theory (45): the arithmetic of chains/level.hpp, on `Real` numbers (lanes of
/// a Pack work on different chains). N unknowns for each vertex: 6 in space, 3 in a plane.
///
/// A link is a symmetric matrix over two vertices, [[K00, K10^T], [K10, K11]]. The pivot V holds a vertex between its
/// neighbours: it is as stiff as one link, however long the chain is.
#pragma once

#include "kernels/condensation/condensed_layout.hpp"
#include "kernels/execution/pack.hpp"

namespace mixbeam {

/// Symmetric matrix over both ends of a link: K00 and K11 as lower triangles, K10 with rows at the second vertex.
template <int N, class Real>
struct LinkMatrix {
  Real first[triangle_size(N)], coupling[N][N], second[triangle_size(N)];
};

/// L D L^T of one vertex block V, D inverted, and its coupling to the two neighbours.
template <int N, class Real>
struct VertexFactors {
  static constexpr int kSize = triangle_size(N) + 2 * N * N;
  Real factor[triangle_size(N)];  ///< strict lower triangle: L; diagonal: 1/D
  Real left[N][N], right[N][N];   ///< X, Y
};

/// Signs, theory (47), and sizes of the pivots met.
template <class Real>
struct PivotWatch {
  Real negative = 0.0;  ///< how many were below zero
  Real smallest = 1.0;  ///< least |pivot| / |diagonal entry before the elimination| of the vertex block
};

/// L D L^T of a symmetric block in place, without exchange of rows.
template <int N, class Real>
KOKKOS_INLINE_FUNCTION void factorize_block(Real* a, PivotWatch<Real>& watch) {
  using std::fabs;
  Real diagonal[N];
  for (int i = 0; i < N; ++i) diagonal[i] = a[triangle(i, i)];
#pragma GCC unroll 6
  for (int k = 0; k < N; ++k) {
    const Real pivot = a[triangle(k, k)];
    const Real ratio = fabs(pivot / diagonal[k]);
    watch.smallest = select(ratio >= watch.smallest, watch.smallest, ratio);  // keeps a ratio that is not a number
    watch.negative += select(pivot < Real(0.0), Real(1.0), Real(0.0));
    const Real inverse = Real(1.0) / pivot;
    a[triangle(k, k)] = inverse;
    Real column[N];
#pragma GCC unroll 6
    for (int i = k + 1; i < N; ++i) {
      column[i] = a[triangle(i, k)];
      a[triangle(i, k)] = column[i] * inverse;
    }
#pragma GCC unroll 6
    for (int i = k + 1; i < N; ++i)
#pragma GCC unroll 6
      for (int j = k + 1; j <= i; ++j) a[triangle(i, j)] -= a[triangle(i, k)] * column[j];
  }
}

/// V^-1 b in place.
template <int N, class Real>
KOKKOS_INLINE_FUNCTION void solve_block(const Real* factor, Real* b) {
#pragma GCC unroll 6
  for (int i = 1; i < N; ++i)
#pragma GCC unroll 6
    for (int j = 0; j < i; ++j) b[i] -= factor[triangle(i, j)] * b[j];
#pragma GCC unroll 6
  for (int i = N - 1; i >= 0; --i) {
    b[i] = b[i] * factor[triangle(i, i)];
#pragma GCC unroll 6
    for (int j = i + 1; j < N; ++j) b[i] -= factor[triangle(j, i)] * b[j];
  }
}

/// V^-1 times the given rows, or their transpose: X and Y, whose column c belongs to component c of the neighbour.
template <int N, class Real>
KOKKOS_INLINE_FUNCTION void hang_vertex(const Real (*rows)[N], bool rows_are_columns, const Real* factor,
                                        Real (*out)[N]) {
  for (int c = 0; c < N; ++c) {
    Real column[N];
#pragma GCC unroll 6
    for (int i = 0; i < N; ++i) column[i] = rows_are_columns ? rows[c][i] : rows[i][c];
    solve_block<N>(factor, column);
#pragma GCC unroll 6
    for (int i = 0; i < N; ++i) out[i][c] = column[i];
  }
}

/// Eliminates the vertex between `chain` and `next`, theory (45); `chain` becomes both in one.
template <int N, class Real>
KOKKOS_INLINE_FUNCTION void eliminate_vertex(LinkMatrix<N, Real>& chain, const LinkMatrix<N, Real>& next,
                                             VertexFactors<N, Real>& f, PivotWatch<Real>& watch) {
  for (int i = 0; i < triangle_size(N); ++i) f.factor[i] = chain.second[i] + next.first[i];
  factorize_block<N>(f.factor, watch);
  hang_vertex<N>(chain.coupling, false, f.factor, f.left);
  hang_vertex<N>(next.coupling, true, f.factor, f.right);
  for (int i = 0; i < N; ++i)
    for (int j = 0; j <= i; ++j) {
      Real sum = chain.first[triangle(i, j)];
#pragma GCC unroll 6
      for (int k = 0; k < N; ++k) sum -= chain.coupling[k][i] * f.left[k][j];
      chain.first[triangle(i, j)] = sum;
    }
  for (int i = 0; i < N; ++i) {
    for (int j = 0; j < N; ++j) {
      Real sum = next.coupling[i][0] * f.left[0][j];
#pragma GCC unroll 6
      for (int k = 1; k < N; ++k) sum += next.coupling[i][k] * f.left[k][j];
      chain.coupling[i][j] = -sum;
    }
    for (int j = 0; j <= i; ++j) {
      Real sum = next.second[triangle(i, j)];
#pragma GCC unroll 6
      for (int k = 0; k < N; ++k) sum -= next.coupling[i][k] * f.right[k][j];
      chain.second[triangle(i, j)] = sum;
    }
  }
}

/// Takes X^T b_v or Y^T b_v from the rows of a neighbour, theory (45).
template <int N, class Real>
KOKKOS_INLINE_FUNCTION void pass_on(const Real (*hanging)[N], const Real* b, Real* neighbour) {
#pragma GCC unroll 6
  for (int k = 0; k < N; ++k)
#pragma GCC unroll 6
    for (int c = 0; c < N; ++c) neighbour[c] -= hanging[k][c] * b[k];
}

/// Takes X x_0 or Y x_2 from x_v, theory (45).
template <int N, class Real>
KOKKOS_INLINE_FUNCTION void follow(const Real (*hanging)[N], const Real* neighbour, Real* x) {
#pragma GCC unroll 6
  for (int k = 0; k < N; ++k)
#pragma GCC unroll 6
    for (int c = 0; c < N; ++c) x[k] -= hanging[k][c] * neighbour[c];
}

}  // namespace mixbeam
