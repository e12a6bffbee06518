/// The structure of all sweeps, a straight cantilever with EI2 = EI3, and its closed forms.
#pragma once

#include "discretization/scene/scene.hpp"
#include "kernels/math/rotation.hpp"
#include "nonlinear/run/simulation.hpp"

namespace mixbeam {

/// Where the tip goes, and what errors are divided by.
struct TipMotion {
  Vec3<double> displacement{};
  Quaternion<double> rotation = identity_quaternion<double>();
  double displacement_scale = 1.0;  ///< length; of the displacement itself, so that tiny motions are exact too
  double rotation_scale = 1.0;      ///< the angle, at most one radian
};

/// One scene of a sweep with its exact answer. Every function returns a changed copy; the answer belongs to the load
/// that was given last.
class Cantilever {
 public:
  /// Throws InputError unless the scene is one straight member from the origin along x, clamped at its start, with one
  /// dead load at its end and nothing else, and EI2 = EI3.
  explicit Cantilever(const Scene& scene);

  const Scene& scene() const { return scene_; }
  double length() const { return length_; }
  double bending_stiffness() const { return bending_; }
  const TipMotion& exact() const { return exact_; }

  Cantilever with_mesh(int order, int elements) const;
  /// Elements whose lengths grow from the clamp to the tip by one factor; `ratio`: longest to shortest, at least 1.
  Cantilever with_graded_mesh(int elements, double ratio) const;
  /// EA = GA2 = GA3 = stiffness; infinity: inextensible and shear rigid. Before a load.
  Cantilever with_force_stiffness(double stiffness) const;
  /// Before a load.
  Cantilever with_torsional_stiffness(double stiffness) const;
  /// The same structure, its unit of length divided by `length` and that of force by `force`. Before a load.
  Cantilever in_units(double length, double force) const;

  /// Dead force along y, F L^2 / EI = load >= 0. Exact: elastica, and with C = EA = GA2 = GA3 every point moves by
  /// s F / C further, whatever the rotations (r' = g1 + n / C, and m' = - r' x n does not see C).
  Cantilever with_tip_force(double load) const;
  /// Dead thrust against the axis, as a multiple of Euler's load, and the fraction `eccentricity` > 0 of it along y.
  /// Exact: elastica (inextensible and shear rigid alone), the stable equilibrium on the side of the force along y.
  Cantilever with_thrust(double load, double eccentricity) const;
  /// Dead moment about z that turns the tip by `angle`. Exact: circle of curvature angle / L.
  Cantilever with_bending_moment(double angle) const { return with_tip_moment({{0.0, 0.0, angle}}, 0.0); }
  /// Dead moment with bending_turn = (0, y, z) EI / L across the rod, as spatial vector, and twisting it by `twist`.
  /// Exact (EI2 = EI3, no forces): the spatial moment m is constant and so is its component M1 along the tangent; the
  /// rotations are exp(s m / EI) exp(s M1 (1/GIt - 1/EI) e1), the centerline is a helix about m.
  Cantilever with_tip_moment(const Vec3<double>& bending_turn, double twist) const;

  /// After with_bending_moment() on equal elements: the exact displacement is that of the discrete equations, the
  /// k-point Gauss rule of the exact tangent (rotations are exact and force strains vanish at these points), because
  /// the circle is far away where an element turns by a radian and more.
  Cantilever against_gauss_rule() const;

  /// Distance of a computed tip from the exact one, the larger of displacement and rotation over their scales.
  double error(const Simulation& simulation) const;

 private:
  PointLoad& load() { return scene_.point_loads.front(); }

  Scene scene_;
  double length_ = 0.0, bending_ = 0.0, torsion_ = 0.0, force_stiffness_ = 0.0;
  TipMotion exact_;
};

}  // namespace mixbeam
