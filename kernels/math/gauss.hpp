/// Gauss-Legendre rules on [-1, 1].
#pragma once

namespace mixbeam {

/// Points (ascending) and weights of the n-point rule, n >= 1, exact for polynomials of degree 2n - 1. Newton's method
/// on P_n from Chebyshev-like estimates, to a few ulp; rules of up to 16 points are computed once.
void gauss_rule(int n, double* points, double* weights);

}  // namespace mixbeam
