/// A sparse matrix by itself, for solvers that know nothing of structures; how ranks share one, and its copy on rank 0.
#pragma once

#include "discretization/mesh/tpetra_types.hpp"

#include <mpi.h>

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

/// How many entries each rank contributes, and where they go on rank 0.
struct GatherPlan {
  std::vector<int> counts, offsets;
  int total() const { return counts.empty() ? 0 : counts.back() + offsets.back(); }

  GatherPlan() = default;
  GatherPlan(MPI_Comm comm, int mine);
};

MPI_Comm communicator_of(const DofMatrix& matrix);

/// Ranks that hold the rows of a matrix together, each those behind the rows of the rank before it.
struct RowsOfRanks {
  MPI_Comm communicator = MPI_COMM_SELF;
  GatherPlan rows;                 ///< of each rank
  int first = 0;                   ///< number of the first row here
  std::vector<int> column_number;  ///< (column of the rows here): its number among the rows of all ranks

  bool has_several_ranks() const { return rows.counts.size() > 1; }
};

/// The structure with the rows of all ranks on the first one, without rows on every other one. Collective.
SparseMatrix gathered_structure(const SparseMatrix& here, const RowsOfRanks& share);
/// Gathers the structure with its values. Collective.
SparseMatrix gathered(const SparseMatrix& here, const RowsOfRanks& share);

/// Largest |A_ij - A_ji| / sqrt(max(|A_ii|, 1) max(|A_jj|, 1)): entries are numbers without unit.
double asymmetry(const SparseMatrix& a);

/// (A + A^T) / 2 where the entries of A^T have a place in A, as those of structures have.
SparseMatrix symmetric_part(SparseMatrix a);

/// Copy of a distributed matrix on rank 0 alone, and the exchange of its values and vectors. Rows must be contiguous by
/// rank. All functions are collective. A process alone takes the matrix itself and needs no MPI.
class RootCopy {
 public:
  explicit RootCopy(const Teuchos::RCP<DofMatrix>& matrix);

  bool is_root() const { return is_root_; }
  const Teuchos::RCP<DofMatrix>& matrix() const { return root_; }  ///< null on every other rank
  bool is_alone() const { return mpi_ == MPI_COMM_NULL; }
  MPI_Comm communicator() const { return mpi_; }

  /// Numbers of rank 0 on every rank.
  void share(void* numbers, int count, MPI_Datatype type) const;
  void gather_values() const;
  void gather(const DofVector& from, double* to) const;
  void scatter(const double* from, DofVector& to) const;

 private:
  Teuchos::RCP<DofMatrix> distributed_, root_;
  MPI_Comm mpi_ = MPI_COMM_NULL;
  bool is_root_ = false;
  GatherPlan rows_, entries_;
};

}  // namespace mixbeam
