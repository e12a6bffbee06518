#include "discretization/constraints/vertex_rows.hpp"

#include <stdexcept>

namespace mixbeam {

double* MatrixRows::entries(size_t row, int column_place) const {
  const int wanted = kVertexDofs * column_place;
  size_t low = matrix_.graph.row_map(row) / kVertexDofs, high = matrix_.graph.row_map(row + 1) / kVertexDofs;
  while (low < high) {  // the blocks of six ascend
    const size_t middle = (low + high) / 2;
    if (matrix_.graph.entries(kVertexDofs * middle) < wanted)
      low = middle + 1;
    else
      high = middle;
  }
  if (kVertexDofs * low >= matrix_.graph.row_map(row + 1) || matrix_.graph.entries(kVertexDofs * low) != wanted)
    throw std::logic_error("the matrix has no entry where a joint couples two vertices");
  return &matrix_.values(kVertexDofs * low);
}

void MatrixRows::clear(int vertex, int component) const {
  const size_t cleared = row(vertex, component);
  for (size_t k = matrix_.graph.row_map(cleared); k < matrix_.graph.row_map(cleared + 1); ++k) matrix_.values(k) = 0.0;
}

void MatrixRows::add(int vertex, int component, int column_vertex, VertexPart column_part, const Vec& value) const {
  double* to = entries(row(vertex, component), place_(column_vertex)) + column_part;
  for (int j = 0; j < 3; ++j) to[j] += value[j];
}

void MatrixRows::add(int vertex, VertexPart part, int column_vertex, VertexPart column_part, const Mat& block) const {
  for (int i = 0; i < 3; ++i)
    add(vertex, part + i, column_vertex, column_part, Vec{{block(i, 0), block(i, 1), block(i, 2)}});
}

void MatrixRows::add_rows(int vertex, VertexPart part, const Mat& factor, int other, VertexPart other_part) const {
  const size_t first = matrix_.graph.row_map(row(other, other_part));
  const size_t width = matrix_.graph.row_map(row(other, other_part) + 1) - first;
  for (size_t block = 0; block < width; block += kVertexDofs) {
    const int column_place = matrix_.graph.entries(first + block) / kVertexDofs;
    for (int i = 0; i < 3; ++i) {
      double* to = entries(row(vertex, part + i), column_place);
      for (int c = 0; c < kVertexDofs; ++c)
        for (int j = 0; j < 3; ++j) to[c] += factor(i, j) * matrix_.values(first + j * width + block + c);
    }
  }
}

void MatrixRows::combine(int vertex, VertexPart part, const Mat& factor) const {
  const size_t first = matrix_.graph.row_map(row(vertex, part));
  const size_t width = matrix_.graph.row_map(row(vertex, part) + 1) - first;
  for (size_t k = 0; k < width; ++k) {
    const Vec column{
        {matrix_.values(first + k), matrix_.values(first + width + k), matrix_.values(first + 2 * width + k)}};
    const Vec combined = factor * column;
    for (int i = 0; i < 3; ++i) matrix_.values(first + i * width + k) = combined[i];
  }
}

}  // namespace mixbeam
