#include "discretization/state/snapshot.hpp"

#include "discretization/assembly/residual.hpp"
#include "discretization/mesh/element_view.hpp"
#include "discretization/mesh/mpi_at_need.hpp"

#include <Teuchos_CommHelpers.hpp>

#include <mpi.h>

#include <algorithm>
#include <cstddef>
#include <stdexcept>
#include <utility>

namespace mixbeam {

namespace {

constexpr int kRoot = 0, kTag = 0;

/// MPI type of the bytes of an entry, so that message sizes count entries.
template <class Entry>
struct EntryType {
  MPI_Datatype type;
  EntryType() : type(MPI_DATATYPE_NULL) {
    MPI_Type_contiguous(sizeof(Entry), MPI_BYTE, &type);
    MPI_Type_commit(&type);
  }
  ~EntryType() { MPI_Type_free(&type); }
  EntryType(const EntryType&) = delete;
  EntryType& operator=(const EntryType&) = delete;
};

template <class Entry>
void send(const std::vector<Entry>& entries, int to, MPI_Comm comm) {
  const EntryType<Entry> entry;
  MPI_Send(entries.data(), static_cast<int>(entries.size()), entry.type, to, kTag, comm);
}

template <class Entry>
std::vector<Entry> receive(int from, MPI_Comm comm) {
  const EntryType<Entry> entry;
  MPI_Status status;
  int count = 0;
  MPI_Probe(from, kTag, comm, &status);
  MPI_Get_count(&status, entry.type, &count);
  std::vector<Entry> entries(static_cast<size_t>(count));
  MPI_Recv(entries.data(), count, entry.type, from, kTag, comm, MPI_STATUS_IGNORE);
  return entries;
}

/// One array of a snapshot, and the rows of it that a share holds.
struct SnapshotArray {
  std::vector<double> StateSnapshot::*array;
  RowShare StateShare::*share;
  size_t columns;
};
constexpr SnapshotArray kSnapshotArrays[] = {{&StateSnapshot::vertex_displacement, &StateShare::vertices, 3},
                                             {&StateSnapshot::vertex_rotation, &StateShare::vertices, 4},
                                             {&StateSnapshot::element_triad, &StateShare::elements, 4},
                                             {&StateSnapshot::interior, &StateShare::interior, 1}};

void place(const std::vector<RowRun>& runs, const std::vector<double>& held, size_t columns,
           std::vector<double>& array) {
  auto from = held.begin();
  for (const RowRun& run : runs) {
    const auto count = static_cast<std::ptrdiff_t>(columns * run.count);
    std::copy_n(from, count, array.begin() + static_cast<std::ptrdiff_t>(columns * run.first));
    from += count;
  }
}

/// Collects all shares on rank 0.
StateSnapshot collected(const Communicator& comm, const StateShare& mine) {
  StateSnapshot snapshot;
  snapshot.in_plane = mine.held.in_plane;
  for (const SnapshotArray& rows : kSnapshotArrays) {
    const RowShare& share = mine.*rows.share;
    if (comm->getRank() != kRoot) {
      send(share.runs, kRoot, mpi_of(*comm));
      send(mine.held.*rows.array, kRoot, mpi_of(*comm));
      continue;
    }
    std::vector<double>& array = snapshot.*rows.array;
    array.resize(rows.columns * share.rows);
    place(share.runs, mine.held.*rows.array, rows.columns, array);
    for (int rank = 1; rank < comm->getSize(); ++rank) {
      const auto runs = receive<RowRun>(rank, mpi_of(*comm));
      place(runs, receive<double>(rank, mpi_of(*comm)), rows.columns, array);
    }
  }
  return snapshot;
}

/// Extracts numbers of a snapshot: of the given vertices, then of the given elements.
std::vector<double> numbers_for(const std::vector<int>& vertices, const std::vector<int>& elements,
                                const StateSnapshot& snapshot, const std::vector<size_t>& interior_first) {
  std::vector<double> numbers;
  const auto add = [&numbers](const std::vector<double>& array, size_t first, size_t count) {
    numbers.insert(numbers.end(), array.begin() + static_cast<std::ptrdiff_t>(first),
                   array.begin() + static_cast<std::ptrdiff_t>(first + count));
  };
  for (const int vertex : vertices) {
    add(snapshot.vertex_displacement, 3 * static_cast<size_t>(vertex), 3);
    add(snapshot.vertex_rotation, 4 * static_cast<size_t>(vertex), 4);
  }
  for (const int element : elements) {
    add(snapshot.element_triad, 4 * static_cast<size_t>(element), 4);
    add(snapshot.interior, interior_first[element], interior_first[element + 1] - interior_first[element]);
  }
  return numbers;
}

/// Returns the numbers of this rank from the snapshot of rank 0.
std::vector<double> own_numbers(const Model& model, const StateSnapshot& snapshot) {
  const Communicator comm = model.map()->getComm();
  const std::vector<int>&vertices = model.structure().local_vertex_to_global,
        &elements = model.structure().local_element_to_mesh;
  if (comm->getRank() != kRoot) {
    send(vertices, kRoot, mpi_of(*comm));
    send(elements, kRoot, mpi_of(*comm));
    return receive<double>(kRoot, mpi_of(*comm));
  }
  const std::vector<size_t> interior_first = interior_places(model.scene(), model.mesh());
  for (int rank = 1; rank < comm->getSize(); ++rank) {
    const auto asked_vertices = receive<int>(rank, mpi_of(*comm)), asked_elements = receive<int>(rank, mpi_of(*comm));
    send(numbers_for(asked_vertices, asked_elements, snapshot, interior_first), rank, mpi_of(*comm));
  }
  return numbers_for(vertices, elements, snapshot, interior_first);
}

void require_sizes(const Model& model, const StateSnapshot& snapshot) {
  const auto vertices = static_cast<size_t>(model.mesh().vertices());
  int fits = snapshot.vertex_displacement.size() == 3 * vertices && snapshot.vertex_rotation.size() == 4 * vertices &&
             snapshot.element_triad.size() == 4 * model.mesh().elements.size() &&
             snapshot.interior.size() == interior_places(model.scene(), model.mesh()).back();
  Teuchos::broadcast(*model.map()->getComm(), kRoot, &fits);
  if (fits == 0)
    throw std::invalid_argument(
        "the state does not belong to this mesh: numbers of vertices, elements or orders differ");
}

/// Number of interior unknowns per element of the member.
size_t interior_unknowns(const Member& member) {
  const InteriorLayout layout{member.order, force_point_count(member.order, member.force_integration)};
  return static_cast<size_t>(layout.unknowns());
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
  const Mesh& mesh = model.mesh();
  share.elements.rows = mesh.elements.size();
  share.held.element_triad.reserve(4 * structure.local_element_to_mesh.size());
  share.held.interior.reserve(structure.interior_size);
  int member = 0;
  size_t of_member = 0;  // offset of its first unknown
  const auto to_next_member = [&] {
    of_member += interior_unknowns(model.scene().members[member]) * mesh.elements_of(member);
    ++member;
  };
  for (const int local : structure.elements_in_order) {
    const int element = structure.local_element_to_mesh[local];
    while (element >= mesh.first_element[member + 1]) to_next_member();
    const ElementView view(structure, state, local);
    if (!view.is_owned()) continue;
    const auto unknowns = static_cast<size_t>(view.layout().unknowns());
    share.elements.hold(element, 1);
    share.interior.hold(of_member + unknowns * (element - mesh.first_element[member]), unknowns);
    append(share.held.element_triad, view.triad_numbers(), 4);
    append(share.held.interior, view.unknowns(), unknowns);
  }
  while (member < static_cast<int>(mesh.members.size())) to_next_member();
  share.interior.rows = of_member;
}

}  // namespace

std::vector<size_t> interior_places(const Scene& scene, const Mesh& mesh) {
  std::vector<size_t> first{0};
  first.reserve(mesh.elements.size() + 1);
  for (size_t m = 0; m < scene.members.size(); ++m) {
    const size_t unknowns = interior_unknowns(scene.members[m]);
    for (int e = 0; e < mesh.elements_of(static_cast<int>(m)); ++e) first.push_back(first.back() + unknowns);
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
  StateShare mine = share_of(model, state);
  return comm->getSize() == 1 ? std::move(mine.held) : collected(comm, mine);
}

State restore(const Model& model, const StateSnapshot& snapshot) {
  require_sizes(model, snapshot);
  const Structure& structure = model.structure();
  const std::vector<double> numbers = own_numbers(model, snapshot);
  State state = allocate_state(structure);
  int in_plane = snapshot.in_plane ? 1 : 0;
  Teuchos::broadcast(*model.map()->getComm(), kRoot, &in_plane);
  state.in_plane = in_plane == 1 && model.plane().has_value();
  state.turns.assign(model.constraints().counted_angles(), 0);
  auto next = numbers.begin();
  const auto take = [&next](double* to, size_t count) {
    std::copy_n(next, count, to);
    next += static_cast<std::ptrdiff_t>(count);
  };
  for (int v = 0; v < structure.local_vertices(); ++v) {
    take(&state.views.vertex_displacement(v, 0), 3);
    take(&state.views.vertex_rotation(v, 0), 4);
  }
  for_each_element(structure, state, [&](const ElementView& element) {
    take(element.triad_numbers(), 4);
    take(element.unknowns(), static_cast<size_t>(element.layout().unknowns()));
  });
  return state;
}

State restore(const Model& model, const StateSnapshot& snapshot, double load_factor) {
  State state = restore(model, snapshot);
  if (!model.constraints().counts()) return state;
  MixedVector rows = model.create_vector();
  const EvaluationPoint point = mixed_residual(model, state, load_factor, rows);
  unscale_rows(model, point.scales, rows);
  model.constraints().count(rows.vertex(), state);
  return state;
}

}  // namespace mixbeam
