#include "discretization/conditions.hpp"

#include "kernels/element_kinematics.hpp"

#include <algorithm>
#include <cmath>

namespace mixbeam {

namespace {

Vec to_vec(const Vector3& v) { return {{v[0], v[1], v[2]}}; }

/// Reference triad of a member at the vertex where a follower load acts.
Quat reference_triad_at(const Mesh& mesh, int member, int vertex) {
  return mesh.members[member].curve.triad(arc_length_of_vertex(mesh, member, vertex));
}

VertexLoad vertex_load(const PointLoad& load, const Scene& scene, const Mesh& mesh, int global, int local) {
  VertexLoad result;
  result.vertex = local;
  result.frame = load.frame;
  result.stage = load.stage;
  result.force = to_vec(load.force);
  result.moment = to_vec(load.moment);
  if (load.frame == LoadFrame::follower) {
    const Mat triad = rotation_matrix(reference_triad_at(mesh, member_index(scene, load.member), global));
    result.force = triad * result.force;
    result.moment = triad * result.moment;
  }
  return result;
}

VertexSupport vertex_support(const Support& support, int local) {
  VertexSupport result;
  result.vertex = local;
  result.stage = support.stage;
  result.displacement = to_vec(support.prescribed_displacement);
  result.rotation = to_vec(support.prescribed_rotation);
  result.rotation_prescribed = true;
  for (int i = 0; i < 3; ++i) {
    result.fixed[i] = support.displacement_fixed[i];
    result.fixed[3 + i] = support.rotation_fixed[i];
    result.rotation_prescribed = result.rotation_prescribed && support.rotation_fixed[i];
  }
  return result;
}

}  // namespace

Conditions build_conditions(const Scene& scene, const Mesh& mesh, const Structure& structure) {
  Conditions conditions;
  const VertexPartition& partition = structure.partition;
  for (const PointLoad& load : scene.point_loads) {
    const int global = vertex_of(mesh, load.point);
    if (partition.owns(global))
      conditions.loads.push_back(vertex_load(load, scene, mesh, global, global - partition.owned_first()));
  }
  for (size_t i = 0; i < scene.supports.size(); ++i) {
    const int global = vertex_of(mesh, scene.supports[i].point);
    if (!partition.owns(global)) continue;
    conditions.supports.push_back(vertex_support(scene.supports[i], global - partition.owned_first()));
    conditions.supports.back().index = static_cast<int>(i);
  }
  for (const DistributedLoad& load : scene.distributed_loads)
    conditions.line_loads.push_back({member_index(scene, load.member), load.force, load.couple, load.stage});
  return conditions;
}

SpatialLoad spatial_load(const VertexLoad& load, double amplitude, const State& state) {
  SpatialLoad spatial{amplitude * load.force, amplitude * load.moment};
  if (load.frame == LoadFrame::follower) {
    const Mat turn = rotation_matrix(load_quaternion(&state.views.vertex_rotation(load.vertex, 0)));
    spatial = {turn * spatial.force, turn * spatial.moment};
  }
  return spatial;
}

double largest_prescribed_rotation(const Scene& scene) {
  double largest = 0.0;
  for (const Support& s : scene.supports) largest = std::max(largest, norm(to_vec(s.prescribed_rotation)));
  return largest;
}

void set_line_loads(const Conditions& conditions, double load_factor, bool slope, const StructureViews& views) {
  if (views.member_load.extent(0) == 0) return;
  Kokkos::deep_copy(views.member_load, LineLoad{});
  for (const MemberLoad& load : conditions.line_loads) {
    const double amplitude =
        slope ? stage_amplitude_slope(load_factor, load.stage) : stage_amplitude(load_factor, load.stage);
    for (int i = 0; i < 3; ++i) {
      views.member_load(load.member).force[i] += amplitude * load.force[i];
      views.member_load(load.member).couple[i] += amplitude * load.couple[i];
    }
  }
}

}  // namespace mixbeam
