/// Where an undeformed member ends, how long it is and which way it starts, and which members must be placed before it;
/// enough to check a scene.
#pragma once

#include "discretization/scene/scene.hpp"

#include <functional>
#include <string>
#include <vector>

namespace mixbeam {

/// Unit vector along `curve.axis`.
Vector3 axis_direction(const Curve& curve);

/// From the nearest point of the axis to `position`; its length is the radius. Arc and helix.
Vector3 radius_vector(const Curve& curve, const Vector3& position);

/// Whether the curve defines where it ends: arc, helix, parametric curve. Line and spline end at their end point.
bool defines_end(const Curve& curve);

/// End of an arc or helix that starts at `start`.
Vector3 curve_end(const Curve& curve, const Vector3& start);

// The following throw std::invalid_argument for a spline or parametric curve that make_reference_curve refuses.

/// Arc length; `end` matters for a line or spline only.
double curve_length(const Curve& curve, const Vector3& start, const Vector3& end);

/// Unit tangent at the start; `end` matters for a line or spline only.
Vector3 start_tangent(const Curve& curve, const Vector3& start, const Vector3& end);

/// Order in which the members can be placed one by one, since ends of curves and inner points may follow from their
/// members: the points that a member needs are points of the scene, or belong to members before it. Members that
/// cannot be placed are left out.
std::vector<std::size_t> placement_order(
    const Scene& scene, const std::function<std::vector<std::string>(const Member& member)>& points_needed);

}  // namespace mixbeam
