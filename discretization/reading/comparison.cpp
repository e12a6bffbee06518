#include "discretization/reading/comparison.hpp"

#include "discretization/reading/scene_parts.hpp"
#include "discretization/scene/division.hpp"
#include "discretization/scene/section_shape.hpp"
#include "kernels/math/vector_algebra.hpp"

#include <algorithm>
#include <cmath>

namespace mixbeam {
namespace {

using namespace vector_algebra;

constexpr double kSameAngle = 1e-6;  // of axes 2, whose directions are written with six digits. [radian]

bool coincide(const ReferenceCurve& a, const ReferenceCurve& b, SameLine direction, double tolerance) {
  for (const double x : {0.0, 0.25, 0.5, 0.75, 1.0}) {
    const double y = direction == SameLine::forward ? x : 1.0 - x;
    const Vector3 from_a = to_array(a.position(x * a.length)), from_b = to_array(b.position(y * b.length));
    if (norm(difference(from_a, from_b)) > tolerance) return false;
  }
  return true;
}

/// Whether it does not matter how the section is turned about the tangent.
bool is_isotropic(const Section& section) {
  return !section.matrix && section.shear_stiffness[0] == section.shear_stiffness[1] &&
         section.bending_stiffness[0] == section.bending_stiffness[1];
}

/// Uncoupled sections do not feel a half turn about the tangent.
bool same_axes(const PlacedMember& a, const PlacedMember& b, SameLine direction) {
  if (is_isotropic(a.section) && a.member.end_section.empty()) return true;
  const ReferenceCurve along_a = a.curve(), along_b = b.curve();
  const Vector3 first = axis2(along_a, 0.0);
  const Vector3 second = axis2(along_b, direction == SameLine::forward ? 0.0 : along_b.length);
  const bool one_sided = a.section.shape && consists_of_rectangles(a.section.shape->kind);
  const bool sign_matters = a.section.matrix.has_value() || one_sided;
  if (sign_matters && (direction == SameLine::backward || dot(first, second) < 0.0)) return false;
  return norm(cross(first, second)) <= kSameAngle;
}

bool same_inner_points(const Member& a, const Member& b, SameLine direction) {
  if (a.inner_points.size() != b.inner_points.size() || a.stations.size() != b.stations.size()) return false;
  const bool forward = direction == SameLine::forward;
  for (std::size_t i = 0; i < a.inner_points.size(); ++i) {
    const InnerPoint& other = b.inner_points[forward ? i : b.inner_points.size() - 1 - i];
    if (a.inner_points[i].point != other.point) return false;
  }
  for (std::size_t i = 0; i < a.stations.size(); ++i) {
    const double other = forward ? b.stations[i] : 1.0 - b.stations[b.stations.size() - 1 - i];
    if (std::abs(a.stations[i] - other) > kStationTolerance) return false;
  }
  return true;
}

}  // namespace

Vector3 axis2(const ReferenceCurve& curve, double s) {
  return to_array(rotation_matrix(curve.triad(s)) * Vec3<double>{{0.0, 1.0, 0.0}});
}

std::optional<SameLine> same_centerline(const PlacedMember& a, const PlacedMember& b, double tolerance) {
  const bool closed = a.member.start_point == a.member.end_point;
  const bool forward = a.member.start_point == b.member.start_point;
  const auto first = forward ? SameLine::forward : SameLine::backward;
  if (a.member.curve.shape == CurveShape::line && b.member.curve.shape == CurveShape::line) return first;
  const ReferenceCurve along_a = a.curve(), along_b = b.curve();
  if (coincide(along_a, along_b, first, tolerance)) return first;
  if (closed && coincide(along_a, along_b, SameLine::backward, tolerance)) return SameLine::backward;
  return std::nullopt;
}

std::string difference_between(const PlacedMember& a, const PlacedMember& b, SameLine direction) {
  const Member &m = a.member, &n = b.member;
  const std::string parameter = member_parameters().difference(m, n);
  if (!parameter.empty()) return "\"" + parameter + "\"";
  if (!m.end_section.empty() && direction == SameLine::backward) return "direction of the taper";
  if (!same_inner_points(m, n, direction)) return "inner points or stations";
  if (!same_axes(a, b, direction)) return "direction of axis 2";
  return "";
}

}  // namespace mixbeam
