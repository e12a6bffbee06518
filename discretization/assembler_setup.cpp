// Maps and row-gather tables: done once for each scene.
#include "discretization/assembler.hpp"

#include "kernels/element_kinematics.hpp"

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

void Assembler::build_plane() {
  if (!options_.planar) return;
  plane_ = plane_of(*maps_.rows->getComm(), mesh_, structure_, line_fields_, conditions_);
  if (!plane_) return;
  for (const ElementBlock& block : structure_.blocks) planar_blocks_.push_back(make_planar_block(block, *plane_));
  using Kokkos::view_alloc;
  planar_tangents_ =
      PlanarTangents(view_alloc("mixbeam::planar::tangents", Kokkos::WithoutInitializing), structure_.local_elements());
}

State Assembler::reference_state() const {
  State state = mixbeam::reference_state(structure_, mesh_);
  state.in_plane = plane_.has_value();
  return state;
}

namespace {

/// Of the largest entry: roundings of directions in a plane that is not one of the coordinates'.
constexpr double kPlaneRounding = 1e-13;

}  // namespace

/// A motion of an element that leaves the plane moves one of its vertices out of it, or turns one, unless all are held.
bool Assembler::is_in_plane(const MixedVector& v) const {
  const PlaneAxes axes = *plane_;
  const KernelView<const double*> entries = v.vertex();
  const double sizes[2] = {largest_part(*maps_.rows->getComm(), entries, kForcePart),
                           largest_part(*maps_.rows->getComm(), entries, kMomentPart)};
  double out = 0.0;
  Kokkos::parallel_reduce(
      "mixbeam::plane::out", Kokkos::RangePolicy<ExecutionSpace>(0, structure_.owned_vertices),
      KOKKOS_LAMBDA(int vertex, double& largest) {
        const Vec moved = load_vector(&entries(vertex_row(vertex, kForcePart)));
        const Vec turned = load_vector(&entries(vertex_row(vertex, kMomentPart)));
        const double parts[3] = {dot(axes.n, moved) / (sizes[0] > 0.0 ? sizes[0] : 1.0),
                                 dot(axes.p, turned) / (sizes[1] > 0.0 ? sizes[1] : 1.0),
                                 dot(axes.q, turned) / (sizes[1] > 0.0 ? sizes[1] : 1.0)};
        for (double part : parts) {
          const double size = part < 0.0 ? -part : part;
          if (!(size <= largest)) largest = size == size ? size : 2.0;  // not a number: out of any plane
        }
      },
      Kokkos::Max<double>(out));
  return maximum_over_ranks(*maps_.rows->getComm(), out) <= kPlaneRounding;
}

}  // namespace mixbeam
