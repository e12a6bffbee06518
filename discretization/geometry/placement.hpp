/// Placement of members one by one: their order, and circular arcs defined by other data than centre, axis and angle.
#pragma once

#include "discretization/geometry/reference_curve.hpp"
#include "discretization/scene/scene.hpp"

#include <functional>
#include <string>
#include <vector>

namespace mixbeam {

/// Data that determine an arc together with its start point (and end point, see the functions below).
struct ArcDefinition {
  enum class Given {
    point,   ///< a point on the arc between start and end
    radius,  ///< radius and axis: the arc from start to end of at most pi
    tangent  ///< start tangent, radius, axis and angle; the end follows
  };
  Given given = Given::point;
  Vector3 vector{};  ///< the point, or the start tangent
  double radius = 0.0;

  bool needs_end() const { return given != Given::tangent; }
};

/// Completes center, axis and angle of an arc. `end` is not used if the tangent is given.
/// Throws std::invalid_argument if there is no such arc: points on a line, a radius below half the distance, an axis
/// that is not normal to the arc.
void complete_arc(Curve& curve, const ArcDefinition& definition, const Vector3& start, const Vector3& end);

/// Order in which the members can be placed one by one, since ends of curves and inner points may follow from members:
/// the points that a member needs are points of the scene, or belong to members before it. Members that cannot be
/// placed are left out.
std::vector<std::size_t> placement_order(
    const Scene& scene, const std::function<std::vector<std::string>(const Member& member)>& points_needed);

/// Points are written with a dozen digits or more, and computed ones have only rounding errors. [length of the curve]
constexpr double kPlaceTolerance = 1e-9;

/// Point whose position follows from a member: the start of formula curves, the end of a curve that defines it, and
/// inner points.
struct PointOfMember {
  enum class Role { start, end, inner };
  Role role = Role::inner;
  std::string point{};
  Vector3 position{};
  double length = 0.0;  ///< of the member, reference for tolerances
};

/// Lists them for a member whose start (and end, unless its curve defines it) is known. `curve` returns its reference
/// curve, and is called only if needed.
std::vector<PointOfMember> points_of_member(const Member& member, const Vector3& start,
                                            const std::function<ReferenceCurve()>& curve);

}  // namespace mixbeam
