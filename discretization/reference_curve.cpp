#include "discretization/reference_curve.hpp"

#include "discretization/vector_algebra.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace mixbeam {
namespace {

using namespace vector_algebra;

// A length below this share of the coordinates it is a difference of consists of rounding errors.
constexpr double kShortestRelativeLength = 1e-12;
// The start of an arc lies in its plane up to this share of the radius: coordinates are written with six digits.
constexpr double kOutOfPlaneTolerance = 1e-6;

void require(bool condition, const char* otherwise) {
  if (!condition) throw std::invalid_argument(otherwise);
}

bool is_finite(const Vector3& v) { return std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]); }

Vec3<double> to_vec3(const Vector3& v) { return {{v[0], v[1], v[2]}}; }

Vector3 unit(const Vector3& v) { return scaled(1.0 / norm(v), v); }

Vector3 axis_direction(const Curve& curve) { return unit(curve.axis); }

/// From the nearest point of the axis to `start`; its length is the radius.
Vector3 radius_vector(const Curve& curve, const Vector3& start) {
  const Vector3 from_center = difference(start, curve.center);
  const Vector3 axis = axis_direction(curve);
  return difference(from_center, scaled(dot(from_center, axis), axis));
}

/// Part of `v` normal to the unit vector `tangent`, of unit length. The second pass removes what rounding leaves of the
/// tangent in the first one when v is nearly parallel to it.
Vector3 unit_normal_part(const Vector3& v, const Vector3& tangent) {
  const Vector3 normal = unit(difference(v, scaled(dot(v, tangent), tangent)));
  return unit(difference(normal, scaled(dot(normal, tangent), tangent)));
}

void check_line(const Vector3& start, const Vector3& end) {
  require(is_finite(end), "The coordinates of the end point are not finite.");
  require(norm(difference(end, start)) > kShortestRelativeLength * std::max(norm(start), norm(end)),
          "The line has no length: its two points coincide.");
}

void check_turning_curve(const Curve& curve, const Vector3& start) {
  require(is_finite(curve.center) && is_finite(curve.axis), "Center or axis of the curve is not finite.");
  require(!is_zero(curve.axis), "The axis of the curve is zero and gives no direction.");
  require(std::isfinite(curve.angle) && curve.angle > 0.0, "The angle of the curve must be positive and finite.");
  require(std::isfinite(curve.rise), "The rise of the helix is not finite.");
  const double radius = norm(radius_vector(curve, start));
  require(radius > kShortestRelativeLength * std::max(norm(start), norm(curve.center)),
          "The start point lies on the axis of the curve: the radius is zero.");
  if (curve.shape == CurveShape::helix) return;
  require(curve.rise == 0.0, "A circular arc has no rise; a helix has.");
  require(std::abs(dot(difference(start, curve.center), axis_direction(curve))) <= kOutOfPlaneTolerance * radius,
          "The center of the arc is not in the plane through the start point normal to the axis.");
}

void check_curve(const Curve& curve, const Vector3& start, const Vector3& end) {
  require(is_finite(start), "The coordinates of the start point are not finite.");
  if (curve.shape == CurveShape::line)
    check_line(start, end);
  else
    check_turning_curve(curve, start);
}

double curve_length(const Curve& curve, const Vector3& start, const Vector3& end) {
  if (curve.shape == CurveShape::line) return norm(difference(end, start));
  return std::hypot(curve.angle * norm(radius_vector(curve, start)), curve.rise);
}

/// g1 at the start.
Vector3 start_tangent(const Curve& curve, const Vector3& start, const Vector3& end) {
  if (curve.shape == CurveShape::line) return unit(difference(end, start));
  const Vector3 axis = axis_direction(curve);
  return unit(sum(scaled(curve.angle, cross(axis, radius_vector(curve, start))), scaled(curve.rise, axis)));
}

/// g2 of a line whose member leaves the choice to the program, see make_reference_curve.
Vector3 default_second_axis_of_line(const Vector3& tangent) {
  const Vector3 horizontal = {-tangent[1], tangent[0], 0.0};  // e3 x g1
  return norm(horizontal) > kParallelToE3 ? horizontal : Vector3{0.0, 1.0, 0.0};
}

/// g2 at the start, normal to the tangent and of unit length.
Vector3 start_second_axis(const Member& member, const Vector3& start, const Vector3& tangent) {
  if (!is_zero(member.second_axis)) {
    require(is_finite(member.second_axis), "The second axis is not finite.");
    const Vector3 direction = unit(member.second_axis);
    require(norm(cross(tangent, direction)) >= kSmallestSecondAxisAngle,
            "The second axis is parallel to the tangent at the start.");
    return unit_normal_part(direction, tangent);
  }
  const Vector3 choice = member.curve.shape == CurveShape::line ? default_second_axis_of_line(tangent)
                                                                : scaled(-1.0, radius_vector(member.curve, start));
  return unit_normal_part(unit(choice), tangent);
}

}  // namespace

Vec3<double> ReferenceCurve::position(double s) const {
  const Vec3<double> mean_tangent = tangent_map(s * start_curvature) * Vec3<double>{{1.0, 0.0, 0.0}};
  return origin + s * (rotation_matrix(start_triad) * mean_tangent);
}

// The product of two unit quaternions is a unit quaternion up to rounding, which would enter the triad fourfold.
Quaternion<double> ReferenceCurve::triad(double s) const {
  return normalized(start_triad * exp_quaternion(s * start_curvature));
}

Vec3<double> ReferenceCurve::tangent(double s) const {
  const Vec3<double> g1 = rotation_matrix(triad(s)) * Vec3<double>{{1.0, 0.0, 0.0}};
  return (1.0 / norm(g1)) * g1;
}

Vec3<double> ReferenceCurve::curvature(double) const { return start_curvature; }

ReferenceCurve make_reference_curve(const Member& member, const Vector3& start, const Vector3& end) {
  check_curve(member.curve, start, end);
  const Vector3 g1 = start_tangent(member.curve, start, end);
  const Vector3 g2 = start_second_axis(member, start, g1);
  const Vector3 g3 = cross(g1, g2);

  ReferenceCurve curve{};
  curve.origin = to_vec3(start);
  curve.start_triad =
      quaternion_of(Mat3<double>{{{g1[0], g2[0], g3[0]}, {g1[1], g2[1], g3[1]}, {g1[2], g2[2], g3[2]}}});
  curve.length = curve_length(member.curve, start, end);
  if (member.curve.shape != CurveShape::line) {
    // Lambda_0 kappa0 = (angle / length) axis
    const Vector3 turning_rate = scaled(member.curve.angle / curve.length, axis_direction(member.curve));
    curve.start_curvature = {{dot(g1, turning_rate), dot(g2, turning_rate), dot(g3, turning_rate)}};
  }
  return curve;
}

Vector3 end_position(const Member& member, const Vector3& start) {
  require(member.curve.shape != CurveShape::line,
          "A line ends at its end point; only arc and helix define their own end.");
  const ReferenceCurve curve = make_reference_curve(member, start, start);
  const Vec3<double> end = curve.position(curve.length);
  return {end[0], end[1], end[2]};
}

}  // namespace mixbeam
