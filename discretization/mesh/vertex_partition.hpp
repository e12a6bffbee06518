/// Which vertices of a mesh belong to which rank: the same answer on every rank, without a message.
#pragma once

#include "discretization/mesh/mesh.hpp"

#include <vector>

namespace mixbeam {

/// A structure with fewer independent loops is solved as chains: its vertices are shared out along the members, KLU2
/// factorises what they leave, and tangents have the cap of chains (assembly/cap.cpp). Measured for the solvers on
/// cubic lattices (5^3 vertices, 96 loops: 23 ms by KLU2, 7 to 21 ms by MUMPS with OpenBLAS and the reference BLAS) and
/// square ones (16^2, 195: 40, 41 to 54 ms).
inline constexpr double kLeastLoopsOfNetwork = 100;

/// Closed by elements and joints, of a structure in one part; several have more.
double independent_loops(const Mesh& mesh);

/// The vertices of one rank; a master and its slaves stay together. Chains are cut into contiguous shares along the
/// members, as equal in number as joints permit. Networks are cut by METIS through as few elements as it finds, in
/// parts with equal numbers of element ends.
class VertexPartition {
 public:
  VertexPartition() = default;
  VertexPartition(int rank, int ranks, const Mesh& mesh);

  /// Whether shares are contiguous, on every rank.
  bool is_contiguous() const { return is_contiguous_; }
  int size() const { return is_contiguous_ ? end_ - first_ : static_cast<int>(vertices_.size()); }
  /// Global number of the vertex at a place, ascending with it.
  int vertex(int place) const { return is_contiguous_ ? first_ + place : vertices_[place]; }
  /// Place of a vertex among those of this rank, -1 where another rank owns it.
  int place(int vertex) const;
  bool owns(int vertex) const { return place(vertex) >= 0; }

 private:
  bool is_contiguous_ = true;
  int first_ = 0, end_ = 0;    ///< contiguous share
  std::vector<int> vertices_;  ///< or else those of a part of the graph, ascending
};

/// Number of the part to which each vertex belongs, from zero without gaps: members and joints connect vertices.
std::vector<int> connected_parts(const Mesh& mesh, const std::vector<MeshJoint>& joints);
inline std::vector<int> connected_parts(const Mesh& mesh) { return connected_parts(mesh, mesh.joints); }

}  // namespace mixbeam
