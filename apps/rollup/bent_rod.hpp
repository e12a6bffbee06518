/// The rod of the study and its exact solution: a moment at the tip bends a straight rod to a circle of radius EI/M,
/// without force strains.
#pragma once

#include "discretization/scene/scene.hpp"
#include "nonlinear/run/simulation.hpp"

namespace mixbeam {

/// One computation of the study.
struct BentRod {
  ForceIntegration integration = ForceIntegration::both_reduced;
  double slenderness = 0.0;  ///< L/a, square section of side a
  int order = 1;
  int elements = 1;
};

/// How far the vertices of a computed rod are from where they should be. Positions divided by L, rotations in radians.
struct VertexErrors {
  double tip = 0.0;         ///< distance of the last vertex from the end of the circle
  double circle = 0.0;      ///< largest distance of any vertex from its place on the circle
  double quadrature = 0.0;  ///< the same from where PureBending::quadrature_positions puts it
  double rotation = 0.0;    ///< largest angle between any vertex's rotation and the exact one
};

/// What the study knows about the scene that it varies.
class PureBending {
 public:
  /// Throws InputError unless the scene is one straight member from the origin along x, clamped at its start, with a
  /// dead moment about z at its end and nothing else.
  explicit PureBending(const Scene& scene);

  /// The scene with another mesh and with the force stiffness of a square section: EA = 12 slenderness^2 EI/L^2,
  /// GA = EA/2.
  Scene variant(const BentRod& rod) const;

  double length() const { return length_; }
  /// Centerline of the bent rod.
  Vec3<double> exact_position(double arc_length) const;

  /// Exact positions of all vertices of the discrete solution when both parts of the force-strain energy are reduced:
  /// rotations are exact and force strains vanish at k Gauss points in each element, so r' is the exact tangent there,
  /// and a vertex is where the Gauss rule for the integral of the tangent puts it. That is on the circle up to
  /// O(h^2k), and exactly on it wherever whole elements add up to a full turn, at the tip for one.
  std::vector<Vec3<double>> quadrature_positions(int order, int elements) const;

  /// The paper's error: 1/L sqrt(1/L int |r - r_exact|^2 ds). Collective.
  double centerline_error(const Simulation& simulation) const;
  /// Collective.
  VertexErrors vertex_errors(const Simulation& simulation) const;

 private:
  Scene scene_;
  double length_ = 0.0, bending_stiffness_ = 0.0, curvature_ = 0.0;
};

}  // namespace mixbeam
