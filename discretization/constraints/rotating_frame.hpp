/// Rotating frame of a scene, with bodies at vertices and elements with mass in it; theory (75).
#pragma once

#include "discretization/constraints/external_energy.hpp"
#include "kernels/vibration/vibration.hpp"

#include <algorithm>
#include <cmath>

namespace mixbeam {

/// Rotation of the frame of a scene.
class FrameSpin {
 public:
  /// At rest.
  FrameSpin() = default;
  FrameSpin(const Scene& scene, const std::shared_ptr<const LoadClock>& clock);

  /// True if it rotates at any load factor.
  bool turns() const { return dot(full_, full_) > 0.0; }
  const Vec& point() const { return point_; }
  /// Angular velocity at amplitude 1.
  const Vec& full() const { return full_; }
  Vec at(double load_factor) const {
    return std::copysign(std::sqrt(square(load_factor)), amplitude_(load_factor)) * full_;
  }
  /// Squared amplitude, which scales centrifugal forces, and its derivative with respect to the load factor.
  double square(double load_factor) const { return std::max(0.0, square_(load_factor)); }
  double square_slope(double load_factor) const { return square_.slope(load_factor); }

 private:
  Vec point_{}, full_{};
  Amplitude amplitude_{}, square_{};
};

/// Body at an owned local vertex.
struct VertexBody {
  int vertex = 0;
  Vec mass{}, inertia{};  ///< along and about its axes
  Mat axes{};             ///< rows: its axes in the undeformed structure
  int number = 0;         ///< in Scene::point_masses

  /// Current axes, rotated with the vertex, as rows.
  Mat turned_axes(const State& state) const {
    return times_transpose(axes, rotation_matrix(load_quaternion(&state.views.vertex_rotation(vertex, 0))));
  }
};

/// All bodies of a scene at vertices of this rank.
std::vector<VertexBody> vertex_bodies(const Scene& scene, const Mesh& mesh, const Structure& structure);

/// Centrifugal forces and couples on bodies at vertices; null without a frame or bodies.
std::unique_ptr<const ExternalEnergy> bodies_in_frame(const Scene& scene, const Mesh& mesh, const Structure& structure,
                                                      const std::shared_ptr<const LoadClock>& clock);

/// Masses at the moment points of the elements of a block: VibratingBlock::mass.
void fill_masses(const Scene& scene, const Mesh& mesh, const Structure& structure, const ElementBlock& block,
                 const KernelView<double**>& mass);

/// Elements with mass in a rotating frame, on one rank: their contributions to rows, potential and tangents.
class RotatingElements {
 public:
  RotatingElements(const Scene& scene, const Mesh& mesh, const Structure& structure, const FrameSpin& spin);

  const FrameSpin& spin() const { return spin_; }
  /// Frame of a block at a given angular velocity.
  FrameViews frame(size_t block, const Vec& spin) const { return {blocks_[block].mass, blocks_[block].place, spin}; }
  /// Frame of a range of consecutive elements of the block.
  FrameViews frame(size_t block, const Vec& spin, int first, int count) const {
    const auto rows = std::make_pair(first, first + count);
    return {Kokkos::subview(blocks_[block].mass, rows, Kokkos::ALL),
            Kokkos::subview(blocks_[block].place, rows, Kokkos::ALL), spin};
  }
  /// Largest force per length on the undeformed structure times the length of the member, at amplitude 1.
  double largest_force() const { return largest_force_; }
  /// Adds a factor times the rows at an angular velocity to those of elements, scaled as in ElementEquations.
  void add_rows(const Structure& structure, const State& state, const Vec& spin, double factor,
                const ElementEquations& to) const;
  /// Potential of the elements that this rank owns.
  double energy(const Structure& structure, const State& state, double load_factor) const;

 private:
  FrameSpin spin_;
  std::vector<FrameViews> blocks_{};
  double largest_force_ = 0.0;
};

/// Null without a rotating frame, or if no section has mass.
std::unique_ptr<const RotatingElements> rotating_elements(const Scene& scene, const Mesh& mesh,
                                                          const Structure& structure, const FrameSpin& spin);

}  // namespace mixbeam
