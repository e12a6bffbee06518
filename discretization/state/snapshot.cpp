#include "discretization/state/snapshot.hpp"

#include <Teuchos_CommHelpers.hpp>
#include <Teuchos_DefaultMpiComm.hpp>

#include <mpi.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <stdexcept>

namespace mixbeam {

namespace {

static_assert(sizeof(std::uint64_t) == sizeof(double), "doubles travel as bit patterns");

/// Calls `visit(snapshot array, its offset, numbers of the state, their count)` for everything that this rank holds, or
/// only for what it answers for.
template <class Visit>
void for_each_piece(const Model& model, const State& state, const std::vector<size_t>& interior_first, bool with_ghosts,
                    StateSnapshot& snapshot, const Visit& visit) {
  const Structure& structure = model.structure();
  const int vertices = with_ghosts ? structure.local_vertices() : structure.owned_vertices;
  for (int v = 0; v < vertices; ++v) {
    const auto global = static_cast<size_t>(structure.local_vertex_to_global[v]);
    visit(snapshot.vertex_displacement, 3 * global, &state.views.vertex_displacement(v, 0), 3);
    visit(snapshot.vertex_rotation, 4 * global, &state.views.vertex_rotation(v, 0), 4);
  }
  for (const ElementBlock& block : structure.blocks)
    for (int e = 0; e < block.count; ++e) {
      if (!with_ghosts && block.vertices(e, 0) >= structure.owned_vertices) continue;
      const int local = block.first_element + e;
      const auto element = static_cast<size_t>(structure.local_element_to_mesh[local]);
      const auto unknowns = static_cast<size_t>(block.interior.unknowns());
      visit(snapshot.element_triad, 4 * element, &state.views.element_triad(local, 0), 4);
      visit(snapshot.interior, interior_first[element],
            state.views.interior.data() + block.interior_offset + static_cast<size_t>(e) * unknowns, unknowns);
    }
}

MPI_Comm raw(const Communicator& comm) {
  return *Teuchos::rcp_dynamic_cast<const Teuchos::MpiComm<int>>(comm, true)->getRawMpiComm();
}

/// Every number is zero on all ranks but one. Adding them up would turn -0 into +0; "or" of the bits keeps every one.
void collect_on_root(const Communicator& comm, std::vector<double>& numbers) {
  if (comm->getSize() == 1) return;
  const bool is_root = comm->getRank() == 0;
  const void* from = is_root ? MPI_IN_PLACE : static_cast<const void*>(numbers.data());
  MPI_Reduce(from, is_root ? numbers.data() : nullptr, static_cast<int>(numbers.size()), MPI_UINT64_T, MPI_BOR, 0,
             raw(comm));
  if (!is_root) numbers.clear();
}

std::vector<std::vector<double>*> arrays_of(StateSnapshot& snapshot) {
  return {&snapshot.vertex_displacement, &snapshot.vertex_rotation, &snapshot.element_triad, &snapshot.interior};
}

std::vector<size_t> sizes_for(const Model& model, const std::vector<size_t>& interior_first) {
  const auto vertices = static_cast<size_t>(model.mesh().vertices());
  return {3 * vertices, 4 * vertices, 4 * model.mesh().elements.size(), interior_first.back()};
}

void require_sizes(const Communicator& comm, StateSnapshot& snapshot, const std::vector<size_t>& sizes) {
  int fits = 1;
  const auto arrays = arrays_of(snapshot);
  for (size_t i = 0; i < arrays.size(); ++i)
    if (arrays[i]->size() != sizes[i]) fits = 0;
  Teuchos::broadcast(*comm, 0, &fits);
  if (fits == 0)
    throw std::invalid_argument(
        "the state does not belong to this mesh: numbers of vertices, elements or orders differ");
}

void append(std::vector<double>& array, const double* numbers, size_t count) {
  array.insert(array.end(), numbers, numbers + count);
}

void add_vertices(const Model& model, const State& state, StateShare& share) {
  const Structure& structure = model.structure();
  const auto owned = static_cast<size_t>(structure.owned_vertices);
  share.vertices.rows = static_cast<size_t>(model.mesh().vertices());
  share.held.vertex_displacement.reserve(3 * owned);
  share.held.vertex_rotation.reserve(4 * owned);
  for (int v = 0; v < structure.owned_vertices; ++v) {
    share.vertices.hold(static_cast<size_t>(structure.local_vertex_to_global[v]), 1);
    append(share.held.vertex_displacement, &state.views.vertex_displacement(v, 0), 3);
    append(share.held.vertex_rotation, &state.views.vertex_rotation(v, 0), 4);
  }
}

void add_elements(const Model& model, const State& state, StateShare& share) {
  const Structure& structure = model.structure();
  const std::vector<size_t> interior_first = interior_places(model.scene(), model.mesh());
  share.elements.rows = model.mesh().elements.size();
  share.interior.rows = interior_first.back();
  share.held.element_triad.reserve(4 * structure.local_element_to_mesh.size());
  share.held.interior.reserve(structure.interior_size);
  for (size_t element = 0; element < share.elements.rows; ++element) {
    const int local = structure.mesh_element_to_local[element];
    if (local < 0) continue;
    const ElementBlock& block = structure.block_of(local);
    const int e = local - block.first_element;
    if (block.vertices(e, 0) >= structure.owned_vertices) continue;
    const auto unknowns = static_cast<size_t>(block.interior.unknowns());
    share.elements.hold(element, 1);
    share.interior.hold(interior_first[element], unknowns);
    append(share.held.element_triad, &state.views.element_triad(local, 0), 4);
    append(share.held.interior, state.views.interior.data() + block.interior_offset + static_cast<size_t>(e) * unknowns,
           unknowns);
  }
}

}  // namespace

std::vector<size_t> interior_places(const Scene& scene, const Mesh& mesh) {
  std::vector<size_t> first{0};
  first.reserve(mesh.elements.size() + 1);
  for (const MeshElement& element : mesh.elements) {
    const Member& member = scene.members[element.member];
    const InteriorLayout layout{member.order, force_point_count(member.order, member.force_integration)};
    first.push_back(first.back() + static_cast<size_t>(layout.unknowns()));
  }
  return first;
}

StateShare share_of(const Model& model, const State& state) {
  StateShare share;
  share.held.in_plane = state.in_plane;
  add_vertices(model, state, share);
  add_elements(model, state, share);
  return share;
}

StateSnapshot snapshot_of(const Model& model, const State& state) {
  const Communicator comm = model.map()->getComm();
  const std::vector<size_t> interior_first = interior_places(model.scene(), model.mesh());
  StateSnapshot snapshot;
  snapshot.in_plane = state.in_plane;
  const auto sizes = sizes_for(model, interior_first);
  const auto arrays = arrays_of(snapshot);
  for (size_t i = 0; i < arrays.size(); ++i) arrays[i]->assign(sizes[i], 0.0);
  for_each_piece(model, state, interior_first, false, snapshot,
                 [](std::vector<double>& array, size_t place, const double* numbers, size_t count) {
                   std::copy_n(numbers, count, array.data() + place);
                 });
  for (std::vector<double>* array : arrays) collect_on_root(comm, *array);
  return snapshot;
}

State restore(const Model& model, const StateSnapshot& given) {
  const Communicator comm = model.map()->getComm();
  const std::vector<size_t> interior_first = interior_places(model.scene(), model.mesh());
  StateSnapshot snapshot = given;
  const auto sizes = sizes_for(model, interior_first);
  require_sizes(comm, snapshot, sizes);
  const auto arrays = arrays_of(snapshot);
  for (size_t i = 0; i < arrays.size(); ++i) {
    arrays[i]->resize(sizes[i]);
    if (comm->getSize() > 1) MPI_Bcast(arrays[i]->data(), static_cast<int>(sizes[i]), MPI_DOUBLE, 0, raw(comm));
  }
  State state = allocate_state(model.structure());
  int in_plane = snapshot.in_plane ? 1 : 0;
  Teuchos::broadcast(*comm, 0, &in_plane);
  state.in_plane = in_plane == 1 && model.plane().has_value();
  for_each_piece(model, state, interior_first, true, snapshot,
                 [](const std::vector<double>& array, size_t place, double* numbers, size_t count) {
                   std::copy_n(array.data() + place, count, numbers);
                 });
  return state;
}

}  // namespace mixbeam
