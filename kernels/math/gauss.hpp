/// Gauss-Legendre rules on [-1, 1].
#pragma once

namespace mixbeam {

/// Points (ascending) and weights of the n-point rule, exact for polynomials of degree 2n - 1; any n >= 1.
/// Newton's method on P_n from the estimates of Chebyshev's points: a few ulp; rules of up to 16 points are computed
/// once.
void gauss_rule(int n, double* points, double* weights);

}  // namespace mixbeam
