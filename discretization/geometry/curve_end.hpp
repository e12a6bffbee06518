/// Where an undeformed member ends, how long it is and which way it starts; enough to check a scene.
#pragma once

#include "discretization/scene/scene.hpp"

namespace mixbeam {

/// Unit vector along `curve.axis`.
Vector3 axis_direction(const Curve& curve);

/// From the nearest point of the axis to `position`; its length is the radius. Arc and helix.
Vector3 radius_vector(const Curve& curve, const Vector3& position);

/// Whether the curve defines where it ends: arc, helix, parametric curve. Line and spline end at their end point.
bool defines_end(const Curve& curve);

/// Start of a parametric curve. Throws std::invalid_argument for formulas that make no curve.
Vector3 curve_start(const Curve& curve);

/// End of an arc or helix that starts at `start`, or of a parametric curve, wherever it starts.
Vector3 curve_end(const Curve& curve, const Vector3& start);

// The following throw std::invalid_argument for a spline or parametric curve that make_reference_curve refuses.

/// Arc length; `end` matters for a line or spline only.
double curve_length(const Curve& curve, const Vector3& start, const Vector3& end);

/// Unit tangent at the start; `end` matters for a line or spline only.
Vector3 start_tangent(const Curve& curve, const Vector3& start, const Vector3& end);

/// Point at `share` (0 to 1) of the arc length of a member, such as one of its inner points.
Vector3 position_along(const Member& member, const Vector3& start, const Vector3& end, double share);

}  // namespace mixbeam
