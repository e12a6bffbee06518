/// The frame of a scene that turns, and bodies at vertices, which it carries: theory (75). Elements in it:
/// assembly/rotating_elements.hpp.
#pragma once

#include "discretization/constraints/external_energy.hpp"

#include <algorithm>
#include <cmath>

namespace mixbeam {

/// How the frame of a scene turns.
class FrameSpin {
 public:
  /// At rest.
  FrameSpin() = default;
  FrameSpin(const Scene& scene, const std::shared_ptr<const LoadClock>& clock);

  /// Whether it turns at any load factor.
  bool turns() const { return dot(full_, full_) > 0.0; }
  const Vec& point() const { return point_; }
  /// Angular velocity at amplitude 1.
  const Vec& full() const { return full_; }
  Vec at(double load_factor) const {
    return std::copysign(std::sqrt(square(load_factor)), amplitude_(load_factor)) * full_;
  }
  /// The squared amplitude, with which centrifugal forces grow, and its derivative with respect to the load factor.
  double square(double load_factor) const { return std::max(0.0, square_(load_factor)); }
  double square_slope(double load_factor) const { return square_.slope(load_factor); }

 private:
  Vec point_{}, full_{};
  Amplitude amplitude_{}, square_{};
};

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

/// Centrifugal forces and couples on bodies at vertices; null: without a frame, or bodies.
std::unique_ptr<const ExternalEnergy> bodies_in_frame(const Scene& scene, const Mesh& mesh, const Structure& structure,
                                                      const std::shared_ptr<const LoadClock>& clock);

}  // namespace mixbeam
