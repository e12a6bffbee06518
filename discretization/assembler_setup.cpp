// Maps, row-gather tables and the structure of the matrix: done once for each scene.
#include "discretization/assembler.hpp"

#include <algorithm>
#include <utility>
#include <vector>

namespace mixbeam {

namespace {

/// An element at a vertex.
struct Touch {
  int element;  ///< local
  int mesh_element;
  int end;    ///< which end of the element the vertex is
  int other;  ///< local vertex at its other end
};

/// Elements at each owned vertex, in the order of the whole mesh, so that sums are the same for every partition.
std::vector<std::vector<Touch>> elements_at_vertices(const Structure& structure) {
  std::vector<std::vector<Touch>> touching(structure.owned_vertices);
  for (const ElementBlock& block : structure.blocks)
    for (int e = 0; e < block.count; ++e)
      for (int end = 0; end < 2; ++end) {
        const int v = block.vertices(e, end), local = block.first_element + e;
        if (v < structure.owned_vertices)
          touching[v].push_back({local, structure.local_element_to_mesh[local], end, block.vertices(e, 1 - end)});
      }
  for (std::vector<Touch>& touches : touching)
    std::sort(touches.begin(), touches.end(), [](const Touch& a, const Touch& b) {
      return std::make_pair(a.mesh_element, a.end) < std::make_pair(b.mesh_element, b.end);
    });
  return touching;
}

/// Vertices that share a block row: the vertex itself and its neighbours, ascending; a pair joined by several members
/// once.
std::vector<int> row_columns(int vertex, const std::vector<Touch>& touches) {
  std::vector<int> columns = {vertex};
  for (const Touch& touch : touches) columns.push_back(touch.other);
  std::sort(columns.begin(), columns.end());
  columns.erase(std::unique(columns.begin(), columns.end()), columns.end());
  return columns;
}

}  // namespace

void Assembler::build_maps(const Communicator& comm) {
  const size_t owned = static_cast<size_t>(kVertexDofs) * structure_.owned_vertices;
  row_map_ = Teuchos::rcp(new DofMap(static_cast<GlobalOrdinal>(kVertexDofs) * mesh_.vertices(), owned, 0, comm));
  column_map_ = row_map_;
  if (comm->getSize() > 1) {
    std::vector<GlobalOrdinal> dofs;
    for (int global : structure_.local_vertex_to_global)
      for (int c = 0; c < kVertexDofs; ++c) dofs.push_back(static_cast<GlobalOrdinal>(kVertexDofs) * global + c);
    const auto unknown = Teuchos::OrdinalTraits<Tpetra::global_size_t>::invalid();
    column_map_ = Teuchos::rcp(new DofMap(unknown, Teuchos::arrayViewFromVector(dofs), 0, comm));
    import_ = Teuchos::rcp(new DofImport(row_map_, column_map_));
    ghosted_increment_ = Teuchos::rcp(new DofVector(column_map_));
  }
  condensed_residual_ = Teuchos::rcp(new DofVector(row_map_));
}

void Assembler::mark_fixed_rows() {
  fixed_ = KernelView<unsigned char*>("mixbeam::fixed", static_cast<size_t>(kVertexDofs) * structure_.owned_vertices);
  constraints_.mark_fixed(fixed_);
}

void Assembler::mark_owned_interior() {
  if (import_.is_null()) return;  // one rank owns everything
  owned_interior_ = KernelView<unsigned char*>("mixbeam::owned_interior", structure_.increment_size);
  for (const ElementBlock& block : structure_.blocks)
    for (int e = 0; e < block.count; ++e) {
      const bool owned = block.vertices(e, 0) < structure_.owned_vertices;
      const size_t first = block.increment_offset + static_cast<size_t>(e) * block.interior.increments();
      for (int i = 0; i < block.interior.increments(); ++i) owned_interior_(first + i) = owned;
    }
}

void Assembler::build_graph() {
  const int n = structure_.owned_vertices;
  const std::vector<std::vector<Touch>> touching = elements_at_vertices(structure_);
  std::vector<std::vector<int>> columns(n);
  adjacency_start_ = KernelView<int*>("mixbeam::adjacency_start", n + 1);
  for (int v = 0; v < n; ++v) {
    columns[v] = row_columns(v, touching[v]);
    adjacency_start_(v + 1) = adjacency_start_(v) + static_cast<int>(touching[v].size());
  }
  couple_joints(columns);
  size_t entries = 0;
  for (int v = 0; v < n; ++v) entries += kVertexDofs * kVertexDofs * columns[v].size();
  adjacency_ = KernelView<int* [4]>("mixbeam::adjacency", adjacency_start_(n));
  for (int v = 0; v < n; ++v) {
    const auto slot = [&](int vertex) {
      return static_cast<int>(std::lower_bound(columns[v].begin(), columns[v].end(), vertex) - columns[v].begin());
    };
    int a = adjacency_start_(v);
    for (const Touch& touch : touching[v]) {
      const int row[4] = {touch.element, touch.end, slot(v), slot(touch.other)};
      std::copy_n(row, 4, &adjacency_(a++, 0));
    }
  }
  build_matrix(columns, entries);
}

/// The rows of a master take those of its slaves, and the rows of a slave see the master.
void Assembler::couple_joints(std::vector<std::vector<int>>& columns) const {
  for (const VertexJoint& joint : conditions_.joints) {
    std::vector<int>& master = columns[joint.master];
    std::vector<int>& slave = columns[joint.slave];
    master.insert(master.end(), slave.begin(), slave.end());
    slave.push_back(joint.master);
    for (std::vector<int>* both : {&master, &slave}) {
      std::sort(both->begin(), both->end());
      both->erase(std::unique(both->begin(), both->end()), both->end());
    }
  }
}

/// A matrix over the given block columns of each vertex, filled with zeros; its structure never changes again.
void Assembler::build_matrix(const std::vector<std::vector<int>>& columns, size_t entries) {
  using LocalGraph = DofMatrix::local_graph_host_type;
  LocalGraph::row_map_type::non_const_type row_start("mixbeam::row_start", kVertexDofs * columns.size() + 1);
  LocalGraph::entries_type::non_const_type column("mixbeam::column", entries);
  DofMatrix::local_matrix_host_type::values_type::non_const_type values("mixbeam::matrix_values", entries);
  for (size_t row = 0; row + 1 < row_start.extent(0); ++row) {
    const std::vector<int>& neighbours = columns[row / kVertexDofs];
    size_t entry = row_start(row);
    for (int vertex : neighbours)
      for (int c = 0; c < kVertexDofs; ++c) column(entry++) = kVertexDofs * vertex + c;
    row_start(row + 1) = entry;
  }
  matrix_ = Teuchos::rcp(new DofMatrix(row_map_, column_map_, row_start, column, values));
  matrix_->expertStaticFillComplete(row_map_, row_map_, import_);
}

}  // namespace mixbeam
