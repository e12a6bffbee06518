/// The helix in closed form, and how far a computed rod is from it.
#pragma once

#include "nonlinear/run/simulation.hpp"

namespace mixbeam {

/// r(s) = R0 sin(a) e1 - R0 cos(a) e2 + h0 s / L e3,  a = 2 pi n s / L  (paper, section "Helix experiment").
struct ExactHelix {
  double radius = 0.0;  ///< R0
  double height = 0.0;  ///< h0
  double coils = 0.0;   ///< n

  double length() const;         ///< L
  double slope() const;          ///< c = h0 / (2 pi n R0), the tangent of the angle of inclination
  double angle(double s) const;  ///< a(s)
  Vec3<double> position(double s) const;
  /// Triad of the section: exp(a e3) exp(-arctan(c) e2). The paper prints the second angle with the other sign, which
  /// does not give the tangent of r(s).
  Quaternion<double> triad(double s) const;
};

/// Errors of one computed rod. Positions are divided by L, rotations in radians.
struct HelixErrors {
  double tip_position = 0.0, tip_rotation = 0.0;
  double vertex_position = 0.0, vertex_rotation = 0.0;  ///< largest of all vertices
  double centerline = 0.0;                              ///< sqrt(1/L int |r - r_exact|^2 ds) / L, vertices and between
};

/// Of a scene with one member, which runs from s = 0 to s = L. Collective.
HelixErrors compare(const Simulation& simulation, const ExactHelix& exact);

}  // namespace mixbeam
