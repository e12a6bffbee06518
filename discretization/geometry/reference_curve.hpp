/// Undeformed centerlines with their triads. The frame of a line, circular arc or helix rotates at a constant rate:
/// closed formulas. Splines and formula curves are polynomial pieces.
#pragma once

#include "discretization/geometry/arc_length_curve.hpp"
#include "discretization/scene/scene.hpp"
#include "kernels/math/rotation.hpp"

#include <memory>
#include <optional>

namespace mixbeam {

/// Centerline over its arc length s in [0, length] with the triad Lambda_0(s) = [g1 g2 g3], g1 the tangent:
///   Lambda_0' = Lambda_0 hat(kappa0), r0' = g1, kappa0 the material curvature.
///
/// Line, arc, helix: the carried triad rotates at a constant rate in space, about the axis of an arc or helix by its
/// angle over its length. Its kappa0 is thus constant for any g2 at the start: g2 keeps its angle to the principal
/// normal along the member, and only the components of kappa0 depend on that angle. Spline, parametric curve: the
/// carried triad never rotates about the tangent (ArcLengthCurve).
/// A pre-twisted member rotates about g1 relative to the carried triad, by twist * s / length; a twisted line still has
/// constant curvature.
struct ReferenceCurve {
  Vec3<double> origin;             ///< r0(0)
  Quaternion<double> start_triad;  ///< Lambda_0(0)
  Vec3<double> start_curvature;    ///< kappa0(0): (torsion, bending about g2, bending about g3)
  double length;
  double twist_rate = 0.0;                       ///< rotation about the tangent relative to the carried triad
                                                 ///< [1/length]; zero for lines: part of their constant curvature
  std::shared_ptr<const ArcLengthCurve> path{};  ///< of spline and parametric curve, else null
  /// Direction of g2 instead of the carried one, before the twist: along a direction (no point), or away from the line
  /// through a point in a direction; as closely as the tangent permits.
  struct SecondAxis {
    std::optional<Vec3<double>> point{};
    Vec3<double> direction{};
  };
  std::optional<SecondAxis> second_axis{};

  /// True if kappa0 is constant.
  bool has_constant_curvature() const { return path == nullptr && twist_rate == 0.0 && !second_axis; }
  bool is_straight() const { return has_constant_curvature() && dot(start_curvature, start_curvature) == 0.0; }

  /// r0(s); with constant curvature r0(0) + s Lambda_0(0) T(s kappa0) e1, the integral of the tangent
  Vec3<double> position(double s) const;
  /// Lambda_0(s); with constant curvature Lambda_0(0) exp(s kappa0)
  Quaternion<double> triad(double s) const;
  /// g1(s), of unit length
  Vec3<double> tangent(double s) const;
  /// Derivative of g1, spatial.
  Vec3<double> tangent_slope(double s) const;
  /// kappa0(s), material; half of the digits are lost for formula curves, but nothing depends on them
  Vec3<double> curvature(double s) const;
};

/// A line intended along e3 deviates by the last digits of its points, which must not determine g2. [radian]
constexpr double kParallelToE3 = 1e-6;

/// Below this angle between second axis and tangent, g2 would depend on digits lost in the user's rounding. [radian]
constexpr double kSmallestSecondAxisAngle = 1e-6;

/// Centerline of a member from `start` to `end`. An arc or helix does not use `end`, which follows from center,
/// axis, angle and rise; a parametric curve uses neither.
///
/// g2 at the start is the normalised projection of the member's second axis onto the plane normal to the tangent.
/// Without a second axis:
///   arc, helix                g2 points to the axis: an arc bends in its plane about g3, with EI3;
///   line, spline, parametric  g3 is as close to the global e3 as possible, g2 = e3 x g1 / |e3 x g1|: the identity
///               along e1, and all curves in the e1-e2 plane bend in that plane about g3 = e3, with EI3; with a start
///               tangent within kParallelToE3 of +-e3, g2 is as close to e2 as possible.
/// With keeps_second_axis or second_axis_from the same rule applies to g2 everywhere on the member.
/// Throws std::invalid_argument for a curve without length, radius, axis or tangent, for non-finite numbers, for a
/// second axis along the tangent, and for points and formulas that define no curve (polynomial_curve.hpp).
ReferenceCurve make_reference_curve(const Member& member, const Vector3& start, const Vector3& end);

/// True if the ends, the middles and the quarters of two curves are at the same places.
bool coincide(const ReferenceCurve& a, const ReferenceCurve& b, bool reversed, double tolerance);

// Parts of a reference curve, for lines, arcs and helices.

/// Unit vector along `curve.axis`.
Vector3 axis_direction(const Curve& curve);
/// Returns the vector from the closest point of the axis to `position`; its length is the radius. Arc and helix.
Vector3 radius_vector(const Curve& curve, const Vector3& position);
/// True if the curve defines its end: arc, helix, parametric curve. Line and spline end at their end point.
bool defines_end(const Curve& curve);
/// End of an arc or helix that starts at `start`.
Vector3 curve_end(const Curve& curve, const Vector3& start);
/// Arc length; `end` is used for a line only.
double curve_length(const Curve& curve, const Vector3& start, const Vector3& end);
/// g1 at the start; `end` is used for a line only.
Vector3 start_tangent(const Curve& curve, const Vector3& start, const Vector3& end);

}  // namespace mixbeam
