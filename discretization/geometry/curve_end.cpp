#include "discretization/geometry/curve_end.hpp"

#include "discretization/geometry/reference_curve.hpp"
#include "discretization/geometry/vector_algebra.hpp"

#include <cmath>
#include <unordered_map>
#include <unordered_set>

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

Vector3 curve_end(const Curve& curve, const Vector3& start) {
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

std::vector<std::size_t> placement_order(
    const Scene& scene, const std::function<std::vector<std::string>(const Member& member)>& points_needed) {
  std::unordered_set<std::string> known;
  for (const Point& point : scene.points) known.insert(point.name);
  std::unordered_map<std::string, std::vector<std::size_t>> waiting;  // point -> members that need it
  std::vector<std::size_t> missing(scene.members.size(), 0);          // points that a member still needs
  std::vector<std::size_t> ready, order;
  for (std::size_t i = scene.members.size(); i-- > 0;) {
    for (const std::string& point : points_needed(scene.members[i])) {
      if (known.count(point) > 0) continue;
      waiting[point].push_back(i);
      ++missing[i];
    }
    if (missing[i] == 0) ready.push_back(i);
  }
  while (!ready.empty()) {
    order.push_back(ready.back());
    ready.pop_back();
    const Member& placed = scene.members[order.back()];
    std::vector<std::string> points = {placed.start_point, placed.end_point};
    for (const InnerPoint& inner : placed.inner_points) points.push_back(inner.point);
    for (const std::string& point : points) {
      const auto next = waiting.find(point);
      if (next == waiting.end()) continue;
      for (const std::size_t member : next->second)
        if (--missing[member] == 0) ready.push_back(member);
      waiting.erase(next);
    }
  }
  return order;
}

}  // namespace mixbeam
