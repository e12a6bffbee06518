/// How the condensed tangents of elements are kept, spatial. Rows and columns u_a, theta_a, u_b, theta_b: displacement
/// and spin of the vertex at the start and at the end.
///
/// The tangent of an element whose forces all have a potential is symmetric and sees displacements as u_b - u_a alone.
/// Then it is the lower triangle, row by row, of the 9 x 9 matrix over (u_b - u_a, theta_a, theta_b): 45 numbers in
/// place of 144, and memory is what limits elements of low order.
#pragma once

#include "kernels/execution_space.hpp"

#include <Kokkos_Core.hpp>

namespace mixbeam {

constexpr int kFullTangent = 144;      ///< 12 x 12, row-major
constexpr int kSymmetricTangent = 45;  ///< lower triangle of 9 x 9

/// Position of (i, j), i >= j, in a lower triangle stored row by row.
constexpr int triangle(int i, int j) { return i * (i + 1) / 2 + j; }
constexpr int triangle_size(int n) { return n * (n + 1) / 2; }

/// Row of the 9 x 9 matrix that row i of the 12 x 12 matrix is, but for the sign: rows of u_a are the negative.
KOKKOS_INLINE_FUNCTION constexpr int row_among_nine(int i) { return i < 6 ? i : (i < 9 ? i - 6 : i - 3); }

/// Entry (i, j) of the 12 x 12 matrix.
KOKKOS_INLINE_FUNCTION double symmetric_tangent_entry(const double* numbers, int i, int j) {
  const int a = row_among_nine(i), b = row_among_nine(j);
  const double x = numbers[a > b ? triangle(a, b) : triangle(b, a)];
  return (i < 3) != (j < 3) ? -x : x;
}

/// All of the 12 x 12 matrix.
KOKKOS_INLINE_FUNCTION void expand_symmetric_tangent(const double* numbers, double* matrix) {
  for (int i = 0; i < 12; ++i)
    for (int j = 0; j < 12; ++j) matrix[12 * i + j] = symmetric_tangent_entry(numbers, i, j);
}

}  // namespace mixbeam
