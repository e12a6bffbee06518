#include "nonlinear/accuracy/richer_scene.hpp"

#include "kernels/element/layout.hpp"

namespace mixbeam {

namespace {

void halve_elements(const MeshMember& mesh, Member& member) {
  member.elements = 2 * mesh.elements;
  if (mesh.has_equal_elements && member.inner_points.empty() && member.stations.empty()) return;
  member.stations.assign(1, 0.0);
  for (int i = 0; i < mesh.elements; ++i) {
    member.stations.push_back(mesh.arc_length(i, 0.0) / mesh.curve.length);
    member.stations.push_back(mesh.vertex_arc_length[i + 1] / mesh.curve.length);
  }
  member.stations.back() = 1.0;
}

}  // namespace

RicherScene richer_scene(const Scene& scene, const Mesh& mesh) {
  RicherScene richer{scene, std::vector<unsigned char>(scene.members.size(), 0)};
  for (size_t m = 0; m < scene.members.size(); ++m) {
    Member& member = richer.scene.members[m];
    richer.is_halved[m] = member.order == kMaximumOrder;
    if (richer.is_halved[m])
      halve_elements(mesh.members[m], member);
    else
      ++member.order;
  }
  return richer;
}

}  // namespace mixbeam
