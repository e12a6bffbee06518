/// Condition number of the linear systems, independent of units.
#pragma once

#include "discretization/assembly/tangent.hpp"

#include <string>

namespace mixbeam {

/// Estimates || |C^-1 A^-1| |A| C ||_inf, C = diag(length for displacements, 1 for rotations): the condition number
/// of the matrix with displacements in units of `length` and every row divided by its sum of magnitudes. A backward
/// error e as of backward_error() changes the solution by at most this number times e, in units of the largest
/// displacement over `length` or rotation. Dimensionless; independent of the units of length and force and of the
/// scale of constraint rows.
///
/// `method`: an Amesos2 name ("KLU2"). Factorises the matrix and its transpose (transposed solves of KLU2 return wrong
/// answers in Trilinos 13.2 built with GCC 12) and solves at most 12 times. A lower bound, nearly always within a
/// factor of 3: Hager, SIAM J. Sci. Stat. Comput. 5 (1984), with the improvements of Higham, ACM TOMS 14 (1988).
/// Infinity if a factorisation or a solve fails. Collective.
double condition_estimate(const Teuchos::RCP<const DofMatrix>& matrix, const std::string& method, double length);

/// Estimates the condition of the tangent at a state, in units of the length of the structure.
double condition_of_tangent(const Model& model, const State& state, double load_factor, const std::string& method);

}  // namespace mixbeam
