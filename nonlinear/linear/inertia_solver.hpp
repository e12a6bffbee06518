/// Factorisation of a sparse matrix that also tells the signs of its pivots: by Sylvester's law of inertia a symmetric
/// matrix has as many negative eigenvalues as its L D L^T has negative pivots. Done by MUMPS, because none of the
/// solvers behind Amesos2 reports them, and by LAPACK where it is small.
#pragma once

#include "nonlinear/linear/sparse_matrix.hpp"

#include <memory>
#include <string>
#include <vector>

namespace mixbeam {

/// Ordered by METIS' nested dissection on groups of rows with the same columns.
class InertiaSolver {
 public:
  enum class Kind {
    symmetric,  ///< L D L^T of the lower triangle
    general     ///< L U
  };
  struct Signs {
    int negative = 0;          ///< pivots below zero; symmetric only
    int null = 0;              ///< pivots that are zero in the precision of the matrix
    int determinant_sign = 0;  ///< -1, 0 or +1
  };

  /// Analyses the structure of the matrix, whose values do not matter yet. Throws LinearSolverError.
  InertiaSolver(Kind kind, const SparseMatrix& structure);
  /// Takes the rows that each rank holds. All functions are then collective, errors occur on every rank, and vectors
  /// have one column, each rank its rows.
  InertiaSolver(Kind kind, const SparseMatrix& structure, RowsOfRanks share);
  ~InertiaSolver();
  InertiaSolver(const InertiaSolver&) = delete;
  InertiaSolver& operator=(const InertiaSolver&) = delete;

  /// Throws LinearSolverError when the solver gives up. `matrix`: the structure given above with values. Those
  /// factorised last keep their factors: under dead loads the tangent at the end of a load step is the first one of the
  /// next.
  Signs factorize(const SparseMatrix& matrix);
  /// Frees the matrix; only solves are allowed afterwards.
  void drop_matrix();
  /// How often values were not those factorised last.
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

/// Replaces columns by A^-1 or A^-T times them, A the matrix of the last factors, refined once where rounding leaves
/// more than the share `refined` of the sum of the terms of a row. Throws LinearSolverError, for equations of that
/// name, where it leaves no nine digits.
void solve_refined(InertiaSolver& solver, const SparseMatrix& matrix, std::vector<double>& columns, int count,
                   bool transposed, double refined, const std::string& equations);

}  // namespace mixbeam
