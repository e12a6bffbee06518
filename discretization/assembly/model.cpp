#include "discretization/assembly/model.hpp"

#include "discretization/assembly/workspace.hpp"

#include "kernels/element/kinematics.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

namespace mixbeam {

Model::Model(const Scene& scene, const Communicator& comm, const ModelOptions& options)
    : scene_(scene),
      mesh_(build_mesh(scene)),
      structure_(build_structure(scene, mesh_, comm->getRank(), comm->getSize())),
      line_fields_(scene, mesh_, structure_),
      conditions_(build_conditions(scene, mesh_, structure_)),
      constraints_(conditions_),
      options_(options),
      workspace_(std::make_unique<Workspace>()) {
  PhaseTimer timer(times_, "setup");
  workspace_->rows = allocate_rows(structure_);
  build_maps(comm);
  fixed_ = KernelView<unsigned char*>("mixbeam::fixed", static_cast<size_t>(kVertexDofs) * structure_.owned_vertices);
  constraints_.mark_fixed(fixed_);
  mark_owned_interior();
  build_adjacency();
  build_plane();
}

Model::~Model() = default;

void Model::build_maps(const Communicator& comm) {
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
    workspace_->ghosted_increment = Teuchos::rcp(new DofVector(maps_.columns));
  }
}

void Model::mark_owned_interior() {
  if (maps_.import.is_null()) return;  // one rank owns everything
  owned_interior_ = KernelView<unsigned char*>("mixbeam::owned_interior", structure_.increment_size);
  for (const ElementBlock& block : structure_.blocks)
    for (int e = 0; e < block.count; ++e) {
      const bool owned = block.vertices(e, 0) < structure_.owned_vertices;
      const size_t first = block.increment_offset + static_cast<size_t>(e) * block.interior.increments();
      for (int i = 0; i < block.interior.increments(); ++i) owned_interior_(first + i) = owned;
    }
}

void Model::build_adjacency() {
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

void Model::build_plane() {
  if (!options_.planar) return;
  plane_ = plane_of(*maps_.rows->getComm(), mesh_, structure_, line_fields_, conditions_);
  if (!plane_) return;
  for (const ElementBlock& block : structure_.blocks) planar_blocks_.push_back(make_planar_block(block, *plane_));
  workspace_->rows.planar_rows = KernelView<double* [4]>(
      Kokkos::view_alloc("mixbeam::planar::rows", Kokkos::WithoutInitializing), structure_.local_elements());
}

MixedVector Model::create_vector() const {
  return MixedVector(maps_.rows, structure_.increment_size, owned_interior_, vectors_);
}

KernelView<const double* [6]> Model::local_increment(const MixedVector& increment) const {
  DofVector* source = &increment.vertex_dofs();
  if (!maps_.import.is_null()) {
    workspace_->ghosted_increment->doImport(*source, *maps_.import, Tpetra::REPLACE);
    source = workspace_->ghosted_increment.get();
  }
  const KernelView<double*> flat = MixedVector::view_of(*source);
  return KernelView<const double* [6]>(flat.data(), flat.extent(0) / kVertexDofs);
}

State Model::apply(const State& from, const MixedVector& increment, double step) const {
  PhaseTimer timer(times_, "update");
  State to = allocate_state(structure_);
  const KernelView<const double* [6]> d = local_increment(increment);
  apply_vertex_increment(structure_.local_vertices(), from.views, d, step, to.views);
  for (const ElementBlock& block : structure_.blocks)
    apply_interior_increment(block, from.views, increment.interior(), step, to.views);
  to.in_plane = from.in_plane && is_in_plane(increment);
  return to;
}

VertexMatrix whole_matrix(const Model& model) {
  std::vector<RemainingLink> elements;
  for (const ElementBlock& block : model.structure().blocks)
    for (int e = 0; e < block.count; ++e) {
      const int element = block.first_element + e;
      elements.push_back({element, element, {block.vertices(e, 0), block.vertices(e, 1)}});
    }
  const std::vector<unsigned char> all(model.structure().local_vertices(), 1);
  return VertexMatrix(model.structure(), model.vertex_maps(), all, std::move(elements), model.conditions().joints);
}

State Model::reference_state() const {
  State state = mixbeam::reference_state(structure_, mesh_);
  state.in_plane = plane_.has_value();
  return state;
}

namespace {

/// Of the largest entry: roundings of directions in a plane that is not one of the coordinates'.
constexpr double kPlaneRounding = 1e-13;

/// What vertices do and what of it leaves the plane, each the largest of all.
struct PlaneParts {
  double moved, turned, moved_out, turned_out;
};

struct PlanePartsLoop {
  using value_type = PlaneParts;
  PlaneAxes axes;
  KernelView<const double*> entries;

  KOKKOS_INLINE_FUNCTION static void raise(volatile double& largest, double x) {
    const double size = x < 0.0 ? -x : x;
    if (!(size <= largest)) largest = size == size ? size : HUGE_VAL;
  }
  KOKKOS_INLINE_FUNCTION void init(PlaneParts& parts) const { parts = {0.0, 0.0, 0.0, 0.0}; }
  KOKKOS_INLINE_FUNCTION void join(volatile PlaneParts& parts, const volatile PlaneParts& other) const {
    raise(parts.moved, other.moved);
    raise(parts.turned, other.turned);
    raise(parts.moved_out, other.moved_out);
    raise(parts.turned_out, other.turned_out);
  }
  KOKKOS_INLINE_FUNCTION void operator()(int vertex, PlaneParts& parts) const {
    const Vec moved = load_vector(&entries(vertex_row(vertex, kForcePart)));
    const Vec turned = load_vector(&entries(vertex_row(vertex, kMomentPart)));
    for (int i = 0; i < 3; ++i) {
      raise(parts.moved, moved[i]);
      raise(parts.turned, turned[i]);
    }
    raise(parts.moved_out, dot(axes.n, moved));
    raise(parts.turned_out, dot(axes.p, turned));
    raise(parts.turned_out, dot(axes.q, turned));
  }
};

}  // namespace

/// A motion of an element that leaves the plane moves one of its vertices out of it, or turns one, unless all are held.
bool Model::is_in_plane(const MixedVector& v) const {
  PlaneParts parts{};
  Kokkos::parallel_reduce("mixbeam::plane::parts", Kokkos::RangePolicy<ExecutionSpace>(0, structure_.owned_vertices),
                          PlanePartsLoop{*plane_, v.vertex()}, parts);
  double all[4] = {parts.moved, parts.turned, parts.moved_out, parts.turned_out};
  maxima_over_ranks(*maps_.rows->getComm(), all, 4);
  return all[2] <= kPlaneRounding * all[0] && all[3] <= kPlaneRounding * all[1] && std::isfinite(all[2] + all[3]);
}

}  // namespace mixbeam
