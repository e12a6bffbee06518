// Maps and row-gather tables: done once for each scene.
#include "discretization/assembler.hpp"

#include <algorithm>
#include <numeric>
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
  std::vector<int> elements(structure_.local_elements());
  std::iota(elements.begin(), elements.end(), 0);
  std::sort(elements.begin(), elements.end(),
            [this](int a, int b) { return structure_.local_element_to_mesh[a] < structure_.local_element_to_mesh[b]; });
  const auto for_each_end = [&](const auto& action) {
    const ElementBlock* block = &structure_.blocks.front();
    for (int element : elements) {
      if (element < block->first_element || element >= block->first_element + block->count)
        block = &structure_.block_of(element);
      for (int end = 0; end < 2; ++end) {
        const int vertex = block->vertices(element - block->first_element, end);
        if (vertex < owned) action(vertex, element, end);
      }
    }
  };
  adjacency_.start = KernelView<int*>("mixbeam::adjacency_start", owned + 1);
  for_each_end([&](int vertex, int, int) { ++adjacency_.start(vertex + 1); });
  for (int v = 0; v < owned; ++v) adjacency_.start(v + 1) += adjacency_.start(v);
  adjacency_.element = KernelView<int* [2]>("mixbeam::adjacency", adjacency_.start(owned));
  std::vector<int> next(adjacency_.start.data(), adjacency_.start.data() + owned);
  for_each_end([&](int vertex, int element, int end) {
    const int entry = next[vertex]++;
    adjacency_.element(entry, 0) = element;
    adjacency_.element(entry, 1) = end;
  });
}

}  // namespace mixbeam
