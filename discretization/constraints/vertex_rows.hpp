/// The rows of a vertex, in vectors and in the matrix, as equations of vectors: what supports and joints rewrite.
#pragma once

#include "discretization/mesh/mixed_vector.hpp"
#include "kernels/element/kinematics.hpp"

namespace mixbeam {

/// First component of a vertex: of displacement or force, of rotation or moment.
enum VertexPart { kForcePart = 0, kMomentPart = 3 };

inline size_t vertex_row(int vertex, int component) { return static_cast<size_t>(kVertexDofs) * vertex + component; }

inline Vec rows_of(const KernelView<double*>& rows, int vertex, VertexPart part) {
  return load_vector(&rows(vertex_row(vertex, part)));
}
inline void set_rows_of(const KernelView<double*>& rows, int vertex, VertexPart part, const Vec& value) {
  store_vector(value, &rows(vertex_row(vertex, part)));
}

/// Rows of owned vertices in the matrix of one rank. Every row of a vertex has the same columns: six for each of some
/// local vertices, ascending.
class MatrixRows {
 public:
  /// `place`: (local vertex) where it stands among rows and columns, -1 where it has none.
  MatrixRows(const DofMatrix::local_matrix_host_type& matrix, const KernelView<const int*>& place)
      : matrix_(matrix), place_(place) {}

  void clear(int vertex, int component) const;
  /// Adds value . (displacement or rotation of `column_vertex`) to a row.
  void add(int vertex, int component, int column_vertex, VertexPart column_part, const Vec& value) const;
  /// Adds a 3 x 3 block.
  void add(int vertex, VertexPart part, int column_vertex, VertexPart column_part, const Mat& block) const;
  /// Adds `factor` times the rows of `part` of another vertex, whose columns must be among those of this one.
  void add_rows(int vertex, VertexPart part, const Mat& factor, int other, VertexPart other_part) const;
  /// Row i of the part becomes the sum of factor(i, j) times row j.
  void combine(int vertex, VertexPart part, const Mat& factor) const;

 private:
  size_t row(int vertex, int component) const { return vertex_row(place_(vertex), component); }
  /// The six entries of a row at a place among the columns.
  double* entries(size_t row, int column_place) const;

  DofMatrix::local_matrix_host_type matrix_;
  KernelView<const int*> place_;
};

}  // namespace mixbeam
