/// Sparse matrix over some vertices of a structure, six rows each, gathered row by row from the matrices of the links
/// between them (elements, or chains condensed to one link). Its sparsity never changes.
#pragma once

#include "discretization/constraints/constraint_rows.hpp"
#include "discretization/linear_system/chain_structure.hpp"

#include <vector>

namespace mixbeam {

/// Distribution of the vertices of the whole structure, and communication of ghost entries.
struct VertexMaps {
  Teuchos::RCP<const DofMap> rows, columns;  ///< six entries for each owned vertex; for each local one
  Teuchos::RCP<DofImport> import;            ///< null on one rank
};

class VertexMatrix {
 public:
  /// `present`: (local vertex) 1 if it has rows (owned) or columns. Joints couple the rows of master and slave. Sums
  /// follow RemainingLink::first_element, the same order for every partition. Collective.
  VertexMatrix(const Structure& structure, const VertexMaps& maps, const std::vector<unsigned char>& present,
               std::vector<RemainingLink> links, const std::vector<VertexJoint>& joints);

  const Teuchos::RCP<DofMatrix>& matrix() const { return matrix_; }
  /// Local vertices that have rows, in row order.
  const KernelView<int*>& vertices() const { return vertices_; }
  /// Index of a local vertex among rows and columns, -1 if it has none.
  int place(int local_vertex) const { return place_(local_vertex); }
  MatrixRows rows() const { return {matrix_->getLocalMatrixHost(), place_}; }

  /// Sets the matrix to the sum of the matrices of all links.
  void gather(const LinkMatrices<kSpatialDofs>& links) const;
  /// Sums the shares of runs at the vertices at their ends (run, 12) in `rows` (6 * local vertex + component), at all
  /// vertices that have rows here. Links from `first_run` on are runs.
  void sum_at_ends(const KernelView<double* [12]>& arrived, int first_run, const KernelView<double*>& rows) const;
  /// Sums the forces exerted by runs: their matrices times x, minus the rows that arrived.
  void run_forces(const LinkMatrices<kSpatialDofs>& links, const KernelView<double* [12]>& arrived, int first_run,
                  const KernelView<const double*>& x, const KernelView<double*>& rows) const;

 private:
  void build_maps(const VertexMaps& maps, const std::vector<unsigned char>& present);
  void build_graph(const std::vector<RemainingLink>& links, const std::vector<VertexJoint>& joints);
  void build_matrix(const std::vector<std::vector<int>>& columns, size_t entries);

  int owned_ = 0;  ///< owned vertices of the structure
  KernelView<int*> vertices_;
  KernelView<int*> place_;  ///< (local vertex)
  Teuchos::RCP<const DofMap> row_map_, column_map_;
  Teuchos::RCP<DofImport> import_;
  Teuchos::RCP<DofMatrix> matrix_;
  // links at each row vertex: entries [start(v), start(v + 1))
  KernelView<int*> start_;
  KernelView<int* [4]> adjacency_;  ///< link, its end here, column slot of this vertex, of the other
};

}  // namespace mixbeam
