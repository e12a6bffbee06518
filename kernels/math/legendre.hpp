/// Legendre polynomials on [-1, 1] and their integrals: the shape functions of theory (8).
#pragma once

#include <Kokkos_Core.hpp>

namespace mixbeam {

/// P_0 .. P_degree at xi.
KOKKOS_INLINE_FUNCTION void legendre(int degree, double xi, double* value) {
  value[0] = 1.0;
  if (degree > 0) value[1] = xi;
  for (int n = 1; n < degree; ++n) value[n + 1] = ((2 * n + 1) * xi * value[n] - n * value[n - 1]) / (n + 1);
}

/// dP_0/dxi .. dP_degree/dxi at xi, also at the ends: P'_{n+1} = P'_{n-1} + (2n + 1) P_n.
KOKKOS_INLINE_FUNCTION void legendre_derivatives(int degree, double xi, double* derivative) {
  double previous = 1.0, current = xi;  // P_{n-1}, P_n
  derivative[0] = 0.0;
  if (degree > 0) derivative[1] = 1.0;
  for (int n = 1; n < degree; ++n) {
    derivative[n + 1] = derivative[n - 1] + (2 * n + 1) * current;
    const double next = ((2 * n + 1) * xi * current - n * previous) / (n + 1);
    previous = current;
    current = next;
  }
}

/// Integrated Legendre functions B_j(xi) = int_{-1}^{xi} P_j = (P_{j+1} - P_{j-1}) / (2j + 1) for j = 1 .. degree
/// (value[0] is not set): the interior "bubbles", zero at both ends.
KOKKOS_INLINE_FUNCTION void integrated_legendre(int degree, double xi, double* value) {
  double before = 1.0, here = xi;  // P_{j-1}, P_j
  for (int j = 1; j <= degree; ++j) {
    const double next = ((2 * j + 1) * xi * here - j * before) / (j + 1);
    value[j] = (next - before) / (2 * j + 1);
    before = here;
    here = next;
  }
}

/// P_j at an end of the element: (+-1)^j.
KOKKOS_INLINE_FUNCTION double end_value(int end, int j) { return end == 0 && j % 2 == 1 ? -1.0 : 1.0; }

}  // namespace mixbeam
