/// Positions and rotations of the vertices of a deformed structure, for comparison with exact solutions.
#pragma once

#include "kernels/math/rotation.hpp"
#include "nonlinear/run/simulation.hpp"

#include <cmath>
#include <vector>

namespace mixbeam {

struct VertexPlace {
  Vec3<double> position{};
  Quaternion<double> rotation = identity_quaternion<double>();  ///< from the undeformed state
};

inline Vec3<double> to_vec(const Vector3& v) { return {{v[0], v[1], v[2]}}; }

/// Position and rotation of a vertex of this rank's mesh.
inline VertexPlace place_of(const Simulation& simulation, int vertex) {
  const auto motion = vertex_motion(simulation.model(), simulation.state(), vertex);
  return {to_vec(reference_position(simulation.model(), vertex)) + Vec3<double>{{motion[0], motion[1], motion[2]}},
          exp_quaternion(Vec3<double>{{motion[3], motion[4], motion[5]}})};
}

/// Positions and rotations of all vertices of this rank's mesh.
inline std::vector<VertexPlace> vertex_places(const Simulation& simulation) {
  std::vector<VertexPlace> places;
  for (int vertex = 0; vertex < simulation.model().mesh().vertices(); ++vertex)
    places.push_back(place_of(simulation, vertex));
  return places;
}

/// Norm without overflow or underflow of the squares.
inline double length_of(const Vec3<double>& v) { return std::hypot(v[0], v[1], v[2]); }
/// Angle of a rotation, in radians.
inline double angle_of(const Quaternion<double>& rotation) { return length_of(log_quaternion(rotation)); }

}  // namespace mixbeam
