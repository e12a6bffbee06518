#include "discretization/geometry/curve_end.hpp"

#include "discretization/geometry/polynomial_curve.hpp"
#include "discretization/geometry/reference_curve.hpp"
#include "discretization/geometry/vector_algebra.hpp"

#include <cmath>

namespace mixbeam {

using namespace vector_algebra;

namespace {

bool is_path(const Curve& curve) { return curve.shape == CurveShape::spline || curve.shape == CurveShape::parametric; }

Vector3 to_array(const Vec3<double>& v) { return {v[0], v[1], v[2]}; }

ReferenceCurve reference_curve(const Curve& curve, const Vector3& start, const Vector3& end) {
  Member member;
  member.curve = curve;
  return make_reference_curve(member, start, end);
}

}  // namespace

Vector3 axis_direction(const Curve& curve) { return scaled(1.0 / norm(curve.axis), curve.axis); }

Vector3 radius_vector(const Curve& curve, const Vector3& position) {
  const Vector3 axis = axis_direction(curve);
  const Vector3 from_center = difference(position, curve.center);
  return difference(from_center, scaled(dot(from_center, axis), axis));
}

bool defines_end(const Curve& curve) { return curve.shape != CurveShape::line && curve.shape != CurveShape::spline; }

Vector3 curve_start(const Curve& curve) { return to_array(make_formula_curve(curve).origin); }

Vector3 curve_end(const Curve& curve, const Vector3& start) {
  if (curve.shape == CurveShape::parametric) {
    const PolynomialCurve path = make_formula_curve(curve);
    return to_array(path.origin + path.pieces.back().position(path.pieces.back().last()));
  }
  // Rodrigues' rotation of the radius vector about the axis, which keeps start - radius where it is.
  const Vector3 axis = axis_direction(curve);
  const Vector3 radius = radius_vector(curve, start);
  const Vector3 turned = sum(scaled(std::cos(curve.angle), radius), scaled(std::sin(curve.angle), cross(axis, radius)));
  return sum(sum(difference(start, radius), turned), scaled(curve.rise, axis));
}

double curve_length(const Curve& curve, const Vector3& start, const Vector3& end) {
  if (is_path(curve)) return reference_curve(curve, start, end).length;
  if (curve.shape == CurveShape::line) return norm(difference(end, start));
  return std::hypot(norm(radius_vector(curve, start)) * curve.angle, curve.rise);
}

Vector3 start_tangent(const Curve& curve, const Vector3& start, const Vector3& end) {
  if (is_path(curve)) return to_array(reference_curve(curve, start, end).tangent(0.0));
  Vector3 direction = difference(end, start);
  if (curve.shape != CurveShape::line) {
    const Vector3 axis = axis_direction(curve);
    direction = sum(scaled(curve.angle, cross(axis, radius_vector(curve, start))), scaled(curve.rise, axis));
  }
  return scaled(1.0 / norm(direction), direction);
}

Vector3 position_along(const Member& member, const Vector3& start, const Vector3& end, double share) {
  const ReferenceCurve curve = make_reference_curve(member, start, end);
  return to_array(curve.position(share * curve.length));
}

}  // namespace mixbeam
