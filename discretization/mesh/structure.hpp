/// Part of a structure that one rank works on: its own vertices, every element that touches one of them, and the ghost
/// vertices at the far ends. Elements cut by the partition are evaluated on both ranks, so no matrix entries are sent.
#pragma once

#include "discretization/mesh/mesh.hpp"
#include "discretization/mesh/vertex_partition.hpp"
#include "discretization/mesh/view_pool.hpp"
#include "discretization/scene/section_law.hpp"
#include "kernels/loops/block.hpp"

#include <memory>
#include <vector>

namespace mixbeam {

/// (member): its section if it needs general elements, else null.
using MemberLaws = std::vector<std::shared_ptr<const SectionLaw>>;

/// Configuration: quaternions and additive interior unknowns. Copies share the same arrays, so a state that may be
/// shared is never written to: a new one is allocated (Model::apply).
struct State {
  StateViews views;
  /// Known to lie in the plane of the scene (Model::plane()): only its in-plane part is used.
  bool in_plane = false;
  /// (counted angle, Conditions): full turns of 4 pi that its quaternion does not show; empty if no angle is counted.
  std::vector<int> turns{};
};

/// Unused arrays of states.
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
  // connected components
  int parts = 1;
  std::vector<int> part_of_vertex;  ///< (owned vertex); empty if there is one part
  StructureViews views;
  std::vector<int> member_section;           ///< (member of the scene): index in views.sections
  std::vector<unsigned char> section_locks;  ///< (section): used by members not integrated "both reduced"
  /// (section, component of N, then of M): least compliance of its members, coupled ones and tapers at their points. A
  /// Model knows those of all ranks.
  std::vector<double> least_compliance;
  MemberLaws member_laws;         ///< (member of the scene): null if the section is plain
  double shortest_element = 0.0;  ///< of the whole mesh
  double length = 0.0;            ///< characteristic length of the whole mesh
  double bending_reference =
      0.0;  ///< largest bending or torsional stiffness of the scene that is not rigid beside the others
  size_t interior_size = 0, increment_size = 0, response_size = 0;
  std::shared_ptr<StatePool> states = std::make_shared<StatePool>();

  int local_vertices() const { return static_cast<int>(local_vertex_to_global.size()); }
  int local_elements() const { return static_cast<int>(local_element_to_mesh.size()); }
  /// Local number of a mesh element; -1 if it is not on this rank.
  int local_element(int mesh_element) const;
  /// Member of a local element in the scene.
  int member_of(const Mesh& mesh, int local_element) const {
    return mesh.elements[local_element_to_mesh[local_element]].member;
  }
  /// Block of a local element.
  const ElementBlock& block_of(int local_element) const;
};

/// Distributes elements and vertices and fills the reference data. Throws InputError that names the member for what
/// SectionLaw and make_reference_element reject, and for a general section with an integration rule other than "both
/// reduced", the only one whose force points see M exactly.
Structure build_structure(const Scene& scene, const Mesh& mesh, int rank, int ranks);

/// Undeformed, stress-free state: vertex rotations identity, element triads and relative rotations of the reference
/// elements (reference_element.hpp).
State reference_state(const Structure& structure, const Mesh& mesh);

/// Allocates a state, not initialised.
State allocate_state(const Structure& structure);

/// Allocates rows of all elements; residuals and condensed residuals share memory.
ElementEquations allocate_rows(const Structure& structure);
/// Allocates the tangents of all elements and the data to recover their interiors. `keeps_full`: 12 x 12 matrices even
/// if all are symmetric.
ElementEquations allocate_tangents(const Structure& structure, bool keeps_full);

}  // namespace mixbeam
