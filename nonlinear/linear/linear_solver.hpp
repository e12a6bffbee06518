/// Linear solvers behind one small interface.
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

  /// Solves A x = b and checks the result: its backward error must not exceed the tolerance, else one step of iterative
  /// refinement is tried, then LinearSolverError is thrown. Returns that error. An iteration may leave the share
  /// `energy_reduction` of the error, in energy, and its tolerance is no smaller.
  virtual double solve(const DofVector& b, DofVector& x, double energy_reduction = 0.0) = 0;

  /// Counts eigenvalues below zero, of a tangent without element interiors; none where the factors do not tell.
  /// Collective.
  virtual std::optional<long> negative_eigenvalues() { return {}; }

  /// Whether it solves without factors because they would be too large.
  virtual bool iterates() const { return false; }
  /// Whether it may solve without factors, where stable states are asked for that; `allowed` until the next call.
  virtual bool tries_iteration() const { return false; }
  virtual void allow_iteration(bool /*allowed*/) {}
  /// Whether its solves with the last matrix tell whether an eigenvalue is below zero.
  virtual bool counts_by_solves() const { return false; }

  /// Discards everything derived from earlier matrices, so that the next one alone decides every bit.
  virtual void reset_factors() {}
  /// Adopts the factors and spaces that `other` has kept of its last matrix over the same network; `other` must
  /// factorise before it solves again.
  virtual void adopt_factors_of(Solver& /*other*/) {}
};

/// Solves with one matrix, whose values change.
class LinearSolver : public Solver {
 public:
  /// Factorises the present values of the matrix. Throws LinearSolverError.
  virtual void factorize() = 0;
};

/// Method that suits the graph of the matrix: KLU2 for chains and trees, in which elimination fills in little, and for
/// small networks; MUMPS for networks.
inline constexpr const char* kAutomatic = "automatic";
inline constexpr const char* kMumps = "MUMPS";
inline constexpr const char* kKlu = "KLU2";  ///< Amesos2's own

/// A sparse direct solver for `matrix`, whose structure must not change. `method`: an Amesos2 name ("KLU2"), kMumps or
/// kAutomatic.
/// On several ranks MUMPS factorises large networks on all of them. Smaller ones are gathered to rank 0 and
/// factorised there, and so are matrices for Amesos2: its own gathering hands KLU2 a compressed column matrix, and that
/// path returns wrong solutions without a message in Trilinos 13.2 built with GCC 12.
std::unique_ptr<LinearSolver> make_direct_solver(const Teuchos::RCP<DofMatrix>& matrix, const std::string& method,
                                                 double residual_tolerance, PhaseTimes& times);

/// x and what others own of the columns of a matrix; on one rank x itself, with the same numbers. Collective.
DofVector in_columns(const DofMatrix& matrix, const DofVector& x);

/// max over rows of |b - A x|_i / (|A| X + |b|)_i, X the largest displacement or rotation in x: dimensionless, and
/// blind to the units of rows and columns. Collective.
double backward_error(const DofMatrix& matrix, const DofVector& x, const DofVector& b);

/// |x| . |A| |x|: what entries that are wrong by a share of themselves change in x . A x is at most that share of it.
/// Collective.
double form_of_sizes(const DofMatrix& matrix, const DofVector& x);

}  // namespace mixbeam
