/// Elimination of one vertex from a chain, theory (45): the arithmetic of chains/level.hpp on `Real` numbers (lanes of
/// a Pack hold different chains). N unknowns per vertex: 6 in space, 3 in a plane.
///
/// A link is a matrix over two vertices, [[K00, K01], [K10, K11]], symmetric or not. The pivot block V holds a vertex
/// between its neighbours: it is as stiff as one link, however long the chain is.
#pragma once

#include "kernels/condensation/condensed_layout.hpp"
#include "kernels/execution/pack.hpp"

namespace mixbeam {

/// Symmetric matrix over both ends of a link: K00 and K11 as lower triangles, K10 with rows at the second vertex.
template <int N, class Real>
struct LinkMatrix {
  Real first[triangle_size(N)], coupling[N][N], second[triangle_size(N)];
};

/// Independent entries of such a link if it depends on displacements only through their difference: K00 of the spins,
/// and of K10 the columns of the spins; the columns of displacements are the negative of those of K11.
template <int N, class Real>
struct FreeLinkMatrix {
  static constexpr int kMoved = TangentLayout<N>::kMoved, kTurned = TangentLayout<N>::kTurned;
  Real first[triangle_size(kTurned)], coupling[N][kTurned], second[triangle_size(N)];

  KOKKOS_FORCEINLINE_FUNCTION const Real& at_second(int i, int j) const {
    return second[i > j ? triangle(i, j) : triangle(j, i)];
  }
  /// K10 x, x at the first end.
  KOKKOS_FORCEINLINE_FUNCTION void forces_at_second(const Real* x, Real* force) const {
#pragma GCC unroll 6
    for (int i = 0; i < N; ++i) {
      force[i] = coupling[i][0] * x[kMoved];
#pragma GCC unroll 6
      for (int c = 1; c < kTurned; ++c) force[i] += coupling[i][c] * x[kMoved + c];
#pragma GCC unroll 6
      for (int c = 0; c < kMoved; ++c) force[i] -= at_second(i, c) * x[c];
    }
  }
  /// K01 x, x at the second end.
  KOKKOS_FORCEINLINE_FUNCTION void forces_at_first(const Real* x, Real* force) const {
#pragma GCC unroll 6
    for (int c = 0; c < N; ++c) {
      force[c] = 0.0;
#pragma GCC unroll 6
      for (int i = 0; i < N; ++i) force[c] += (c < kMoved ? -at_second(i, c) : coupling[i][c - kMoved]) * x[i];
    }
  }
};

/// Unsymmetric link; `back` has rows at the first vertex.
template <int N, class Real>
struct GeneralLinkMatrix {
  Real first[N][N], coupling[N][N], back[N][N], second[N][N];
};

/// L D L^T of one vertex block V, D inverted, and its coupling to the two neighbours.
template <int N, class Real>
struct VertexFactors {
  static constexpr int kSize = triangle_size(N) + 2 * N * N;
  Real factor[triangle_size(N)];  ///< strict lower triangle: L; diagonal: 1/D
  Real left[N][N], right[N][N];   ///< X, Y
};

/// Factors between links that depend on displacement differences. The rest follows from V and the link behind the
/// vertex, which is kept anyway: a rigid displacement of the chain does no work, so the columns of displacements in
/// K_v0 are those of that link in V, minus V.
template <int N, class Real>
struct FreeVertexFactors {
  static constexpr int kTurned = TangentLayout<N>::kTurned;
  static constexpr int kSize = triangle_size(N) + N * kTurned;
  Real factor[triangle_size(N)];
  Real by_first[N][kTurned];  ///< K_v0 of the spins at the start of the chain
};

/// L U of an unsymmetric V, its coupling to the neighbours, and the rows of the neighbours that couple to it.
template <int N, class Real>
struct GeneralVertexFactors {
  static constexpr int kSize = 5 * N * N;
  Real factor[N][N];               ///< below the diagonal: L; diagonal: 1/U
  Real left[N][N], right[N][N];    ///< X = V^-1 K10, Y = V^-1 K01
  Real first[N][N], second[N][N];  ///< K01 of the link before, K10 of the link behind
};

/// Signs, theory (47), and sizes of the pivots encountered.
template <class Real>
struct PivotWatch {
  Real negative = 0.0;  ///< number of negative ones
  Real smallest = 1.0;  ///< least |pivot| / |diagonal entry before the elimination| of the vertex block
};

/// `diagonal`: entry of the block at the same place before the elimination.
template <class Real>
KOKKOS_INLINE_FUNCTION void watch_pivot(const Real& pivot, const Real& diagonal, PivotWatch<Real>& watch) {
  using std::fabs;
  const Real ratio = fabs(pivot / diagonal);
  watch.smallest = select(ratio >= watch.smallest, watch.smallest, ratio);  // also takes a NaN ratio
  watch.negative += select(pivot < Real(0.0), Real(1.0), Real(0.0));
}

/// L D L^T of a symmetric block in place, without pivoting.
template <int N, class Real>
KOKKOS_INLINE_FUNCTION void factorize_block(Real* a, PivotWatch<Real>& watch) {
  Real diagonal[N];
  for (int i = 0; i < N; ++i) diagonal[i] = a[triangle(i, i)];
#pragma GCC unroll 6
  for (int k = 0; k < N; ++k) {
    const Real pivot = a[triangle(k, k)];
    watch_pivot(pivot, diagonal[k], watch);
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

/// L U of a block in place, without pivoting.
template <int N, class Real>
KOKKOS_INLINE_FUNCTION void factorize_block(Real (*a)[N], PivotWatch<Real>& watch) {
  Real diagonal[N];
  for (int i = 0; i < N; ++i) diagonal[i] = a[i][i];
#pragma GCC unroll 6
  for (int k = 0; k < N; ++k) {
    watch_pivot(a[k][k], diagonal[k], watch);
    a[k][k] = Real(1.0) / a[k][k];
#pragma GCC unroll 6
    for (int i = k + 1; i < N; ++i) {
      a[i][k] = a[i][k] * a[k][k];
#pragma GCC unroll 6
      for (int j = k + 1; j < N; ++j) a[i][j] -= a[i][k] * a[k][j];
    }
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

template <int N, class Real>
KOKKOS_INLINE_FUNCTION void solve_block(const Real (*factor)[N], Real* b) {
#pragma GCC unroll 6
  for (int i = 1; i < N; ++i)
#pragma GCC unroll 6
    for (int j = 0; j < i; ++j) b[i] -= factor[i][j] * b[j];
#pragma GCC unroll 6
  for (int i = N - 1; i >= 0; --i) {
#pragma GCC unroll 6
    for (int j = i + 1; j < N; ++j) b[i] -= factor[i][j] * b[j];
    b[i] = b[i] * factor[i][i];
  }
}

/// V^-1 times the given rows, or their transpose: X and Y, whose column c belongs to component c of the neighbour.
template <int N, class Real, class Factor>
KOKKOS_INLINE_FUNCTION void hang_vertex(const Real (*rows)[N], bool rows_are_columns, const Factor& factor,
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

/// Eliminates the vertex between `chain` and `next`, theory (45); `chain` becomes the union of both.
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

template <int N, class Real>
KOKKOS_INLINE_FUNCTION void eliminate_vertex(FreeLinkMatrix<N, Real>& chain, const FreeLinkMatrix<N, Real>& next,
                                             FreeVertexFactors<N, Real>& f, PivotWatch<Real>& watch) {
  constexpr int moved = FreeLinkMatrix<N, Real>::kMoved, turned = FreeLinkMatrix<N, Real>::kTurned;
  Real by_next[N][N];  // K10 of the next link
  for (int i = 0; i < N; ++i)
    for (int j = 0; j < N; ++j) by_next[i][j] = j < moved ? -next.at_second(i, j) : next.coupling[i][j - moved];
  for (int i = 0; i < N; ++i)
    for (int j = 0; j <= i; ++j) {
      const Real first = i < moved   ? next.second[triangle(i, j)]
                         : j < moved ? -next.coupling[j][i - moved]
                                     : next.first[triangle(i - moved, j - moved)];
      f.factor[triangle(i, j)] = chain.second[triangle(i, j)] + first;
    }
  factorize_block<N>(f.factor, watch);
  Real hanging[N + turned][N];  // columns of X, and those of Y for spins
  for (int c = 0; c < N + turned; ++c) {
    Real* const column = hanging[c];
#pragma GCC unroll 6
    for (int i = 0; i < N; ++i)
      column[i] = c < moved ? -chain.at_second(i, c) : c < N ? chain.coupling[i][c - moved] : by_next[moved + c - N][i];
    solve_block<N>(f.factor, column);
  }
  for (int i = 0; i < N; ++i)
    for (int c = 0; c < turned; ++c) f.by_first[i][c] = chain.coupling[i][c];
  const auto less_product = [](Real sum, const auto& a, const auto& b) {
#pragma GCC unroll 6
    for (int k = 0; k < N; ++k) sum -= a(k) * b(k);
    return sum;
  };
  const auto row = [&](int i) { return [&, i](int k) { return by_next[i][k]; }; };
  const auto from_first = [&](int j) { return [&, j](int k) { return hanging[j][k]; }; };
  const auto from_second = [&](int j) { return [&, j](int k) { return hanging[N + j - moved][k]; }; };
  for (int i = 0; i < turned; ++i)
    for (int j = 0; j <= i; ++j)
      chain.first[triangle(i, j)] = less_product(
          chain.first[triangle(i, j)], [&](int k) { return chain.coupling[k][i]; }, from_first(moved + j));
  for (int i = 0; i < N; ++i)
    for (int j = 0; j < turned; ++j) chain.coupling[i][j] = less_product(0.0, row(i), from_first(moved + j));
  for (int i = 0; i < N; ++i)
    for (int j = 0; j <= i; ++j) {
      Real& out = chain.second[triangle(i, j)];
      if (i < moved)  // negated columns of K10
        out = -less_product(0.0, row(i), from_first(j));
      else if (j < moved)
        out = less_product(next.second[triangle(i, j)], row(j), from_second(i));
      else
        out = less_product(next.second[triangle(i, j)], row(i), from_second(j));
    }
}

/// out - a b
template <int N, class Real>
KOKKOS_INLINE_FUNCTION void subtract_product(const Real (*a)[N], const Real (*b)[N], Real (*out)[N]) {
  for (int i = 0; i < N; ++i)
    for (int j = 0; j < N; ++j) {
      Real sum = out[i][j];
#pragma GCC unroll 6
      for (int k = 0; k < N; ++k) sum -= a[i][k] * b[k][j];
      out[i][j] = sum;
    }
}

template <int N, class Real>
KOKKOS_INLINE_FUNCTION void eliminate_vertex(GeneralLinkMatrix<N, Real>& chain, const GeneralLinkMatrix<N, Real>& next,
                                             GeneralVertexFactors<N, Real>& f, PivotWatch<Real>& watch) {
  for (int i = 0; i < N; ++i)
    for (int j = 0; j < N; ++j) {
      f.factor[i][j] = chain.second[i][j] + next.first[i][j];
      f.first[i][j] = chain.back[i][j];
      f.second[i][j] = next.coupling[i][j];
      chain.second[i][j] = next.second[i][j];
      chain.back[i][j] = 0.0;
    }
  factorize_block<N>(f.factor, watch);
  hang_vertex<N>(chain.coupling, false, f.factor, f.left);
  hang_vertex<N>(next.back, false, f.factor, f.right);
  for (int i = 0; i < N; ++i)
    for (int j = 0; j < N; ++j) chain.coupling[i][j] = 0.0;
  subtract_product<N>(f.first, f.left, chain.first);
  subtract_product<N>(f.first, f.right, chain.back);
  subtract_product<N>(f.second, f.left, chain.coupling);
  subtract_product<N>(f.second, f.right, chain.second);
}

/// Subtracts X^T b_v or Y^T b_v from the rows of a neighbour, theory (45).
template <int N, class Real, int M>
KOKKOS_INLINE_FUNCTION void pass_on(const Real (*hanging)[M], const Real* b, Real* neighbour) {
#pragma GCC unroll 6
  for (int k = 0; k < N; ++k)
#pragma GCC unroll 6
    for (int c = 0; c < M; ++c) neighbour[c] -= hanging[k][c] * b[k];
}

/// Subtracts X x_0 or Y x_2 from x_v, theory (45).
template <int N, class Real, int M>
KOKKOS_INLINE_FUNCTION void follow(const Real (*hanging)[M], const Real* neighbour, Real* x) {
#pragma GCC unroll 6
  for (int k = 0; k < N; ++k)
#pragma GCC unroll 6
    for (int c = 0; c < M; ++c) x[k] -= hanging[k][c] * neighbour[c];
}

/// Completes x_v from V^-1 b_v, theory (45).
template <class Factors, class Real>
KOKKOS_INLINE_FUNCTION void follow_neighbours(const Factors& f, const Real* first, const Real* second, Real* x) {
  constexpr int n = sizeof(f.left) / sizeof(f.left[0]);
  follow<n>(f.left, first, x);
  follow<n>(f.right, second, x);
}
/// `next`: the link behind the vertex.
template <int N, class Real>
KOKKOS_INLINE_FUNCTION void follow_neighbours(const FreeVertexFactors<N, Real>& f, const FreeLinkMatrix<N, Real>& next,
                                              const Real* first, const Real* second, Real* x) {
  constexpr int moved = TangentLayout<N>::kMoved;
  Real seen_from_first[N], force[N];
  for (int c = 0; c < N; ++c) seen_from_first[c] = c < moved ? second[c] - first[c] : second[c];
  next.forces_at_first(seen_from_first, force);
#pragma GCC unroll 6
  for (int i = 0; i < N; ++i)
    for (int c = 0; c < f.kTurned; ++c) force[i] += f.by_first[i][c] * first[moved + c];
  solve_block<N>(f.factor, force);
  for (int c = 0; c < N; ++c) x[c] = c < moved ? x[c] + first[c] - force[c] : x[c] - force[c];
}

/// Eliminates the rows `b` of a vertex from those of its neighbours; `b` becomes V^-1 b.
template <int N, class Real>
KOKKOS_INLINE_FUNCTION void eliminate_rows(const VertexFactors<N, Real>& f, Real* b, Real* first, Real* second) {
  pass_on<N>(f.left, b, first);
  pass_on<N>(f.right, b, second);
  solve_block<N>(f.factor, b);
}
template <int N, class Real>
KOKKOS_INLINE_FUNCTION void eliminate_rows(const FreeVertexFactors<N, Real>& f, const FreeLinkMatrix<N, Real>& next,
                                           Real* b, Real* first, Real* second) {
  constexpr int moved = TangentLayout<N>::kMoved;
  for (int c = 0; c < moved; ++c) first[c] += b[c];  // remainder after the share of the second end
  solve_block<N>(f.factor, b);
  Real force[N];
  next.forces_at_second(b, force);
  for (int c = 0; c < moved; ++c) first[c] += force[c];
#pragma GCC unroll 6
  for (int i = 0; i < N; ++i)
    for (int c = 0; c < f.kTurned; ++c) first[moved + c] -= f.by_first[i][c] * b[i];
  for (int c = 0; c < N; ++c) second[c] -= force[c];
}
template <int N, class Real>
KOKKOS_INLINE_FUNCTION void eliminate_rows(const GeneralVertexFactors<N, Real>& f, Real* b, Real* first, Real* second) {
  solve_block<N>(f.factor, b);
  follow<N>(f.first, b, first);
  follow<N>(f.second, b, second);
}

}  // namespace mixbeam
