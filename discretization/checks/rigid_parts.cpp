#include "discretization/checks/rigid_parts.hpp"

#include "discretization/mesh/mesh.hpp"
#include "discretization/text/member_error.hpp"
#include "kernels/math/vector_algebra.hpp"

#include <algorithm>
#include <numeric>
#include <tuple>
#include <utility>

namespace mixbeam {
namespace {

using namespace vector_algebra;

/// Sets that grow together (union-find with path halving).
class Groups {
 public:
  explicit Groups(int count) : parent_(static_cast<std::size_t>(count)) {
    std::iota(parent_.begin(), parent_.end(), 0);
  }
  int group_of(int i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(int i, int j) { parent_[group_of(i)] = group_of(j); }

 private:
  std::vector<int> parent_;
};

/// One element between neighbouring points of a member: the vertices are the points, and the ends with a joint.
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

/// Name of the point of each vertex.
std::vector<std::string> names_of_vertices(const Mesh& mesh) {
  std::vector<std::string> names(static_cast<std::size_t>(mesh.vertices()));
  for (const auto& [name, vertex] : mesh.vertex_of_point) names[vertex] = name;
  for (const MeshJoint& joint : mesh.joints) names[joint.slave] = names[joint.master];
  return names;
}

void measure(RigidPart& part) {
  for (const Vector3& position : part.positions) part.center = sum(part.center, position);
  part.center = scaled(1.0 / static_cast<double>(part.positions.size()), part.center);
  for (const Vector3& position : part.positions)
    part.size = std::max(part.size, norm(difference(position, part.center)));
}

}  // namespace

std::vector<RigidAssembly> rigid_assemblies(const Scene& scene) try {
  const Mesh mesh = mesh_of_points(scene);
  const std::vector<std::string> names = names_of_vertices(mesh);
  Groups parts(mesh.vertices());
  for (const MeshElement& element : mesh.elements) parts.join(element.vertex[0], element.vertex[1]);
  Groups together = parts;
  for (const MeshJoint& joint : mesh.joints) together.join(joint.slave, joint.master);

  struct Place {
    int assembly = -1, part = -1;
  };
  std::vector<RigidAssembly> all;
  std::vector<Place> place_of(names.size());  // (group of parts)
  std::vector<int> assembly_of(names.size(), -1);
  std::vector<unsigned char> is_seen(names.size(), 0);
  const auto part_at = [&](int vertex) -> RigidPart& {
    Place& place = place_of[parts.group_of(vertex)];
    if (place.part < 0) {
      int& assembly = assembly_of[together.group_of(vertex)];
      if (assembly < 0) {
        assembly = static_cast<int>(all.size());
        all.emplace_back();
      }
      place = {assembly, static_cast<int>(all[assembly].parts.size())};
      all[assembly].parts.emplace_back();
    }
    return all[place.assembly].parts[place.part];
  };
  for (std::size_t m = 0; m < scene.members.size(); ++m) {
    const MeshMember& member = mesh.members[m];
    RigidPart& part = part_at(mesh.elements[member.first_element].vertex[0]);
    part.members.push_back(m);
    for (int e = 0; e < member.elements; ++e)
      for (const int vertex : mesh.elements[member.first_element + e].vertex) {
        if (std::exchange(is_seen[vertex], 1) != 0) continue;
        part.points.push_back(names[vertex]);
        part.positions.push_back(mesh.vertex_position[vertex]);
      }
  }
  for (std::size_t i = 0; i < scene.supports.size(); ++i) {
    const auto found = mesh.vertex_of_point.find(scene.supports[i].point);
    if (found != mesh.vertex_of_point.end()) part_at(found->second).supports.push_back(i);
  }
  std::vector<MeshJoint> joints = mesh.joints;
  std::sort(joints.begin(), joints.end(), [&names](const MeshJoint& a, const MeshJoint& b) {
    return std::tie(names[a.slave], a.member) < std::tie(names[b.slave], b.member);
  });
  for (const MeshJoint& joint : joints) {
    const Place master = place_of[parts.group_of(joint.master)], slave = place_of[parts.group_of(joint.slave)];
    all[slave.assembly].links.push_back({static_cast<std::size_t>(master.part), static_cast<std::size_t>(slave.part),
                                         static_cast<std::size_t>(joint.joint), mesh.vertex_position[joint.slave]});
  }
  for (RigidAssembly& assembly : all)
    for (RigidPart& part : assembly.parts) {
      measure(part);
      for (const std::size_t m : part.members)  // a closed ring has one point only
        if (scene.members[m].start_point == scene.members[m].end_point)
          part.size = std::max(part.size, mesh.members[m].curve.length);
    }
  return all;
} catch (const MemberError&) {  // numbers too extreme for a curve: said where the elements are made
  return {};
}

}  // namespace mixbeam
