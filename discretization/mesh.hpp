/// Elements and vertices of a scene: pure topology and reference geometry, the same on every rank.
#pragma once

#include "discretization/reference_curve.hpp"
#include "discretization/scene.hpp"

#include <map>
#include <string>
#include <vector>

namespace mixbeam {

struct MeshElement {
  int member = 0;
  int index = 0;           ///< position in its member, counted from the start
  int vertex[2] = {0, 0};  ///< global vertices at its start and end
};

/// One member in the mesh: its curve and where its elements and vertices are.
struct MeshMember {
  ReferenceCurve curve;
  int first_element = 0;  ///< in Mesh::elements, consecutive
  int elements = 0;
  double element_length() const { return curve.length / elements; }
};

/// Vertices are numbered along the members, so a chain has a narrow band.
struct Mesh {
  std::vector<Vector3> vertex_position;  ///< reference positions
  std::vector<MeshElement> elements;     ///< member by member
  std::vector<MeshMember> members;       ///< in the order of the scene
  std::map<std::string, int> vertex_of_point;

  int vertices() const { return static_cast<int>(vertex_position.size()); }
};

/// Divides every member into elements of equal length. Throws std::invalid_argument for a degenerate curve.
Mesh build_mesh(const Scene& scene);

/// Vertex of a named point; throws InputError with the nearest name when no member touches it.
int vertex_of(const Mesh& mesh, const std::string& point);

/// Index of a member by name; throws InputError with the nearest name.
int member_index(const Scene& scene, const std::string& name);

/// A length that stands for the whole structure: the total length of its longest member or the diagonal of its bounding
/// box, whichever is larger.
double characteristic_length(const Mesh& mesh);

}  // namespace mixbeam
