/// Bodies at the vertices of one rank.
#pragma once

#include "discretization/mesh/structure.hpp"

#include <vector>

namespace mixbeam {

/// A body at an owned local vertex.
struct VertexBody {
  int vertex = 0;
  Vec mass{}, inertia{};  ///< along and about its axes
  Mat axes{};             ///< rows: its axes in the undeformed structure
  int number = 0;         ///< in Scene::point_masses

  /// Its axes as they are turned with the vertex, as rows.
  Mat turned_axes(const State& state) const {
    return times_transpose(axes, rotation_matrix(load_quaternion(&state.views.vertex_rotation(vertex, 0))));
  }
};

/// All bodies of a scene at vertices of this rank.
std::vector<VertexBody> vertex_bodies(const Scene& scene, const Mesh& mesh, const Structure& structure);

}  // namespace mixbeam
