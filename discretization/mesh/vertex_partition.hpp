/// Distribution of the vertices of a mesh over ranks: computed identically on every rank, without a message.
#pragma once

#include "discretization/mesh/mesh.hpp"

#include <vector>

namespace mixbeam {

/// A structure with fewer independent loops is solved as chains: its vertices are distributed along the members, KLU2
/// factorises the remaining matrix, and tangents have the cap of chains (assembly/cap.cpp). Measured for the solvers on
/// cubic lattices (5^3 vertices, 96 loops: 23 ms by KLU2, 7 to 21 ms by MUMPS with OpenBLAS and the reference BLAS) and
/// square ones (16^2, 195: 40, 41 to 54 ms).
inline constexpr double kLeastLoopsOfNetwork = 100;

/// Loops closed by elements and joints, for a structure in one part; several parts have more.
double independent_loops(const Mesh& mesh);

/// Vertices of one rank; a master and its slaves stay together. Chains are cut into contiguous shares along the
/// members, as equal in number as joints permit. Networks are cut by METIS through as few elements as possible, into
/// parts with equal numbers of element ends.
class VertexPartition {
 public:
  VertexPartition() = default;
  VertexPartition(int rank, int ranks, const Mesh& mesh);

  /// True if shares are contiguous, on every rank.
  bool is_contiguous() const { return is_contiguous_; }
  int size() const { return is_contiguous_ ? end_ - first_ : static_cast<int>(vertices_.size()); }
  /// Global number of the vertex at a place, in ascending order.
  int vertex(int place) const { return is_contiguous_ ? first_ + place : vertices_[place]; }
  /// Place of a vertex among those of this rank, -1 if another rank owns it.
  int place(int vertex) const;
  bool owns(int vertex) const { return place(vertex) >= 0; }

 private:
  bool is_contiguous_ = true;
  int first_ = 0, end_ = 0;    ///< contiguous share
  std::vector<int> vertices_;  ///< otherwise: those of a part of the graph, ascending
};

/// Part of each vertex, numbered from zero without gaps: members and joints connect vertices.
std::vector<int> connected_parts(const Mesh& mesh, const std::vector<MeshJoint>& joints);
inline std::vector<int> connected_parts(const Mesh& mesh) { return connected_parts(mesh, mesh.joints); }

}  // namespace mixbeam
