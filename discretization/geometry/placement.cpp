#include "discretization/geometry/placement.hpp"

#include "discretization/text/errors.hpp"
#include "discretization/text/expression.hpp"
#include "discretization/text/number_text.hpp"
#include "kernels/math/constants.hpp"
#include "kernels/math/vector_algebra.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <unordered_map>
#include <unordered_set>

namespace mixbeam {
namespace {

using namespace vector_algebra;

// Three points within this angle of a line: the radius would be a million lengths, with few digits left.
constexpr double kStraight = 1e-6;
// Error of a direction that should be normal to the axis: coordinates are written with six digits. [radian]
constexpr double kNormalTolerance = 1e-6;
// For a half circle, whose radius is half the distance of its ends up to rounding.
constexpr double kHalfCircleTolerance = 1e-12;

/// `v` without its part along the unit vector `axis`, normalised.
Vector3 unit_normal_part(const Vector3& v, const Vector3& axis, const std::string& name) {
  require(norm(v) >= kShortestLength, name + " has no direction");
  const Vector3 direction = unit(v);
  require(std::abs(dot(direction, axis)) <= kNormalTolerance, name + " is not normal to the axis");
  return unit(difference(direction, scaled(dot(direction, axis), axis)));
}

void arc_through(Curve& curve, const Vector3& start, const Vector3& through, const Vector3& end) {
  const double size = std::max(norm(difference(through, start)), norm(difference(end, start)));
  require(size >= kShortestLength, "its three points coincide");
  const Vector3 u = scaled(1.0 / size, difference(through, start));
  const Vector3 v = scaled(1.0 / size, difference(end, start));
  const Vector3 normal = cross(u, v);  // start, through, end follow each other right-handed about it
  const Vector3 w = difference(v, u);
  require(norm(normal) > kStraight * std::max({norm(u) * norm(v), norm(u) * norm(w), norm(v) * norm(w)}),
          "its three points lie on a line, or two of them coincide");
  const Vector3 to_center =
      scaled(0.5 / dot(normal, normal), cross(difference(scaled(dot(u, u), v), scaled(dot(v, v), u)), normal));
  curve.center = sum(start, scaled(size, to_center));
  curve.axis = unit(normal);
  const Vector3 from = scaled(-1.0, to_center), to = difference(v, to_center);
  const double angle = std::atan2(dot(curve.axis, cross(from, to)), dot(from, to));
  curve.angle = angle > 0.0 ? angle : angle + 2.0 * kPi;
}

void arc_of_radius(Curve& curve, double radius, const Vector3& start, const Vector3& end) {
  const Vector3 axis = unit(curve.axis);
  const double distance = norm(difference(end, start));
  const Vector3 chord = unit_normal_part(difference(end, start), axis, "the line from start to end");
  const double half = 0.5 * distance;
  require(half <= radius * (1.0 + kHalfCircleTolerance),
          "the ends are " + shortest(distance) + " apart, more than two radii");
  const double sine = std::min(1.0, half / radius);
  const double height = radius * std::sqrt((1.0 - sine) * (1.0 + sine));
  curve.center = sum(scaled(0.5, sum(start, end)), scaled(height, cross(axis, chord)));
  curve.angle = 2.0 * std::asin(sine);
}

Vector3 formula_position(const Curve& curve, double t) {
  Vector3 position{};
  for (std::size_t i = 0; i < 3; ++i) position[i] = Expression(curve.formula[i], {"t"})(t);
  return position;
}

}  // namespace

void complete_arc(Curve& curve, const ArcDefinition& definition, const Vector3& start, const Vector3& end) {
  switch (definition.given) {
    case ArcDefinition::Given::point:
      return arc_through(curve, start, definition.vector, end);
    case ArcDefinition::Given::radius:
      return arc_of_radius(curve, definition.radius, start, end);
    case ArcDefinition::Given::tangent: {
      const Vector3 axis = unit(curve.axis);
      const Vector3 tangent = unit_normal_part(definition.vector, axis, "the start tangent");
      curve.center = sum(start, scaled(definition.radius, cross(axis, tangent)));
      return;
    }
  }
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

std::vector<PointOfMember> points_of_member(const Member& member, const Vector3& start,
                                            const std::function<ReferenceCurve()>& curve) {
  using Role = PointOfMember::Role;
  std::vector<PointOfMember> points;
  std::optional<ReferenceCurve> placed;
  if (member.curve.shape == CurveShape::parametric) {
    placed = curve();
    const auto& [first, last] = member.curve.range;
    points.push_back({Role::start, member.start_point, formula_position(member.curve, first), placed->length});
    points.push_back({Role::end, member.end_point, formula_position(member.curve, last), placed->length});
  } else if (defines_end(member.curve)) {
    const Vector3 end = curve_end(member.curve, start);
    points.push_back({Role::end, member.end_point, end, curve_length(member.curve, start, end)});
  }
  if (member.inner_points.empty()) return points;
  if (!placed) placed = curve();
  for (const InnerPoint& inner : member.inner_points)
    points.push_back(
        {Role::inner, inner.point, to_array(placed->position(placed->length * inner.position)), placed->length});
  return points;
}

}  // namespace mixbeam
