/// Circular arcs that a user gives by other things than centre, axis and angle.
#pragma once

#include "discretization/scene/scene.hpp"

namespace mixbeam {

/// What determines an arc together with its start point (and end point, see the functions below).
struct ArcDefinition {
  enum class Given {
    point,   ///< a point on the arc between start and end
    radius,  ///< radius and axis: the arc from start to end of at most half a turn
    tangent  ///< start tangent, radius, axis and angle; the end follows
  };
  Given given = Given::point;
  Vector3 vector{};  ///< the point, or the start tangent
  double radius = 0.0;

  bool needs_end() const { return given != Given::tangent; }
};

/// Completes center, axis and angle of an arc. `end` matters unless the tangent is given.
/// Throws std::invalid_argument if there is no such arc: points on a line, a radius below half the distance, an axis
/// that is not normal to the arc.
void complete_arc(Curve& curve, const ArcDefinition& definition, const Vector3& start, const Vector3& end);

}  // namespace mixbeam
