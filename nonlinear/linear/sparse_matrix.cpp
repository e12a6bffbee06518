#include "nonlinear/linear/sparse_matrix.hpp"

#include "discretization/mesh/mpi_at_need.hpp"

#include <Teuchos_DefaultMpiComm.hpp>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace mixbeam {

GatherPlan::GatherPlan(MPI_Comm comm, int mine) : counts{mine}, offsets{0} {
  if (comm == MPI_COMM_SELF) return;
  int ranks = 0;
  MPI_Comm_size(comm, &ranks);
  counts.resize(ranks);
  offsets.assign(ranks, 0);
  MPI_Allgather(&mine, 1, MPI_INT, counts.data(), 1, MPI_INT, comm);
  std::partial_sum(counts.begin(), counts.end() - 1, offsets.begin() + 1);
}

MPI_Comm communicator_of(const DofMatrix& matrix) { return mpi_of(*matrix.getRowMap()->getComm()); }

void SparseMatrix::multiply(const double* x, double* y) const {
  for (int i = 0; i < rows(); ++i) {
    double sum = 0.0;
    for (int k = row_start[i]; k < row_start[i + 1]; ++k) sum += value[k] * x[column[k]];
    y[i] = sum;
  }
}

double asymmetry(const SparseMatrix& a) {
  const int n = a.rows();
  std::vector<int> next(n + 1, 0);  // entries of each column, its rows ascending
  for (int j : a.column) ++next[j + 1];
  std::partial_sum(next.begin(), next.end(), next.begin());
  std::vector<std::pair<int, double>> transposed(a.column.size());
  std::vector<double> diagonal(n, 1.0), row(n, 0.0);
  for (int i = 0; i < n; ++i)
    for (int k = a.row_start[i]; k < a.row_start[i + 1]; ++k) {
      transposed[next[a.column[k]]++] = {i, a.value[k]};
      if (a.column[k] == i) diagonal[i] = std::max(std::abs(a.value[k]), 1.0);
    }
  double largest = 0.0;
  for (int i = 0; i < n; ++i) {  // next[i] is now the end of column i
    for (int k = a.row_start[i]; k < a.row_start[i + 1]; ++k) row[a.column[k]] = a.value[k];
    for (int k = i > 0 ? next[i - 1] : 0; k < next[i]; ++k) {
      const auto& [j, value] = transposed[k];
      const double difference = std::abs(row[j] - value);
      if (difference > 0.0) largest = std::max(largest, difference / std::sqrt(diagonal[i] * diagonal[j]));
    }
    for (int k = a.row_start[i]; k < a.row_start[i + 1]; ++k) row[a.column[k]] = 0.0;
  }
  return largest;
}

SparseMatrix symmetric_part(SparseMatrix a) {
  for (int i = 0; i < a.rows(); ++i)
    for (int k = a.row_start[i]; k < a.row_start[i + 1]; ++k) {
      const int j = a.column[k];
      if (j >= i) continue;
      const auto end = a.column.begin() + a.row_start[j + 1];
      const auto mirrored = std::find(a.column.begin() + a.row_start[j], end, i);
      if (mirrored == end) continue;
      double& other = a.value[mirrored - a.column.begin()];
      a.value[k] = other = 0.5 * (a.value[k] + other);
    }
  return a;
}

SparseMatrix gathered_structure(const SparseMatrix& here, const RowsOfRanks& share) {
  const int mine = here.rows(), entries = here.row_start.back();
  std::vector<int> lengths(mine), columns(entries);
  for (int i = 0; i < mine; ++i) lengths[i] = here.row_start[i + 1] - here.row_start[i];
  for (int k = 0; k < entries; ++k) columns[k] = share.column_number[here.column[k]];
  const GatherPlan entries_of(share.communicator, entries);
  SparseMatrix all{{0}, {}, {}};
  int rank = 0;
  MPI_Comm_rank(share.communicator, &rank);
  if (rank == 0) {
    all.row_start.resize(share.rows.total() + 1);
    all.column.resize(entries_of.total());
  }
  MPI_Gatherv(lengths.data(), mine, MPI_INT, all.row_start.data() + 1, share.rows.counts.data(),
              share.rows.offsets.data(), MPI_INT, 0, share.communicator);
  MPI_Gatherv(columns.data(), entries, MPI_INT, all.column.data(), entries_of.counts.data(), entries_of.offsets.data(),
              MPI_INT, 0, share.communicator);
  std::partial_sum(all.row_start.begin(), all.row_start.end(), all.row_start.begin());
  return all;
}

SparseMatrix gathered(const SparseMatrix& here, const RowsOfRanks& share) {
  SparseMatrix all = gathered_structure(here, share);
  const GatherPlan entries(share.communicator, here.row_start.back());
  all.value.resize(all.column.size());
  MPI_Gatherv(here.value.data(), here.row_start.back(), MPI_DOUBLE, all.value.data(), entries.counts.data(),
              entries.offsets.data(), MPI_DOUBLE, 0, share.communicator);
  return all;
}

RootCopy::RootCopy(const Teuchos::RCP<DofMatrix>& matrix)
    : distributed_(matrix), is_root_(matrix->getRowMap()->getComm()->getRank() == 0) {
  if (matrix->getRowMap()->getComm()->getSize() == 1) {
    root_ = matrix;
    return;
  }
  mpi_ = communicator_of(*matrix);
  const auto graph = matrix->getCrsGraph()->getLocalGraphHost();
  SparseMatrix here{{0}, {graph.entries.data(), graph.entries.data() + graph.entries.extent(0)}, {}};
  for (int i = 0; i < static_cast<int>(graph.numRows()); ++i)
    here.row_start.push_back(static_cast<int>(graph.row_map(i + 1)));
  RowsOfRanks share{mpi_, GatherPlan(mpi_, here.rows()), 0, {}};
  for (size_t column = 0; column < matrix->getColMap()->getNodeNumElements(); ++column)
    share.column_number.push_back(
        static_cast<int>(matrix->getColMap()->getGlobalElement(static_cast<LocalOrdinal>(column))));
  rows_ = share.rows;
  entries_ = GatherPlan(mpi_, here.row_start.back());
  const SparseMatrix all = gathered_structure(here, share);
  if (!is_root_) return;
  using Graph = DofMatrix::local_graph_host_type;
  Graph::row_map_type::non_const_type start("mixbeam::root_row_start", all.row_start.size());
  Graph::entries_type::non_const_type columns("mixbeam::root_column", all.column.size());
  std::copy(all.row_start.begin(), all.row_start.end(), start.data());
  std::copy(all.column.begin(), all.column.end(), columns.data());
  const Communicator self = Teuchos::rcp(new Teuchos::MpiComm<int>(MPI_COMM_SELF));
  const auto map = Teuchos::rcp(new DofMap(all.rows(), 0, self));
  DofMatrix::local_matrix_host_type::values_type::non_const_type values("mixbeam::root_values", columns.extent(0));
  root_ = Teuchos::rcp(new DofMatrix(map, map, start, columns, values));
  root_->expertStaticFillComplete(map, map);
}

void RootCopy::share(void* numbers, int count, MPI_Datatype type) const {
  if (!is_alone()) MPI_Bcast(numbers, count, type, 0, mpi_);
}

void RootCopy::gather_values() const {
  if (is_alone()) return;
  const auto mine = distributed_->getLocalMatrixHost().values;
  double* all = is_root_ ? root_->getLocalMatrixHost().values.data() : nullptr;
  MPI_Gatherv(mine.data(), static_cast<int>(mine.extent(0)), MPI_DOUBLE, all, entries_.counts.data(),
              entries_.offsets.data(), MPI_DOUBLE, 0, mpi_);
}

void RootCopy::gather(const DofVector& from, double* to) const {
  const auto mine = from.getLocalViewHost(Tpetra::Access::ReadOnly);
  if (is_alone())
    std::copy_n(mine.data(), mine.extent(0), to);
  else
    MPI_Gatherv(mine.data(), static_cast<int>(mine.extent(0)), MPI_DOUBLE, to, rows_.counts.data(),
                rows_.offsets.data(), MPI_DOUBLE, 0, mpi_);
}

void RootCopy::scatter(const double* from, DofVector& to) const {
  const auto mine = to.getLocalViewHost(Tpetra::Access::OverwriteAll);
  if (is_alone())
    std::copy_n(from, mine.extent(0), mine.data());
  else
    MPI_Scatterv(from, rows_.counts.data(), rows_.offsets.data(), MPI_DOUBLE, mine.data(),
                 static_cast<int>(mine.extent(0)), MPI_DOUBLE, 0, mpi_);
}

}  // namespace mixbeam
