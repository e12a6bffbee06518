#include "discretization/geometry/reference_curve.hpp"

#include "discretization/text/errors.hpp"
#include "discretization/text/number_text.hpp"
#include "kernels/math/vector_algebra.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace mixbeam {
namespace {

using namespace vector_algebra;

// A difference of coordinates below this share of them consists of rounding errors.
constexpr double kShortestRelativeLength = 1e-12;
// The start of an arc lies in its plane up to this share of the radius: coordinates are written with six digits.
constexpr double kOutOfPlaneTolerance = 1e-6;

bool is_finite(const Vector3& v) { return std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]); }

bool is_path(const Curve& curve) { return curve.shape == CurveShape::spline || curve.shape == CurveShape::parametric; }

/// Part of `v` normal to the unit vector `tangent`, normalised. The second pass removes the tangential rounding of the
/// first one if v is nearly parallel to the tangent.
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

/// Default g2 of a line, see make_reference_curve.
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
  const bool turns = member.curve.shape == CurveShape::circular_arc || member.curve.shape == CurveShape::helix;
  const Vector3 choice =
      turns ? scaled(-1.0, radius_vector(member.curve, start)) : default_second_axis_of_line(tangent);
  return unit_normal_part(unit(choice), tangent);
}

Quaternion<double> triad_of(const Vector3& g1, const Vector3& g2) {
  const Vector3 g3 = cross(g1, g2);
  return quaternion_of(Mat3<double>{{{g1[0], g2[0], g3[0]}, {g1[1], g2[1], g3[1]}, {g1[2], g2[2], g3[2]}}});
}

Quaternion<double> carried_triad(const ReferenceCurve& curve, double s) {
  if (curve.path != nullptr) return curve.path->triad(s);
  return curve.start_triad * exp_quaternion(s * (curve.start_curvature - Vec3<double>{{curve.twist_rate, 0.0, 0.0}}));
}

/// Requested direction of the second axis at s, and its derivative; not normalised.
struct WantedAxis {
  Vector3 direction{}, slope{};
};

WantedAxis wanted_axis(const ReferenceCurve& curve, double s, const Vector3& tangent) {
  const Vector3 axis = to_array(curve.second_axis->direction);
  if (!curve.second_axis->point) return {axis, {}};
  const auto across = [&](const Vector3& v) { return difference(v, scaled(dot(v, axis), axis)); };
  return {across(to_array(curve.position(s) - *curve.second_axis->point)), across(tangent)};
}

/// g2 before the twist, and its rate of rotation about the tangent.
struct SecondAxisAt {
  Vector3 g2{};
  double rate = 0.0;
};

SecondAxisAt second_axis_at(const ReferenceCurve& curve, double s, const Vector3& g1) {
  const WantedAxis wanted = wanted_axis(curve, s, g1);
  const Vector3 g2 = unit_normal_part(wanted.direction, g1), g3 = cross(g1, g2);
  const double along = dot(wanted.direction, g1);
  const double turning = dot(wanted.slope, g3) - along * dot(to_array(curve.tangent_slope(s)), g3);
  return {g2, turning / norm(difference(wanted.direction, scaled(along, g1)))};
}

constexpr int kAxisSamples = 256;  // a spline or formula whose second axis flips between two of them is refused

/// Rejects places where the requested axis is along the tangent, and a change of its side there.
void check_second_axis(const ReferenceCurve& curve) {
  Vector3 before{};  // in the carried triad
  for (int i = 0; i <= kAxisSamples; ++i) {
    const double s = curve.length * i / kAxisSamples;
    const Vector3 g1 = to_array(curve.tangent(s)), wanted = wanted_axis(curve, s, g1).direction;
    const double angle = norm(cross(g1, scaled(1.0 / norm(wanted), wanted)));
    const Vector3 g2 = angle >= kSmallestSecondAxisAngle ? second_axis_at(curve, s, g1).g2 : Vector3{};
    const Vector3 carried = to_array(transpose_times(rotation_matrix(carried_triad(curve, s)), to_vec3(g2)));
    require(!is_zero(g2) && (i == 0 || dot(carried, before) > 0.0),
            "The direction of the second axis runs along the tangent near s = " + shortest(s) +
                ", where the section would turn over.");
    before = carried;
  }
}

/// Direction requested for g2 everywhere; a line keeps a direction anyway.
std::optional<ReferenceCurve::SecondAxis> directed_axis(const Member& member) {
  if (!member.second_axis_from) {
    if (!member.keeps_second_axis || member.curve.shape == CurveShape::line) return std::nullopt;
    require(is_finite(member.second_axis) && !is_zero(member.second_axis), "The second axis is zero or not finite.");
    return ReferenceCurve::SecondAxis{std::nullopt, to_vec3(unit(member.second_axis))};
  }
  const auto [x, y, z, a, b, c] = *member.second_axis_from;
  const Vector3 direction = {a, b, c};
  require(is_finite({x, y, z}) && is_finite(direction) && !is_zero(direction),
          "The line from which the second axis points has no direction.");
  return ReferenceCurve::SecondAxis{Vec3<double>{{x, y, z}}, to_vec3(unit(direction))};
}

/// Line, arc or helix.
ReferenceCurve make_turning_curve(const Member& member, const Vector3& start, const Vector3& end) {
  check_curve(member.curve, start, end);
  const Vector3 g1 = start_tangent(member.curve, start, end);
  const Vector3 g2 = start_second_axis(member, start, g1);
  const Vector3 g3 = cross(g1, g2);

  ReferenceCurve curve{};
  curve.origin = to_vec3(start);
  curve.start_triad = triad_of(g1, g2);
  curve.length = curve_length(member.curve, start, end);
  const double twist_rate = member.twist / curve.length;
  if (member.curve.shape == CurveShape::line) {
    curve.start_curvature = {{twist_rate, 0.0, 0.0}};
    if (member.second_axis_from) curve.twist_rate = twist_rate;  // relative to an axis that may rotate along the line
    return curve;
  }
  // Lambda_0 kappa0 = (angle / length) axis
  const Vector3 turning_rate = scaled(member.curve.angle / curve.length, axis_direction(member.curve));
  curve.start_curvature = {{dot(g1, turning_rate) + twist_rate, dot(g2, turning_rate), dot(g3, turning_rate)}};
  curve.twist_rate = twist_rate;
  return curve;
}

/// Spline or parametric curve.
ReferenceCurve make_path(const Member& member, const Vector3& start, const Vector3& end) {
  PolynomialCurve pieces = member.curve.shape == CurveShape::spline ? make_spline(member.curve, start, end)
                                                                    : make_formula_curve(member.curve);
  ReferenceCurve curve{};
  curve.origin = pieces.origin;
  const Vector3 g1 = to_array(mixbeam::start_tangent(pieces));
  curve.start_triad = triad_of(g1, start_second_axis(member, start, g1));
  curve.path = std::make_shared<ArcLengthCurve>(std::move(pieces), curve.start_triad);
  curve.length = curve.path->length();
  curve.twist_rate = member.twist / curve.length;
  curve.start_curvature = curve.curvature(0.0);
  return curve;
}

}  // namespace

Vec3<double> ReferenceCurve::position(double s) const {
  if (path != nullptr) return path->position(s);
  if (is_straight()) return origin + s * (rotation_matrix(start_triad) * Vec3<double>{{1.0, 0.0, 0.0}});
  const Vec3<double> carried = start_curvature - Vec3<double>{{twist_rate, 0.0, 0.0}};
  const Vec3<double> mean_tangent = tangent_map(s * carried) * Vec3<double>{{1.0, 0.0, 0.0}};
  return origin + s * (rotation_matrix(start_triad) * mean_tangent);
}

// The product of two unit quaternions has unit length only up to rounding, which would enter the triad fourfold.
Quaternion<double> ReferenceCurve::triad(double s) const {
  if (is_straight()) return normalized(start_triad);
  if (has_constant_curvature()) return normalized(start_triad * exp_quaternion(s * start_curvature));
  Quaternion<double> untwisted = carried_triad(*this, s);
  if (second_axis) {
    const Vector3 g1 = to_array(tangent(s));
    untwisted = triad_of(g1, second_axis_at(*this, s, g1).g2);
  }
  return normalized(untwisted * turn_about_first_axis(s * twist_rate));
}

Vec3<double> ReferenceCurve::tangent(double s) const {
  if (path != nullptr) return path->tangent(s);
  const Quaternion<double> carrier = second_axis ? carried_triad(*this, s) : triad(s);
  const Vec3<double> g1 = rotation_matrix(carrier) * Vec3<double>{{1.0, 0.0, 0.0}};
  return (1.0 / norm(g1)) * g1;
}

Vec3<double> ReferenceCurve::tangent_slope(double s) const {
  if (path != nullptr) return path->tangent_slope(s);
  // kappa0 x e1 in the carried triad
  return rotation_matrix(carried_triad(*this, s)) * Vec3<double>{{0.0, start_curvature[2], -start_curvature[1]}};
}

Vec3<double> ReferenceCurve::curvature(double s) const {
  if (has_constant_curvature()) return start_curvature;
  const Vec3<double> twist{{twist_rate, 0.0, 0.0}};
  if (path == nullptr && !second_axis) {  // components of the carried curvature in the twisted triad
    const Quaternion<double> turn = turn_about_first_axis(s * twist_rate);
    return twist + transpose_times(rotation_matrix(turn), start_curvature - twist);
  }
  // g1' = kappa0_3 g2 - kappa0_2 g3
  const Vec3<double> slope = transpose_times(rotation_matrix(triad(s)), tangent_slope(s));
  const double turning = second_axis ? second_axis_at(*this, s, to_array(tangent(s))).rate : 0.0;
  return {{twist_rate + turning, -slope[2], slope[1]}};
}

ReferenceCurve make_reference_curve(const Member& member, const Vector3& start, const Vector3& end) {
  require(std::isfinite(member.twist), "The twist of the member is not finite.");
  const auto make = is_path(member.curve) ? make_path : make_turning_curve;
  const std::optional<ReferenceCurve::SecondAxis> axis = directed_axis(member);
  if (!axis) return make(member, start, end);
  Member directed = member;  // with the right g2 at its start
  if (axis->point) {
    const Vec3<double> from = to_vec3(start) - *axis->point;
    directed.second_axis = to_array(from - dot(from, axis->direction) * axis->direction);
    require(!is_zero(directed.second_axis), "The start lies on the line from which the second axis points.");
  }
  ReferenceCurve curve = make(directed, start, end);
  curve.second_axis = axis;
  check_second_axis(curve);
  return curve;
}

Vector3 axis_direction(const Curve& curve) { return unit(curve.axis); }

Vector3 radius_vector(const Curve& curve, const Vector3& position) {
  const Vector3 from_center = difference(position, curve.center);
  const Vector3 axis = axis_direction(curve);
  return difference(from_center, scaled(dot(from_center, axis), axis));
}

bool defines_end(const Curve& curve) { return curve.shape != CurveShape::line && curve.shape != CurveShape::spline; }

Vector3 curve_end(const Curve& curve, const Vector3& start) {
  // Rodrigues' rotation of the radius vector about the axis, which fixes start - radius.
  const Vector3 axis = axis_direction(curve);
  const Vector3 radius = radius_vector(curve, start);
  const Vector3 turned = sum(scaled(std::cos(curve.angle), radius), scaled(std::sin(curve.angle), cross(axis, radius)));
  return sum(sum(difference(start, radius), turned), scaled(curve.rise, axis));
}

double curve_length(const Curve& curve, const Vector3& start, const Vector3& end) {
  if (curve.shape == CurveShape::line) return norm(difference(end, start));
  return std::hypot(norm(radius_vector(curve, start)) * curve.angle, curve.rise);
}

Vector3 start_tangent(const Curve& curve, const Vector3& start, const Vector3& end) {
  if (curve.shape == CurveShape::line) return unit(difference(end, start));
  const Vector3 axis = axis_direction(curve);
  return unit(sum(scaled(curve.angle, cross(axis, radius_vector(curve, start))), scaled(curve.rise, axis)));
}

bool coincide(const ReferenceCurve& a, const ReferenceCurve& b, bool reversed, double tolerance) {
  for (const double x : {0.0, 0.25, 0.5, 0.75, 1.0})
    if (norm(a.position(x * a.length) - b.position((reversed ? 1.0 - x : x) * b.length)) > tolerance) return false;
  return true;
}

}  // namespace mixbeam
