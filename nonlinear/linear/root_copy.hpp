/// A distributed matrix and its vectors on rank 0 alone, for solvers that work on one rank.
#pragma once

#include "discretization/mesh/tpetra_types.hpp"

#include <mpi.h>

#include <vector>

namespace mixbeam {

/// How many entries each rank contributes, and where they go on rank 0.
struct GatherPlan {
  std::vector<int> counts, offsets;
  int total() const { return counts.empty() ? 0 : counts.back() + offsets.back(); }

  GatherPlan() = default;
  GatherPlan(MPI_Comm comm, int mine);
};

MPI_Comm communicator_of(const DofMatrix& matrix);

/// Copy of a distributed matrix on rank 0 alone, and the exchange of its values and vectors. Rows must be contiguous by
/// rank. All functions are collective.
class RootCopy {
 public:
  explicit RootCopy(const Teuchos::RCP<DofMatrix>& matrix);

  bool is_root() const { return is_root_; }
  const Teuchos::RCP<DofMatrix>& matrix() const { return root_; }  ///< null on every other rank
  MPI_Comm communicator() const { return mpi_; }

  void gather_values() const;
  void gather(const DofVector& from, double* to) const;
  void scatter(const double* from, DofVector& to) const;

 private:
  void copy_structure();

  Teuchos::RCP<DofMatrix> distributed_, root_;
  MPI_Comm mpi_ = MPI_COMM_NULL;
  bool is_root_ = false;
  GatherPlan rows_, entries_;
};

}  // namespace mixbeam
