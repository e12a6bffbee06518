/// Whether two members between the same two points are one and the same beam.
#pragma once

#include "discretization/geometry/reference_curve.hpp"
#include "discretization/scene/scene.hpp"

#include <optional>
#include <string>

namespace mixbeam {

/// A member with all that a comparison needs; `start` and `end` are the positions of its points.
struct PlacedMember {
  const Member& member;
  const Vector3& start;
  const Vector3& end;
  const Section& section;

  ReferenceCurve curve() const { return make_reference_curve(member, start, end); }
};

/// g2(s), spatial.
Vector3 axis2(const ReferenceCurve& curve, double s);

enum class SameLine { forward, backward };  ///< direction of the second member along the first

/// Whether the centerlines of two members that share both points coincide up to `tolerance` [length], and how.
std::optional<SameLine> same_centerline(const PlacedMember& a, const PlacedMember& b, double tolerance);

/// What two members on the same centerline do not agree in, a parameter like "Section" or more; empty if they are the
/// same beam.
std::string difference_between(const PlacedMember& a, const PlacedMember& b, SameLine direction);

}  // namespace mixbeam
