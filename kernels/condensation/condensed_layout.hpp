/// Storage of the condensed tangents of elements and of the data that recover their interiors. Rows and columns u_a,
/// theta_a, u_b, theta_b: displacement and spin of the vertex at the start and at the end; three components each in
/// space, two and one in a plane.
///
/// If all forces of an element have a potential, its tangent, theory (30), is symmetric and depends on displacements
/// only through u_b - u_a. Only the lower triangle of the matrix over (u_b - u_a, theta_a, theta_b) is then stored, row
/// by row: 45 numbers instead of 144 in space, 10 instead of 36 in a plane. For low orders memory is the limit.
#pragma once

#include "kernels/execution/execution_space.hpp"

#include <Kokkos_Core.hpp>

namespace mixbeam {

/// Unknowns of a vertex: displacement and rotation in space, or in a plane.
constexpr int kSpatialDofs = 6, kPlanarDofs = 3;

/// Position of (i, j), i >= j, in a lower triangle stored row by row.
constexpr int triangle(int i, int j) { return i * (i + 1) / 2 + j; }
constexpr int triangle_size(int n) { return n * (n + 1) / 2; }

/// Layout for `N` unknowns per vertex.
template <int N>
struct TangentLayout {
  static constexpr int kMoved = N == kSpatialDofs ? 3 : 2;  ///< components of a displacement
  static constexpr int kTurned = N - kMoved;                ///< of a spin
  static constexpr int kReduced = kMoved + 2 * kTurned;     ///< rows over (u_b - u_a, theta_a, theta_b)
  static constexpr int kFull = 4 * N * N;                   ///< 2 N x 2 N, row-major
  static constexpr int kSymmetric = triangle_size(kReduced);

  /// Row of the reduced matrix for row i of the full one, up to the sign: rows of u_a are negated.
  KOKKOS_INLINE_FUNCTION static constexpr int reduced(int i) {
    return i < N ? i : (i < N + kMoved ? i - N : i - kMoved);
  }
  /// Index of entry (i, j) of the reduced matrix.
  KOKKOS_INLINE_FUNCTION static constexpr int place(int i, int j) { return i > j ? triangle(i, j) : triangle(j, i); }
  /// Index of entry (i, j) of the full matrix; is_negative: its negative is stored there.
  KOKKOS_INLINE_FUNCTION static constexpr int place_of_full(int i, int j) { return place(reduced(i), reduced(j)); }
  KOKKOS_INLINE_FUNCTION static constexpr bool is_negative(int i, int j) { return (i < kMoved) != (j < kMoved); }
};

constexpr int kFullTangent = TangentLayout<kSpatialDofs>::kFull;
constexpr int kSymmetricTangent = TangentLayout<kSpatialDofs>::kSymmetric;
constexpr int kPlanarTangent = TangentLayout<kPlanarDofs>::kSymmetric;

/// Entry (i, j) of the full matrix.
template <int N, class Real>
KOKKOS_INLINE_FUNCTION Real symmetric_tangent_entry(const Real* numbers, int i, int j) {
  const Real& x = numbers[TangentLayout<N>::place_of_full(i, j)];
  return TangentLayout<N>::is_negative(i, j) ? -x : x;
}

/// Expands the whole matrix.
template <int N, class Real>
KOKKOS_INLINE_FUNCTION void expand_symmetric_tangent(const Real* numbers, Real* matrix) {
  for (int i = 0; i < 2 * N; ++i)
    for (int j = 0; j < 2 * N; ++j) matrix[2 * N * i + j] = symmetric_tangent_entry<N>(numbers, i, j);
}

/// The increment of every interior unknown is affine in nine numbers: the change of slope_0 and the spins of both
/// vertices in the element frame (columns 0..8); column 9 is the constant part, from the interior residual.
constexpr int kVertexColumns = 9, kResponseColumns = kVertexColumns + 1;

/// Data that the tangent of an element keeps to recover its interior: rows of kVertexColumns for w, psi_j and slope_j
/// in the element frame. Their constant parts and the right-hand sides of N and M are stored in the place and layout of
/// the increments that they become. N and M follow from these, the section and the state: storing their rows would more
/// than double the memory, which is the limit for tangents of low order.
struct ResponseLayout {
  int order = 0;
  KOKKOS_INLINE_FUNCTION constexpr int rows() const { return 3 * (2 * order - 1); }
  KOKKOS_INLINE_FUNCTION constexpr int size() const { return kVertexColumns * rows(); }
};

/// Returned instead of a number of negative eigenvalues if a pivot is zero.
constexpr int kUncertainCount = -1;

}  // namespace mixbeam
