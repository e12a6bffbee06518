/// How near to zero an eigenvalue of a tangent may be, by inverse iteration: signs of pivots next to one are those of
/// rounding.
#pragma once

#include "discretization/assembly/tangent.hpp"
#include "nonlinear/linear/inertia_solver.hpp"

#include <cmath>
#include <functional>
#include <vector>

namespace mixbeam {

struct NearestEigenvalue {
  double size = HUGE_VAL;  ///< not below that of the eigenvalue nearest to zero
  double rounding = 0.0;   ///< in it, of the entries of the matrix; where it is known
};

/// Of a matrix that is factorised.
NearestEigenvalue nearest_eigenvalue(const SparseMatrix& a, InertiaSolver& solver);

/// K dx = b: forces and moments on all vertices.
using SolveVertices = std::function<void(const DofVector& b, DofVector& x)>;

/// Of a whole tangent, chains and what they leave: a mode may live in the chains alone. An eigenvalue of what chains
/// leave is no nearer to zero. `rounding_of_form`: see TangentSolver. In units of EI/L; collective.
NearestEigenvalue nearest_eigenvalue(const Tangent& tangent, const SolveVertices& solve,
                                     const std::function<double(const DofVector&)>& rounding_of_form = {});

/// What the rounding of the entries of A may change in y . A y, for y of unit length.
double rounding_level(const SparseMatrix& a, const std::vector<double>& y);

}  // namespace mixbeam
