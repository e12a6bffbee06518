/// Eigenvalues of largest magnitude of an operator, by a block Krylov space with full orthogonalisation and
/// Rayleigh-Ritz. Own code instead of Anasazi, whose BlockKrylovSchur rejects problems with fewer unknowns than three
/// blocks: structures of one element have six unknowns. Here the space stops growing when it is the whole space.
#pragma once

#include <functional>
#include <vector>

namespace mixbeam {

/// Replaces each of `columns` columns (column-major) by the operator times it.
using BlockOperator = std::function<void(double* block, int columns)>;

struct RitzPair;

struct KrylovProblem {
  int unknowns = 0;
  BlockOperator apply;
  /// The operator is self-adjoint in the inner product <x, y> = x . B y; false: eigenvalues may be complex.
  bool symmetric = true;
  /// y = B x, positive definite; empty: B = 1.
  std::function<void(const double* x, double* y)> inner{};
  /// Largest residual of the requested pairs. The inverse of a stiff tangent is accurate to about 1e-16 times its
  /// condition number; eigenvalues of symmetric operators have an error of the square of this.
  double tolerance = 1e-9;
  /// Called after each block, with pairs that have no vectors yet; false ends the search with these. None: never ends
  /// it.
  std::function<bool(const std::vector<RitzPair>& pairs)> goes_on{};
  int blocks = 0;  ///< limit for a space, before it restarts, and half of the total limit; 0: defaults
  int width = 0;   ///< columns of a block, the largest multiplicity certain to be found; 0: count + 2
};

struct RitzPair {
  double value = 0.0, imaginary = 0.0;
  /// Vector of unit length in the inner product; for complex pairs the real part, and for the conjugate the imaginary.
  std::vector<double> vector;
  double residual = 0.0;  ///< |A x - value x| / |value|
  /// Relative error of the value: the residual or, if the operator is symmetric and other values are well separated,
  /// its square over their distance.
  double error = 0.0;
  bool converged = false;  ///< the residual is as small as rounding permits
};

/// Finds up to `count` pairs of largest magnitude, fewer only if there are fewer unknowns. Deterministic: the start
/// vectors are always the same. Multiple eigenvalues are found up to multiplicity `count`. Applies the operator to at
/// most kMostBlocks blocks; pairs that have not converged by then are returned with their residuals.
constexpr int kMostBlocks = 30;
std::vector<RitzPair> largest_eigenpairs(const KrylovProblem& problem, int count);

/// Computes eigenvalues (the diagonal of `a` on return) and eigenvectors (columns of the result) of a symmetric matrix
/// of m rows by Jacobi rotations: small eigenvalues keep their digits beside large ones.
std::vector<double> small_eigenproblem(std::vector<double>& a, int m);

double dot_product(const std::vector<double>& x, const std::vector<double>& y);
/// Adds y += a x.
void add_multiple(double a, const std::vector<double>& x, std::vector<double>& y);

}  // namespace mixbeam
