#include "discretization/mesh/mesh.hpp"

#include "discretization/geometry/placement.hpp"
#include "discretization/scene/division.hpp"
#include "discretization/scene/joined_ends.hpp"
#include "discretization/text/errors.hpp"
#include "discretization/text/message_text.hpp"
#include "discretization/text/number_text.hpp"

#include <optional>

namespace mixbeam {

namespace {

using namespace vector_algebra;

/// Vertex of a point, created at `position` on first use. It is followed by one vertex for each end that a joint
/// connects there, unless the end shares that of the previous one.
int find_or_add_vertex(Mesh& mesh, const JointTable& joints, const std::string& point, const Vector3& position) {
  const auto [entry, is_new] = mesh.vertex_of_point.try_emplace(point, mesh.vertices());
  if (!is_new) return entry->second;
  mesh.vertex_position.push_back(position);
  const auto joined = joints.find(point);
  if (joined == joints.end()) return entry->second;
  for (const JoinedEnd& end : joined->second) {
    if (end.shares) continue;
    mesh.joints.push_back({end.joint, end.member, entry->second, mesh.vertices()});
    mesh.vertex_position.push_back(position);
  }
  return entry->second;
}

/// Vertex of an end of a member: its own if a joint gives it one, else that of the point.
int vertex_of_end(Mesh& mesh, const JointTable& joints, const std::string& point, const Vector3& position, int member) {
  const int vertex = find_or_add_vertex(mesh, joints, point, position);
  const auto joined = joints.find(point);
  if (joined == joints.end()) return vertex;
  int slave = vertex;
  for (const JoinedEnd& end : joined->second) {
    if (!end.shares) ++slave;
    if (end.member == member) return slave;
  }
  return vertex;
}

/// Known positions of points and curves of members.
class Placement {
 public:
  explicit Placement(const Scene& scene) : scene_(scene), curves_(scene.members.size()) {
    for (const Point& point : scene.points) position_[point.name] = point.position;
    for (const std::size_t member : placement_order(scene, points_needed)) place(member);
  }

  const ReferenceCurve& curve(std::size_t member) const {
    if (curves_[member].has_value()) return *curves_[member];
    const Member& unplaced = scene_.members[member];
    const std::string& missing = position_.count(unplaced.start_point) ? unplaced.end_point : unplaced.start_point;
    throw InputError("member \"" + unplaced.name + "\": the position of its point \"" + missing + "\" is not known");
  }
  const Vector3& position(const std::string& point) const { return position_.at(point); }

 private:
  /// A parametric curve knows its ends; those of an arc or helix follow from the start.
  static std::vector<std::string> points_needed(const Member& member) {
    if (member.curve.shape == CurveShape::parametric) return {};
    if (defines_end(member.curve)) return {member.start_point};
    return {member.start_point, member.end_point};
  }

  void place(std::size_t index) {
    const Member& member = scene_.members[index];
    const ReferenceCurve& curve = curves_[index].emplace(curve_of(member));
    for (const PointOfMember& point :
         points_of_member(member, position_or_origin(member.start_point), [&] { return curve; }))
      place_point(point, member);
  }

  ReferenceCurve curve_of(const Member& member) const {
    try {
      return make_reference_curve(member, position_or_origin(member.start_point), position_or_origin(member.end_point));
    } catch (const std::invalid_argument& error) {  // extreme numbers that the reader accepts
      throw MemberError(member.name, "", error.what());
    }
  }

  /// Position of the point; the origin if unknown, which only curves that do not use it get.
  Vector3 position_or_origin(const std::string& point) const {
    const auto entry = position_.find(point);
    return entry == position_.end() ? Vector3{} : entry->second;
  }

  /// Sets the position of a point on the curve, or checks it.
  void place_point(const PointOfMember& placed, const Member& member) {
    const Vector3& known = position_.try_emplace(placed.point, placed.position).first->second;
    if (norm(difference(known, placed.position)) <= kPlaceTolerance * placed.length) return;
    throw InputError("point \"" + placed.point + "\" is at " + to_text(known) + ", but member \"" + member.name +
                     "\" passes it at " + to_text(placed.position));
  }

  const Scene& scene_;
  std::map<std::string, Vector3> position_;
  std::vector<std::optional<ReferenceCurve>> curves_;
};

/// Arc lengths of the vertices of unequal elements.
std::vector<double> stations_of(const ElementDivision& division, double length) {
  std::vector<double> s;
  if (division.is_equal) return s;
  for (const double station : division.station) s.push_back(length * station);
  s.back() = length;
  return s;
}

/// Name of the point at every vertex of a member, empty if there is none.
std::vector<std::string> vertex_points(const Member& member, const ElementDivision& division) {
  std::vector<std::string> points(division.station.size());
  points.front() = member.start_point;
  points.back() = member.end_point;
  for (std::size_t i = 0; i < member.inner_points.size(); ++i)
    points[division.inner_vertex[i]] = member.inner_points[i].point;
  return points;
}

void add_member(Mesh& mesh, const Member& member, int index, const Placement& placement, const JointTable& joints) {
  const ElementDivision division = divide(member);
  const std::vector<std::string> points = vertex_points(member, division);
  MeshMember added;
  added.curve = placement.curve(index);
  added.first_element = static_cast<int>(mesh.elements.size());
  added.elements = division.elements();
  added.stations = stations_of(division, added.curve.length);
  added.has_equal_elements = division.is_equal;
  int here = vertex_of_end(mesh, joints, member.start_point, placement.position(member.start_point), index);
  for (int i = 0; i < added.elements; ++i) {
    const std::string& point = points[i + 1];
    int next = mesh.vertices();
    if (point.empty())
      mesh.vertex_position.push_back(to_array(added.curve.position(added.vertex_arc_length(i + 1))));
    else if (i + 1 == added.elements)
      next = vertex_of_end(mesh, joints, point, placement.position(point), index);
    else
      next = find_or_add_vertex(mesh, joints, point, placement.position(point));
    mesh.elements.push_back({index, i, {here, next}});
    here = next;
  }
  mesh.first_element.push_back(static_cast<int>(mesh.elements.size()));
  mesh.member_length.push_back(added.curve.length);
  mesh.members.push_back(std::move(added));
}

}  // namespace

Mesh build_mesh(const Scene& scene) {
  Mesh mesh;
  const Placement placement(scene);
  const JointTable joints = joined_ends(scene);
  mesh.members.reserve(scene.members.size());
  for (size_t m = 0; m < scene.members.size(); ++m)
    add_member(mesh, scene.members[m], static_cast<int>(m), placement, joints);
  for (const Vector3& position : mesh.vertex_position) mesh.box.enclose(position);
  return mesh;
}

Mesh mesh_of_points(const Scene& scene) {
  Scene coarse;
  coarse.points = scene.points;
  coarse.members = scene.members;
  coarse.joints = scene.joints;
  for (Member& member : coarse.members) {
    member.elements = 1;
    member.stations.clear();
  }
  return build_mesh(coarse);
}

void Mesh::keep(std::vector<int> own_vertices, std::vector<int> own_elements) {
  std::vector<int> own_members;
  for (const int element : own_elements) {
    const int member = elements[element].member;
    if (own_members.empty() || own_members.back() != member) own_members.push_back(member);
  }
  vertex_position.keep(std::move(own_vertices));
  elements.keep(std::move(own_elements));
  members.keep(std::move(own_members));
}

double Mesh::total_length() const {
  double length = 0.0;
  for (const double of_member : member_length) length += of_member;
  return length;
}

// Same search for s among the inner vertices as std::upper_bound.
int MeshMember::element_behind(double s) const {
  int first = 1;
  for (int count = elements - 1; count > 0;) {
    const int half = count / 2;
    const bool is_before = !(s < vertex_arc_length(first + half));
    if (is_before) first += half + 1;
    count = is_before ? count - half - 1 : half;
  }
  return first - 1;
}

double arc_length_of_vertex(const Mesh& mesh, int member, int vertex) {
  const MeshMember& m = mesh.members[member];
  const auto first = mesh.elements.begin() + m.first_element;
  if (first->vertex[0] == vertex) return 0.0;
  if ((first + m.elements - 1)->vertex[1] == vertex) return m.curve.length;
  for (int i = 0; i < m.elements; ++i)
    if ((first + i)->vertex[1] == vertex) return m.vertex_arc_length(i + 1);
  throw InputError("member " + std::to_string(member + 1) + " does not pass through vertex " + std::to_string(vertex));
}

int vertex_of(const Mesh& mesh, const std::string& point) {
  const auto entry = mesh.vertex_of_point.find(point);
  if (entry != mesh.vertex_of_point.end()) return entry->second;
  std::vector<std::string> names;
  for (const auto& [name, vertex] : mesh.vertex_of_point) names.push_back(name);
  throw InputError("no member touches a point named \"" + point + "\"" + did_you_mean(point, names));
}

int member_index(const Scene& scene, const std::string& name) {
  const std::vector<Member>& members = scene.members;
  const auto entry = std::find_if(members.begin(), members.end(), [&name](const Member& m) { return m.name == name; });
  if (entry != members.end()) return static_cast<int>(entry - members.begin());
  std::vector<std::string> names;
  for (const Member& member : members) names.push_back(member.name);
  throw InputError("there is no member named \"" + name + "\"" + did_you_mean(name, names));
}

double characteristic_length(const Mesh& mesh) {
  double length = mesh.box.diagonal();
  for (const double of_member : mesh.member_length) length = std::max(length, of_member);
  return length;
}

}  // namespace mixbeam
