#include "nonlinear/linear/root_copy.hpp"

#include <Teuchos_DefaultMpiComm.hpp>

#include <numeric>

namespace mixbeam {

GatherPlan::GatherPlan(MPI_Comm comm, int mine) {
  int ranks = 0;
  MPI_Comm_size(comm, &ranks);
  counts.resize(ranks);
  offsets.assign(ranks, 0);
  MPI_Allgather(&mine, 1, MPI_INT, counts.data(), 1, MPI_INT, comm);
  std::partial_sum(counts.begin(), counts.end() - 1, offsets.begin() + 1);
}

MPI_Comm communicator_of(const DofMatrix& matrix) {
  const auto comm = matrix.getRowMap()->getComm();
  return *Teuchos::rcp_dynamic_cast<const Teuchos::MpiComm<int>>(comm, true)->getRawMpiComm();
}

RootCopy::RootCopy(const Teuchos::RCP<DofMatrix>& matrix) : distributed_(matrix) {
  mpi_ = communicator_of(*matrix);
  is_root_ = matrix->getRowMap()->getComm()->getRank() == 0;
  copy_structure();
}

void RootCopy::gather_values() const {
  const auto mine = distributed_->getLocalMatrixHost().values;
  double* all = is_root_ ? root_->getLocalMatrixHost().values.data() : nullptr;
  MPI_Gatherv(mine.data(), static_cast<int>(mine.extent(0)), MPI_DOUBLE, all, entries_.counts.data(),
              entries_.offsets.data(), MPI_DOUBLE, 0, mpi_);
}

void RootCopy::gather(const DofVector& from, double* to) const {
  const auto mine = from.getLocalViewHost(Tpetra::Access::ReadOnly);
  MPI_Gatherv(mine.data(), static_cast<int>(mine.extent(0)), MPI_DOUBLE, to, rows_.counts.data(), rows_.offsets.data(),
              MPI_DOUBLE, 0, mpi_);
}

void RootCopy::scatter(const double* from, DofVector& to) const {
  const auto mine = to.getLocalViewHost(Tpetra::Access::OverwriteAll);
  MPI_Scatterv(from, rows_.counts.data(), rows_.offsets.data(), MPI_DOUBLE, mine.data(),
               static_cast<int>(mine.extent(0)), MPI_DOUBLE, 0, mpi_);
}

void RootCopy::copy_structure() {
  const auto graph = distributed_->getCrsGraph()->getLocalGraphHost();
  const auto columns = distributed_->getColMap();
  const int rows = static_cast<int>(graph.numRows()), entries = static_cast<int>(graph.entries.extent(0));
  rows_ = GatherPlan(mpi_, rows);
  entries_ = GatherPlan(mpi_, entries);
  std::vector<int> lengths(rows), column(entries);
  for (int i = 0; i < rows; ++i) lengths[i] = static_cast<int>(graph.row_map(i + 1) - graph.row_map(i));
  for (int k = 0; k < entries; ++k) column[k] = static_cast<int>(columns->getGlobalElement(graph.entries(k)));
  const int n = is_root_ ? rows_.total() : 0;
  using Graph = DofMatrix::local_graph_host_type;
  Graph::row_map_type::non_const_type start("mixbeam::root_row_start", n + 1);
  Graph::entries_type::non_const_type all_columns("mixbeam::root_column", is_root_ ? entries_.total() : 0);
  std::vector<int> all_lengths(n);
  MPI_Gatherv(lengths.data(), rows, MPI_INT, all_lengths.data(), rows_.counts.data(), rows_.offsets.data(), MPI_INT, 0,
              mpi_);
  MPI_Gatherv(column.data(), entries, MPI_INT, all_columns.data(), entries_.counts.data(), entries_.offsets.data(),
              MPI_INT, 0, mpi_);
  if (!is_root_) return;
  for (int i = 0; i < n; ++i) start(i + 1) = start(i) + all_lengths[i];
  const Communicator self = Teuchos::rcp(new Teuchos::MpiComm<int>(MPI_COMM_SELF));
  const auto map = Teuchos::rcp(new DofMap(n, 0, self));
  DofMatrix::local_matrix_host_type::values_type::non_const_type values("mixbeam::root_values", all_columns.extent(0));
  root_ = Teuchos::rcp(new DofMatrix(map, map, start, all_columns, values));
  root_->expertStaticFillComplete(map, map);
}

}  // namespace mixbeam
