/// Interface of the linear solvers, and the direct ones.
#pragma once

#include "discretization/assembly/phase_timer.hpp"
#include "discretization/mesh/tpetra_types.hpp"

#include <memory>
#include <optional>
#include <stdexcept>
#include <string>

namespace mixbeam {

/// The matrix could not be factorised, or the solution does not solve the equations.
class LinearSolverError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Solves with the matrix that was factorised last.
class Solver {
 public:
  virtual ~Solver() = default;

  /// Solves A x = b and returns the backward error. If that exceeds the tolerance, tries one step of iterative
  /// refinement, then throws LinearSolverError. An iterative solver may leave the share `energy_reduction` of the
  /// error, measured in energy; its tolerance is then at least that.
  virtual double solve(const DofVector& b, DofVector& x, double energy_reduction = 0.0) = 0;

  /// Counts negative eigenvalues of the tangent without element interiors; none if the factors do not provide it.
  /// Collective.
  virtual std::optional<long> negative_eigenvalues() { return {}; }

  /// Whether it solves without factors because they would be too large.
  virtual bool iterates() const { return false; }
  /// Whether it may solve by iteration where that is faster and allowed; allow_iteration() holds until its next call.
  virtual bool tries_iteration() const { return false; }
  virtual void allow_iteration(bool /*allowed*/) {}
  /// Whether its solves with the last matrix show whether an eigenvalue is negative.
  virtual bool counts_by_solves() const { return false; }

  /// Discards everything derived from earlier matrices, so that the next one alone decides every bit.
  virtual void reset_factors() {}
  /// Adopts the factors and coarse spaces of the last matrix of `other`, which belongs to the same network; `other`
  /// must factorise before it solves again.
  virtual void adopt_factors_of(Solver& /*other*/) {}
};

/// Solves with one matrix, whose values may change.
class LinearSolver : public Solver {
 public:
  /// Factorises the present values of the matrix. Throws LinearSolverError.
  virtual void factorize() = 0;
};

/// Method chosen by the graph of the matrix: KLU2 for chains and trees, in which elimination causes little fill-in, and
/// for small networks; MUMPS for networks.
inline constexpr const char* kAutomatic = "automatic";
inline constexpr const char* kMumps = "MUMPS";
inline constexpr const char* kKlu = "KLU2";  ///< Amesos2's own

/// Makes a sparse direct solver for `matrix`, whose structure must not change. `method`: an Amesos2 name ("KLU2"),
/// kMumps or kAutomatic.
/// On several ranks MUMPS factorises large networks on all of them. Smaller ones, and all matrices for Amesos2, are
/// gathered to rank 0 and factorised there: Amesos2's own gathering passes a compressed column matrix to KLU2, which
/// silently returns wrong solutions in Trilinos 13.2 built with GCC 12.
std::unique_ptr<LinearSolver> make_direct_solver(const Teuchos::RCP<DofMatrix>& matrix, const std::string& method,
                                                 double residual_tolerance, PhaseTimes& times);

/// Imports x to the column map of a matrix, off-rank entries included; on one rank x itself. Collective.
DofVector in_columns(const DofMatrix& matrix, const DofVector& x);

/// Computes max over rows of |b - A x|_i / (|A| X + |b|)_i, X the largest displacement or rotation in x: dimensionless
/// and independent of the units of rows and columns. Collective.
double backward_error(const DofMatrix& matrix, const DofVector& x, const DofVector& b);

/// Computes |x| . |A| |x|: relative errors e of the entries change x . A x by at most e times this. Collective.
double form_of_sizes(const DofMatrix& matrix, const DofVector& x);

}  // namespace mixbeam
