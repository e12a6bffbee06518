/// Undeformed centerlines with their triads. Line, circular arc and helix turn their frame at a constant rate: one
/// struct serves all three.
#pragma once

#include "discretization/scene.hpp"
#include "kernels/rotation.hpp"

namespace mixbeam {

/// A centerline over its arc length s in [0, length] that carries the triad Lambda_0(s) = [g1 g2 g3], g1 the tangent:
///   Lambda_0' = Lambda_0 hat(kappa0), r0' = g1, with a material curvature kappa0 that does not depend on s.
/// In space the triad turns at the constant rate Lambda_0 kappa0: about the axis of an arc or helix, by its angle over
/// its length. So kappa0 is constant whatever g2 is at the start, the principal normal or another direction: g2 keeps
/// its angle to the principal normal along the member, and only the components of kappa0 depend on that angle.
struct ReferenceCurve {
  Vec3<double> origin;             ///< r0(0)
  Quaternion<double> start_triad;  ///< Lambda_0(0)
  Vec3<double> start_curvature;    ///< kappa0(0), material: (torsion, bending about g2, bending about g3)
  double length;

  /// r0(s) = r0(0) + s Lambda_0(0) T(s kappa0) e1, the integral of the tangent
  Vec3<double> position(double s) const;
  /// Lambda_0(s) = Lambda_0(0) exp(s kappa0)
  Quaternion<double> triad(double s) const;
  /// g1(s), of unit length
  Vec3<double> tangent(double s) const;
  /// kappa0(s), material
  Vec3<double> curvature(double s) const;
};

/// A line that should run along e3 deviates by the last digits of its points, which must not decide about g2. [radian]
constexpr double kParallelToE3 = 1e-6;

/// Below this angle between second axis and tangent, g2 would depend on digits that the user rounded away. [radian]
constexpr double kSmallestSecondAxisAngle = 1e-6;

/// Centerline of a member that starts at `start`. A line goes to `end`; an arc or helix does not look at `end`: it
/// follows from center, axis, angle and rise, and its last point is `end_position`.
///
/// g2 at the start is the normalised projection of the member's second axis onto the plane normal to the tangent.
/// Without a second axis:
///   arc, helix  g2 points to the axis: an arc bends in its plane about g3, with EI3;
///   line        g3 is as near to the global e3 as possible, g2 = e3 x g1 / |e3 x g1|: the identity along e1, and all
///               lines in the e1-e2 plane bend in that plane about g3 = e3, with EI3; a line within kParallelToE3 of
///               +-e3 has g2 as near to e2 as possible.
/// Throws std::invalid_argument for a curve without length, radius or axis, for numbers that are not finite, and for a
/// second axis along the tangent.
ReferenceCurve make_reference_curve(const Member& member, const Vector3& start, const Vector3& end);

/// Where an arc or helix from `start` ends; a line has no end of its own and throws std::invalid_argument.
Vector3 end_position(const Member& member, const Vector3& start);

}  // namespace mixbeam
