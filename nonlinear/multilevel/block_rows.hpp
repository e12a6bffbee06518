/// The matrix that chains leave, read by vertices: rows of a vertex have the same columns, six for each neighbour.
#pragma once

#include "discretization/mesh/mixed_vector.hpp"

namespace mixbeam {

/// Neighbours of the vertices that remain, from the rows of the matrix.
struct BlockRows {
  explicit BlockRows(const DofMatrix& matrix) : local(matrix.getLocalMatrixHost()) {}
  int vertices() const { return static_cast<int>(local.numRows()) / kVertexDofs; }
  int blocks(int v) const { return static_cast<int>(width(v)) / kVertexDofs; }
  int neighbour(int v, int block) const {
    return local.graph.entries(local.graph.row_map(kVertexDofs * v) + kVertexDofs * block) / kVertexDofs;
  }
  size_t width(int v) const { return local.graph.row_map(kVertexDofs * v + 1) - local.graph.row_map(kVertexDofs * v); }
  /// First entry of a row of a vertex.
  const double* row(int v, int r) const { return &local.values(local.graph.row_map(kVertexDofs * v) + width(v) * r); }

  DofMatrix::local_matrix_host_type local;
};

}  // namespace mixbeam
