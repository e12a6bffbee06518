/// Elements and vertices of a scene: topology and reference geometry. On several ranks each keeps those that it works
/// on, under their global numbers.
#pragma once

#include "discretization/geometry/reference_curve.hpp"
#include "discretization/scene/scene.hpp"
#include "kernels/math/vector_algebra.hpp"

#include <algorithm>
#include <cstddef>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace mixbeam {

/// List, or the entries of it that a rank keeps, under the numbers of the whole list.
template <class Entry>
class Share {
 public:
  std::size_t size() const { return is_whole() ? entries_.size() : whole_size_; }  ///< of the whole list
  bool is_whole() const { return whole_size_ == 0; }
  std::size_t kept() const { return entries_.size(); }

  /// Index of an entry among the kept ones, in ascending order of their numbers; -1 if not kept.
  int place(std::size_t number) const {
    if (is_whole()) return static_cast<int>(number);
    const auto found = std::lower_bound(numbers_.begin(), numbers_.end(), static_cast<int>(number));
    const bool is_kept = found != numbers_.end() && *found == static_cast<int>(number);
    return is_kept ? static_cast<int>(found - numbers_.begin()) : -1;
  }
  bool keeps(std::size_t number) const { return place(number) >= 0; }
  /// Throws std::out_of_range if the entry is not kept.
  const Entry& operator[](std::size_t number) const {
    return is_whole() ? entries_[number] : entries_.at(static_cast<std::size_t>(place(number)));
  }

  /// All entries. Throws std::logic_error unless all are kept.
  const std::vector<Entry>& whole() const {
    if (!is_whole()) throw std::logic_error("a rank was asked for a list of which it keeps a share");
    return entries_;
  }
  auto begin() const { return whole().begin(); }
  auto end() const { return whole().end(); }
  void push_back(Entry entry) { entries_.push_back(std::move(entry)); }
  void reserve(std::size_t count) { entries_.reserve(count); }

  /// Frees all other entries; `numbers` ascend.
  void keep(std::vector<int> numbers) {
    std::vector<Entry> kept;
    kept.reserve(numbers.size());
    for (const int number : numbers) kept.push_back(std::move(entries_[static_cast<std::size_t>(number)]));
    whole_size_ = entries_.size();
    entries_ = std::move(kept);
    numbers_ = std::move(numbers);
  }

 private:
  std::vector<Entry> entries_;
  std::vector<int> numbers_;    ///< of the kept entries; empty if all are kept
  std::size_t whole_size_ = 0;  ///< 0: all are kept
};

struct MeshElement {
  int member = 0;
  int index = 0;           ///< position in its member, counted from the start
  int vertex[2] = {0, 0};  ///< global vertices at its start and end
};

/// Member in the mesh: its curve, elements and vertices.
struct MeshMember {
  ReferenceCurve curve;
  int first_element = 0;           ///< in Mesh::elements, consecutive
  int elements = 0;                ///< may exceed the number in the scene, see divide (scene/division.hpp)
  std::vector<double> stations;    ///< s of its vertices, elements + 1 of them; empty if elements are equal
  bool has_equal_elements = true;  ///< if so, all lengths come from one division and do not differ by rounding

  /// s of its vertices, from 0 to the curve's length at vertex `elements`.
  double vertex_arc_length(int vertex) const {
    if (!has_equal_elements) return stations[vertex];
    return vertex == elements ? curve.length : curve.length * vertex / elements;
  }
  /// Element behind the last vertex that is not beyond s; the first or last one if s is outside of the member.
  int element_behind(double s) const;
  /// Reference length of its element `index`.
  double element_length(int index) const {
    return has_equal_elements ? curve.length / elements : stations[index + 1] - stations[index];
  }
  /// Arc length s along the member at xi in [-1, 1] of its element `index`.
  double arc_length(int index, double xi) const {
    const double inside = 0.5 * (1.0 + xi);
    return has_equal_elements ? element_length(index) * (index + inside)
                              : stations[index] + element_length(index) * inside;
  }
};

/// Joined end of a member, or several that stay together: has a vertex of its own, the slave.
struct MeshJoint {
  int joint = 0;   ///< in Scene::joints
  int member = 0;  ///< member that ends there; the first of several
  int master = 0;  ///< vertex of the point
  int slave = 0;
};

/// Vertices are numbered along the members, so a chain has a narrow band.
struct Mesh {
  Share<Vector3> vertex_position;  ///< reference positions
  Share<MeshElement> elements;     ///< member by member
  Share<MeshMember> members;       ///< in the order of the scene
  // Known on every rank:
  std::vector<int> first_element{0};  ///< (member, and one more): in elements
  std::vector<double> member_length;  ///< (member)
  std::map<std::string, int> vertex_of_point;
  std::vector<MeshJoint> joints;  ///< in the order of their slaves, which follow the vertex of their point
  vector_algebra::Box box;        ///< of all vertices

  /// Frees all but these vertices and elements (ascending numbers), and the members without any of them.
  void keep(std::vector<int> own_vertices, std::vector<int> own_elements);

  int vertices() const { return static_cast<int>(vertex_position.size()); }
  int elements_of(int member) const { return first_element[member + 1] - first_element[member]; }
  /// Member of an element, which need not be kept; index_of_element: its position in the member.
  int member_of_element(int number) const {
    return static_cast<int>(std::upper_bound(first_element.begin(), first_element.end(), number) -
                            first_element.begin()) -
           1;
  }
  int index_of_element(int number) const { return number - first_element[member_of_element(number)]; }
  /// Sum of the lengths of all members.
  double total_length() const;
  const MeshMember& member_of(const MeshElement& element) const { return members[element.member]; }
  double element_length(const MeshElement& element) const { return member_of(element).element_length(element.index); }
  /// Arc length along its member at xi in [-1, 1] of an element.
  double arc_length(const MeshElement& element, double xi) const {
    return member_of(element).arc_length(element.index, xi);
  }
};

/// Divides every member into elements, see divide (scene/division.hpp). Inner points become vertices. Ends of arcs,
/// helices and parametric curves and inner points may be missing from the points of the scene: they follow from their
/// curve. Throws std::invalid_argument for a degenerate curve or division or a joint that joins nothing, and InputError
/// for a point whose position is unknown or off the curve.
Mesh build_mesh(const Scene& scene);

/// Mesh with one element between neighbouring points of a member: its vertices are the points and the joined ends.
/// Throws like build_mesh().
Mesh mesh_of_points(const Scene& scene);

/// Vertex of a named point; throws InputError with the nearest name if no member touches it.
int vertex_of(const Mesh& mesh, const std::string& point);

/// Arc length of a vertex along one of its members; 0 where a closed member begins and ends. Throws InputError if the
/// member does not pass through the vertex.
double arc_length_of_vertex(const Mesh& mesh, int member, int vertex);

/// Index of a member by name; throws InputError with the nearest name.
int member_index(const Scene& scene, const std::string& name);

/// Characteristic length of the structure: the length of its longest member or the diagonal of its bounding box,
/// whichever is larger.
double characteristic_length(const Mesh& mesh);

}  // namespace mixbeam
