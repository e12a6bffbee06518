/// Eigenvalues of largest magnitude of an operator, by a block Krylov space with full orthogonalisation and
/// Rayleigh-Ritz. Own code instead of Anasazi: its BlockKrylovSchur refuses problems with fewer unknowns than three
/// blocks, and structures of one element have six; here the space simply stops growing when it is the whole space.
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
  /// Self-adjoint in the inner product <x, y> = x . B y; else eigenvalues may be complex.
  bool symmetric = true;
  /// y = B x, positive definite; empty: B = 1.
  std::function<void(const double* x, double* y)> inner{};
  /// Largest residual of the pairs asked for. The inverse of a stiff tangent is known to about 1e-16 times its
  /// condition; eigenvalues of symmetric operators have the square of this.
  double tolerance = 1e-9;
  /// Asked after each block, with pairs that have no vectors yet; false ends the search with what there is. None: goes
  /// on.
  std::function<bool(const std::vector<RitzPair>& pairs)> goes_on{};
  int blocks = 0;  ///< of a space, before it is begun again, and twice as many in all; 0: as usual
  int width = 0;   ///< columns of a block, the largest multiplicity that is surely found; 0: count + 2
};

struct RitzPair {
  double value = 0.0, imaginary = 0.0;
  /// Of unit length in the inner product; of a complex pair the real part, and with its conjugate the imaginary one.
  std::vector<double> vector;
  double residual = 0.0;  ///< |A x - value x| / |value|
  /// Of the value, divided by it: the residual or, where the operator is symmetric and other values keep away, its
  /// square over their distance.
  double error = 0.0;
  bool converged = false;  ///< the residual is as small as rounding lets it be
};

/// Up to `count` pairs of largest magnitude, fewer only when there are not as many unknowns. Deterministic: the start
/// vectors are always the same. Multiple eigenvalues are found up to multiplicity `count`. Applies the operator at most
/// kMostBlocks times to such blocks; what has not converged by then comes with its residual.
constexpr int kMostBlocks = 30;
std::vector<RitzPair> largest_eigenpairs(const KrylovProblem& problem, int count);

/// Eigenvalues (the diagonal afterwards) and eigenvectors (columns of the result) of a symmetric matrix of m rows by
/// Jacobi's rotations: small eigenvalues keep their digits beside large ones.
std::vector<double> small_eigenproblem(std::vector<double>& a, int m);

double dot_product(const std::vector<double>& x, const std::vector<double>& y);
/// y += a x
void add_multiple(double a, const std::vector<double>& x, std::vector<double>& y);

}  // namespace mixbeam
