/// The fields of one element as polynomials, from a snapshot and back.
#pragma once

#include "discretization/mesh/reference_element.hpp"
#include "kernels/element/layout.hpp"

namespace mixbeam {

using Coefficients = std::array<Vec, kMaximumOrder + 1>;  ///< of P_0 .. P_k

/// Value of a polynomial where the Legendre polynomials have the values P.
Vec value_at(const Coefficients& coefficients, int degree, const double* P);

/// The fields of one element, in polynomials. What an order does not have is zero.
struct ElementPolynomials {
  Vec start{};                     ///< displacement there
  Coefficients slope{};            ///< u' = du/ds, degree k - 1
  Quat triad;                      ///< Lambda_lo
  Coefficients psi{};              ///< degree k - 1, [0] = 0
  Coefficients force{}, moment{};  ///< N of degree k - 1 or k, M of degree k
};

/// `start`, `end`: displacements there; `triad` and `interior` as in a StateSnapshot. `length`: of the element.
ElementPolynomials polynomials_of(const Member& member, double length, const double* start, const double* end,
                                  const double* triad, const double* interior);

/// The inverse, but for the displacements of the vertices. What the order of the member has no room for is cut off.
void store_polynomials(const Member& member, const ElementPolynomials& element, double* triad, double* interior);

}  // namespace mixbeam
