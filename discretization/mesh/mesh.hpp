/// Elements and vertices of a scene: pure topology and reference geometry, the same on every rank.
#pragma once

#include "discretization/geometry/reference_curve.hpp"
#include "discretization/scene/scene.hpp"

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
  int first_element = 0;                  ///< in Mesh::elements, consecutive
  int elements = 0;                       ///< may exceed what the scene asks for, see divide (scene/division.hpp)
  std::vector<double> vertex_arc_length;  ///< s of its vertices, elements + 1 of them from 0 to the curve's length
  bool has_equal_elements = true;         ///< then lengths come from one division and do not differ by rounding

  /// Reference length of its element `index`.
  double element_length(int index) const {
    return has_equal_elements ? curve.length / elements : vertex_arc_length[index + 1] - vertex_arc_length[index];
  }
  /// Arc length s along the member at xi in [-1, 1] of its element `index`.
  double arc_length(int index, double xi) const {
    const double inside = 0.5 * (1.0 + xi);
    return has_equal_elements ? element_length(index) * (index + inside)
                              : vertex_arc_length[index] + element_length(index) * inside;
  }
};

/// One joined end of a member, or several that stay together: a vertex of its own, the slave.
struct MeshJoint {
  int joint = 0;   ///< in Scene::joints
  int member = 0;  ///< whose end it is; the first of several
  int master = 0;  ///< vertex of the point
  int slave = 0;
};

/// Vertices are numbered along the members, so a chain has a narrow band.
struct Mesh {
  std::vector<Vector3> vertex_position;  ///< reference positions
  std::vector<MeshElement> elements;     ///< member by member
  std::vector<MeshMember> members;       ///< in the order of the scene
  std::map<std::string, int> vertex_of_point;
  std::vector<MeshJoint> joints;  ///< in the order of their slaves, which follow the vertex of their point

  int vertices() const { return static_cast<int>(vertex_position.size()); }
  const MeshMember& member_of(const MeshElement& element) const { return members[element.member]; }
  double element_length(const MeshElement& element) const { return member_of(element).element_length(element.index); }
  /// Arc length along its member at xi in [-1, 1] of an element.
  double arc_length(const MeshElement& element, double xi) const {
    return member_of(element).arc_length(element.index, xi);
  }
};

/// Divides every member into elements, see divide (scene/division.hpp). Inner points become vertices. Ends of arcs,
/// helices and parametric curves and inner points may be absent from the points of the scene: they follow from their
/// curve. Throws std::invalid_argument for a degenerate curve or division, InputError for a point whose position is not
/// known or is not where the curve passes, and std::invalid_argument for a joint that joins nothing.
Mesh build_mesh(const Scene& scene);

/// Vertex of a named point; throws InputError with the nearest name when no member touches it.
int vertex_of(const Mesh& mesh, const std::string& point);

/// Arc length of a vertex along one of its members; 0 where a closed member begins and ends. Throws InputError when the
/// member does not pass through the vertex.
double arc_length_of_vertex(const Mesh& mesh, int member, int vertex);

/// Index of a member by name; throws InputError with the nearest name.
int member_index(const Scene& scene, const std::string& name);

/// Characteristic length of the structure: the total length of its longest member or the diagonal of its bounding
/// box, whichever is larger.
double characteristic_length(const Mesh& mesh);

}  // namespace mixbeam
