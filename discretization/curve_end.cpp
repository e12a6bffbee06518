#include "discretization/curve_end.hpp"

#include "discretization/vector_algebra.hpp"

#include <cmath>

namespace mixbeam {

using namespace vector_algebra;

Vector3 axis_direction(const Curve& curve) { return scaled(1.0 / norm(curve.axis), curve.axis); }

Vector3 radius_vector(const Curve& curve, const Vector3& position) {
  const Vector3 axis = axis_direction(curve);
  const Vector3 from_center = difference(position, curve.center);
  return difference(from_center, scaled(dot(from_center, axis), axis));
}

Vector3 curve_end(const Curve& curve, const Vector3& start) {
  // Rodrigues' rotation of the radius vector about the axis, which keeps start - radius where it is.
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
  Vector3 direction = difference(end, start);
  if (curve.shape != CurveShape::line) {
    const Vector3 axis = axis_direction(curve);
    direction = sum(scaled(curve.angle, cross(axis, radius_vector(curve, start))), scaled(curve.rise, axis));
  }
  return scaled(1.0 / norm(direction), direction);
}

}  // namespace mixbeam
