#include "discretization/state_snapshot.hpp"

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

/// Interior unknowns of every element of the mesh: where they start, and their number behind the last one.
std::vector<size_t> interior_places(const Assembler& assembler) {
  const Structure& structure = assembler.structure();
  const size_t elements = assembler.mesh().elements.size();
  std::vector<int> unknowns(elements, 0), all(elements, 0);
  for (const ElementBlock& block : structure.blocks)
    for (int e = 0; e < block.count; ++e)
      unknowns[structure.local_element_to_mesh[block.first_element + e]] = block.interior.unknowns();
  Teuchos::reduceAll(*assembler.map()->getComm(), Teuchos::REDUCE_MAX, static_cast<int>(elements), unknowns.data(),
                     all.data());
  std::vector<size_t> first(elements + 1, 0);
  for (size_t e = 0; e < elements; ++e) first[e + 1] = first[e] + static_cast<size_t>(all[e]);
  return first;
}

/// Calls `visit(snapshot array, its offset, numbers of the state, their count)` for everything that this rank holds, or
/// only for what it answers for.
template <class Visit>
void for_each_piece(const Assembler& assembler, const State& state, const std::vector<size_t>& interior_first,
                    bool with_ghosts, StateSnapshot& snapshot, const Visit& visit) {
  const Structure& structure = assembler.structure();
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

std::vector<size_t> sizes_for(const Assembler& assembler, const std::vector<size_t>& interior_first) {
  const auto vertices = static_cast<size_t>(assembler.mesh().vertices());
  return {3 * vertices, 4 * vertices, 4 * assembler.mesh().elements.size(), interior_first.back()};
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

}  // namespace

StateSnapshot snapshot_of(const Assembler& assembler, const State& state) {
  const Communicator comm = assembler.map()->getComm();
  const std::vector<size_t> interior_first = interior_places(assembler);
  StateSnapshot snapshot;
  snapshot.in_plane = state.in_plane;
  const auto sizes = sizes_for(assembler, interior_first);
  const auto arrays = arrays_of(snapshot);
  for (size_t i = 0; i < arrays.size(); ++i) arrays[i]->assign(sizes[i], 0.0);
  for_each_piece(assembler, state, interior_first, false, snapshot,
                 [](std::vector<double>& array, size_t place, const double* numbers, size_t count) {
                   std::copy_n(numbers, count, array.data() + place);
                 });
  for (std::vector<double>* array : arrays) collect_on_root(comm, *array);
  return snapshot;
}

State restore(const Assembler& assembler, const StateSnapshot& given) {
  const Communicator comm = assembler.map()->getComm();
  const std::vector<size_t> interior_first = interior_places(assembler);
  StateSnapshot snapshot = given;
  const auto sizes = sizes_for(assembler, interior_first);
  require_sizes(comm, snapshot, sizes);
  const auto arrays = arrays_of(snapshot);
  for (size_t i = 0; i < arrays.size(); ++i) {
    arrays[i]->resize(sizes[i]);
    if (comm->getSize() > 1) MPI_Bcast(arrays[i]->data(), static_cast<int>(sizes[i]), MPI_DOUBLE, 0, raw(comm));
  }
  State state = allocate_state(assembler.structure());
  int in_plane = snapshot.in_plane ? 1 : 0;
  Teuchos::broadcast(*comm, 0, &in_plane);
  state.in_plane = in_plane == 1 && assembler.plane().has_value();
  for_each_piece(assembler, state, interior_first, true, snapshot,
                 [](const std::vector<double>& array, size_t place, double* numbers, size_t count) {
                   std::copy_n(array.data() + place, count, numbers);
                 });
  return state;
}

}  // namespace mixbeam
