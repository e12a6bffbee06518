/// Factorisation of a sparse matrix that also reports the signs of its pivots: by Sylvester's law of inertia a
/// symmetric matrix has as many negative eigenvalues as its L D L^T has negative pivots. Uses MUMPS, because none of
/// the solvers behind Amesos2 reports them, and LAPACK for small matrices.
#pragma once

#include "nonlinear/linear/sparse_matrix.hpp"

#include <memory>
#include <string>
#include <vector>

namespace mixbeam {

/// Factorises and solves; pivots are ordered by METIS' nested dissection of groups of rows with the same columns.
class InertiaSolver {
 public:
  enum class Kind {
    symmetric,  ///< L D L^T of the lower triangle
    general     ///< L U
  };
  struct Signs {
    int negative = 0;          ///< pivots below zero; symmetric only
    int null = 0;              ///< pivots that are zero within the precision of the matrix
    int determinant_sign = 0;  ///< -1, 0 or +1
  };

  /// Analyses the structure of the matrix; values are ignored. Throws LinearSolverError.
  InertiaSolver(Kind kind, const SparseMatrix& structure);
  /// Does so for a matrix distributed by rows. All functions are then collective, errors occur on every rank, and
  /// solve() takes one column, of which each rank has its rows.
  InertiaSolver(Kind kind, const SparseMatrix& structure, RowsOfRanks share);
  ~InertiaSolver();
  InertiaSolver(const InertiaSolver&) = delete;
  InertiaSolver& operator=(const InertiaSolver&) = delete;

  /// Factorises `matrix`: the structure given above with values. Keeps the factors if the values are those of the last
  /// call: under dead loads the tangent at the end of a load step is the first one of the next. Throws
  /// LinearSolverError.
  Signs factorize(const SparseMatrix& matrix);
  /// Frees the matrix; only solves are allowed afterwards.
  void drop_matrix();
  /// Number of factorisations, calls with unchanged values not counted.
  int factorizations() const;
  /// Cost of a factorisation in solves, approximately.
  double solves_for_factors() const;
  /// Replaces each column of `block` (column-major, one after the other) by A^-1 times it, or by A^-T.
  void solve(double* block, int columns, bool transposed = false);

 private:
  struct Factors;
  struct Dense;
  struct Mumps;
  std::unique_ptr<Factors> factors_;
};

/// Replaces columns by A^-1 or A^-T times them, A the matrix of the last factors. Refines once if the residual exceeds
/// the share `refined` of the largest sum of |terms| of a row; throws LinearSolverError if it still exceeds 1e-9 then.
/// `equations`: their name in the message.
void solve_refined(InertiaSolver& solver, const SparseMatrix& matrix, std::vector<double>& columns, int count,
                   bool transposed, double refined, const std::string& equations);

}  // namespace mixbeam
