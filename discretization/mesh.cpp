#include "discretization/mesh.hpp"

#include "discretization/errors.hpp"
#include "discretization/nearest_name.hpp"

#include <algorithm>
#include <cmath>

namespace mixbeam {

namespace {

/// Vertex of a point, created at `position` when the point is met for the first time.
int find_or_add_vertex(Mesh& mesh, const std::string& point, const Vector3& position) {
  const auto [entry, is_new] = mesh.vertex_of_point.try_emplace(point, mesh.vertices());
  if (is_new) mesh.vertex_position.push_back(position);
  return entry->second;
}

Vector3 to_array(const Vec3<double>& v) { return {v[0], v[1], v[2]}; }

void add_member(Mesh& mesh, const Member& member, int index, const Vector3& start, const Vector3& end) {
  MeshMember added;
  added.curve = make_reference_curve(member, start, end);
  added.first_element = static_cast<int>(mesh.elements.size());
  added.elements = member.elements;
  int here = find_or_add_vertex(mesh, member.start_point, start);
  for (int i = 0; i < member.elements; ++i) {
    const double s = added.curve.length * (i + 1) / member.elements;
    int next;
    if (i + 1 == member.elements) {
      next = find_or_add_vertex(mesh, member.end_point, end);
    } else {
      next = mesh.vertices();
      mesh.vertex_position.push_back(to_array(added.curve.position(s)));
    }
    mesh.elements.push_back({index, i, {here, next}});
    here = next;
  }
  mesh.members.push_back(added);
}

std::map<std::string, Vector3> point_positions(const Scene& scene) {
  std::map<std::string, Vector3> position;
  for (const Point& point : scene.points) position[point.name] = point.position;
  // ends of arcs and helices may follow from their curve, in whatever order the members come
  bool found = true;
  while (found) {
    found = false;
    for (const Member& member : scene.members) {
      if (member.curve.shape == CurveShape::line || position.count(member.end_point) ||
          !position.count(member.start_point))
        continue;
      position[member.end_point] = end_position(member, position.at(member.start_point));
      found = true;
    }
  }
  return position;
}

}  // namespace

Mesh build_mesh(const Scene& scene) {
  Mesh mesh;
  const std::map<std::string, Vector3> position = point_positions(scene);
  const auto place = [&](const Member& member, const std::string& point) {
    const auto entry = position.find(point);
    if (entry == position.end())
      throw InputError("member \"" + member.name + "\": the position of its point \"" + point + "\" is not known");
    return entry->second;
  };
  for (size_t m = 0; m < scene.members.size(); ++m) {
    const Member& member = scene.members[m];
    add_member(mesh, member, static_cast<int>(m), place(member, member.start_point), place(member, member.end_point));
  }
  return mesh;
}

int vertex_of(const Mesh& mesh, const std::string& point) {
  const auto entry = mesh.vertex_of_point.find(point);
  if (entry != mesh.vertex_of_point.end()) return entry->second;
  std::vector<std::string> names;
  for (const auto& [name, vertex] : mesh.vertex_of_point) names.push_back(name);
  throw InputError("no member touches a point named \"" + point + "\"; did you mean \"" + nearest_name(point, names) +
                   "\"?");
}

int member_index(const Scene& scene, const std::string& name) {
  std::vector<std::string> names;
  for (const Member& member : scene.members) names.push_back(member.name);
  const auto entry = std::find(names.begin(), names.end(), name);
  if (entry != names.end()) return static_cast<int>(entry - names.begin());
  throw InputError("there is no member named \"" + name + "\"; did you mean \"" + nearest_name(name, names) + "\"?");
}

double characteristic_length(const Mesh& mesh) {
  Vector3 low = mesh.vertex_position.front(), high = low;
  for (const Vector3& p : mesh.vertex_position)
    for (int i = 0; i < 3; ++i) {
      low[i] = std::min(low[i], p[i]);
      high[i] = std::max(high[i], p[i]);
    }
  double length = std::hypot(high[0] - low[0], high[1] - low[1], high[2] - low[2]);
  for (const MeshMember& member : mesh.members) length = std::max(length, member.curve.length);
  return length;
}

}  // namespace mixbeam
