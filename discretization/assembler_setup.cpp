// Maps and row-gather tables: done once for each scene.
#include "discretization/assembler.hpp"

#include <algorithm>
#include <tuple>
#include <vector>

namespace mixbeam {

void Assembler::build_maps(const Communicator& comm) {
  const size_t owned = static_cast<size_t>(kVertexDofs) * structure_.owned_vertices;
  maps_.rows = Teuchos::rcp(new DofMap(static_cast<GlobalOrdinal>(kVertexDofs) * mesh_.vertices(), owned, 0, comm));
  maps_.columns = maps_.rows;
  if (comm->getSize() > 1) {
    std::vector<GlobalOrdinal> dofs;
    for (int global : structure_.local_vertex_to_global)
      for (int c = 0; c < kVertexDofs; ++c) dofs.push_back(static_cast<GlobalOrdinal>(kVertexDofs) * global + c);
    const auto unknown = Teuchos::OrdinalTraits<Tpetra::global_size_t>::invalid();
    maps_.columns = Teuchos::rcp(new DofMap(unknown, Teuchos::arrayViewFromVector(dofs), 0, comm));
    maps_.import = Teuchos::rcp(new DofImport(maps_.rows, maps_.columns));
    ghosted_increment_ = Teuchos::rcp(new DofVector(maps_.columns));
  }
  condensed_residual_ = Teuchos::rcp(new DofVector(maps_.rows));
}

void Assembler::mark_fixed_rows() {
  fixed_ = KernelView<unsigned char*>("mixbeam::fixed", static_cast<size_t>(kVertexDofs) * structure_.owned_vertices);
  constraints_.mark_fixed(fixed_);
}

void Assembler::mark_owned_interior() {
  if (maps_.import.is_null()) return;  // one rank owns everything
  owned_interior_ = KernelView<unsigned char*>("mixbeam::owned_interior", structure_.increment_size);
  for (const ElementBlock& block : structure_.blocks)
    for (int e = 0; e < block.count; ++e) {
      const bool owned = block.vertices(e, 0) < structure_.owned_vertices;
      const size_t first = block.increment_offset + static_cast<size_t>(e) * block.interior.increments();
      for (int i = 0; i < block.interior.increments(); ++i) owned_interior_(first + i) = owned;
    }
}

void Assembler::build_adjacency() {
  const int owned = structure_.owned_vertices;
  struct Touch {
    int mesh_element, end, element;
    bool operator<(const Touch& other) const {
      return std::tie(mesh_element, end) < std::tie(other.mesh_element, other.end);
    }
  };
  std::vector<std::vector<Touch>> touching(owned);
  int count = 0;
  for (const ElementBlock& block : structure_.blocks)
    for (int e = 0; e < block.count; ++e)
      for (int end = 0; end < 2; ++end) {
        const int v = block.vertices(e, end), element = block.first_element + e;
        if (v >= owned) continue;
        touching[v].push_back({structure_.local_element_to_mesh[element], end, element});
        ++count;
      }
  adjacency_.start = KernelView<int*>("mixbeam::adjacency_start", owned + 1);
  adjacency_.element = KernelView<int* [2]>("mixbeam::adjacency", count);
  for (int v = 0; v < owned; ++v) {
    std::sort(touching[v].begin(), touching[v].end());
    int a = adjacency_.start(v);
    for (const Touch& touch : touching[v]) {
      adjacency_.element(a, 0) = touch.element;
      adjacency_.element(a++, 1) = touch.end;
    }
    adjacency_.start(v + 1) = a;
  }
}

}  // namespace mixbeam
