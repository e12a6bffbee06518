/// The part of a structure that one rank works on: its own vertices, every element that touches one of them, and the
/// ghost vertices at the far ends. Elements cut by the partition are evaluated on both ranks, so no matrix entry
/// travels.
#pragma once

#include "discretization/mesh/mesh.hpp"
#include "discretization/mesh/vertex_partition.hpp"
#include "discretization/mesh/view_pool.hpp"
#include "discretization/scene/section_law.hpp"
#include "kernels/loops/block.hpp"

#include <memory>
#include <vector>

namespace mixbeam {

/// (member): the section of those that need general elements, null for all others.
using MemberLaws = std::vector<std::shared_ptr<const SectionLaw>>;

/// A configuration: quaternions and additive interior unknowns. Copies share the same numbers, so a state that others
/// may hold is never written to: a new one is allocated (Model::apply).
struct State {
  StateViews views;
  /// Known to lie in the plane of the scene (Model::plane()): only its in-plane part is used.
  bool in_plane = false;
  /// (counted angle, Conditions): full turns of its quaternion, 4 pi each, that are not seen in it; empty where no
  /// angle is counted.
  std::vector<int> turns{};
};

/// Arrays of states that are not in use.
struct StatePool {
  ViewPool<KernelView<double* [3]>> vertex_displacement;
  ViewPool<KernelView<double*[4]>> vertex_rotation, element_triad;
  ViewPool<KernelView<double*>> interior;
};

struct Structure {
  VertexPartition partition;
  std::vector<int> local_vertex_to_global;  ///< owned vertices first, then ghosts in ascending order
  int owned_vertices = 0;
  std::vector<ElementBlock> blocks;
  std::vector<int> local_element_to_mesh;  ///< mesh element of each local element
  std::vector<int> elements_in_order;      ///< local elements in the order of the mesh
  int mesh_elements = 0;                   ///< of all ranks
  // Parts of the whole that do not touch each other.
  int parts = 1;
  std::vector<int> part_of_vertex;  ///< (owned vertex); empty where there is one part
  StructureViews views;
  std::vector<int> member_section;           ///< (member of the scene): among views.sections
  std::vector<unsigned char> section_locks;  ///< (section): of members that are not integrated "both reduced"
  MemberLaws member_laws;                    ///< (member of the scene): null where the section is plain
  double shortest_element = 0.0;             ///< of the whole mesh
  double length = 0.0;                       ///< characteristic length of the whole mesh
  double bending_reference =
      0.0;  ///< largest bending or torsional stiffness of the scene that is not rigid beside the others
  size_t interior_size = 0, increment_size = 0, response_size = 0;
  std::shared_ptr<StatePool> states = std::make_shared<StatePool>();

  int local_vertices() const { return static_cast<int>(local_vertex_to_global.size()); }
  int local_elements() const { return static_cast<int>(local_element_to_mesh.size()); }
  /// -1 where an element of the mesh is not on this rank.
  int local_element(int mesh_element) const;
  /// In the scene, of a local element.
  int member_of(const Mesh& mesh, int local_element) const {
    return mesh.elements[local_element_to_mesh[local_element]].member;
  }
  /// Block of a local element.
  const ElementBlock& block_of(int local_element) const;
};

/// Distributes elements and vertices and fills the reference data. Throws InputError that names the member for what
/// SectionLaw and make_reference_element reject, and where a general section meets another integration rule than "both
/// reduced", the only one whose force points see M exactly.
Structure build_structure(const Scene& scene, const Mesh& mesh, int rank, int ranks);

/// Undeformed state: vertex rotations identity, element triads and relative rotations of the reference elements
/// (reference_element.hpp), stress free.
State reference_state(const Structure& structure, const Mesh& mesh);

/// Room for a state, not initialised.
State allocate_state(const Structure& structure);

/// Arrays for rows of all elements, of residuals or condensed ones: they share their numbers.
ElementEquations allocate_rows(const Structure& structure);
/// Arrays for the tangents of all elements and the recovery of their interiors. `keeps_full`: matrices of 12 rows even
/// where all are symmetric.
ElementEquations allocate_tangents(const Structure& structure, bool keeps_full);

}  // namespace mixbeam
