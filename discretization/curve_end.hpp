/// Where an undeformed member ends, how long it is and which way it starts; enough to check a scene.
#pragma once

#include "discretization/scene.hpp"

namespace mixbeam {

/// Unit vector along `curve.axis`.
Vector3 axis_direction(const Curve& curve);

/// From the nearest point of the axis to `position`; its length is the radius. Arc and helix.
Vector3 radius_vector(const Curve& curve, const Vector3& position);

/// End of an arc or helix that starts at `start`.
Vector3 curve_end(const Curve& curve, const Vector3& start);

/// Arc length; `end` matters for a line only.
double curve_length(const Curve& curve, const Vector3& start, const Vector3& end);

/// Unit tangent at the start; `end` matters for a line only.
Vector3 start_tangent(const Curve& curve, const Vector3& start, const Vector3& end);

}  // namespace mixbeam
