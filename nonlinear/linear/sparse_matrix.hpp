/// A plain sparse matrix for solvers that do not depend on Tpetra, its distribution over ranks, and its copy on rank 0.
#pragma once

#include "discretization/mesh/tpetra_types.hpp"

#include <mpi.h>

#include <vector>

namespace mixbeam {

/// Square matrix in compressed row storage, both triangles also if symmetric. The columns of a row need no order.
struct SparseMatrix {
  std::vector<int> row_start, column;
  std::vector<double> value;

  int rows() const { return static_cast<int>(row_start.size()) - 1; }
  /// y = A x
  void multiply(const double* x, double* y) const;
};

/// Number of entries that each rank contributes, and their offsets on rank 0.
struct GatherPlan {
  std::vector<int> counts, offsets;
  int total() const { return counts.empty() ? 0 : counts.back() + offsets.back(); }

  GatherPlan() = default;
  GatherPlan(MPI_Comm comm, int mine);
};

MPI_Comm communicator_of(const DofMatrix& matrix);

/// Distribution of the rows of a matrix over ranks, in the order of ranks.
struct RowsOfRanks {
  MPI_Comm communicator = MPI_COMM_SELF;
  GatherPlan rows;                 ///< of each rank
  int first = 0;                   ///< number of the first row here
  std::vector<int> column_number;  ///< (column of the rows here): its number among the rows of all ranks

  bool has_several_ranks() const { return rows.counts.size() > 1; }
};

/// Gathers the structure on rank 0; other ranks get a matrix without rows. Collective.
SparseMatrix gathered_structure(const SparseMatrix& here, const RowsOfRanks& share);
/// Gathers the structure with its values. Collective.
SparseMatrix gathered(const SparseMatrix& here, const RowsOfRanks& share);

/// Largest |A_ij - A_ji| / sqrt(max(|A_ii|, 1) max(|A_jj|, 1)) of a dimensionless matrix.
double asymmetry(const SparseMatrix& a);

/// Computes (A + A^T) / 2 for a matrix with a symmetric pattern; entries without a mirror stay as they are.
SparseMatrix symmetric_part(SparseMatrix a);

/// Copy of a distributed matrix on rank 0, with the exchange of values and vectors. Rows must be contiguous by rank.
/// All functions are collective. On a single process it is the matrix itself and needs no MPI.
class RootCopy {
 public:
  explicit RootCopy(const Teuchos::RCP<DofMatrix>& matrix);

  bool is_root() const { return is_root_; }
  const Teuchos::RCP<DofMatrix>& matrix() const { return root_; }  ///< null on every other rank
  bool is_alone() const { return mpi_ == MPI_COMM_NULL; }
  MPI_Comm communicator() const { return mpi_; }

  /// Broadcasts numbers from rank 0.
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
