/// A sparse matrix by itself, for solvers that know nothing of structures; and how ranks share one.
#pragma once

#include "nonlinear/linear/root_copy.hpp"

#include <vector>

namespace mixbeam {

/// Square matrix in compressed rows; both triangles, whether symmetric or not. The columns of a row need no order.
struct SparseMatrix {
  std::vector<int> row_start, column;
  std::vector<double> value;

  int rows() const { return static_cast<int>(row_start.size()) - 1; }
  /// y = A x
  void multiply(const double* x, double* y) const;
};

/// Ranks that hold the rows of a matrix together, each those behind the rows of the rank before it.
struct SharedRows {
  MPI_Comm communicator = MPI_COMM_SELF;
  GatherPlan rows;                 ///< of each rank
  int first = 0;                   ///< number of the first row here
  std::vector<int> column_number;  ///< (column of the rows here): its number among the rows of all ranks

  bool has_several_ranks() const { return rows.counts.size() > 1; }
};

/// The structure with the rows of all ranks on the first one, without rows on every other one. Collective.
SparseMatrix gathered_structure(const SparseMatrix& here, const SharedRows& share);
/// The same with values. Collective.
SparseMatrix gathered(const SparseMatrix& here, const SharedRows& share);

/// Largest |A_ij - A_ji| / sqrt(max(|A_ii|, 1) max(|A_jj|, 1)): entries are numbers without unit.
double asymmetry(const SparseMatrix& a);

/// (A + A^T) / 2 where the entries of A^T have a place in A, as those of structures have.
SparseMatrix symmetric_part(SparseMatrix a);

}  // namespace mixbeam
