/// The part of SceneReader that checks where members are and completes their points.

#include "discretization/curve_end.hpp"
#include "discretization/message_text.hpp"
#include "discretization/number_text.hpp"
#include "discretization/reference_curve.hpp"
#include "discretization/scene_reader.hpp"
#include "discretization/vector_algebra.hpp"

#include <algorithm>
#include <cmath>

namespace mixbeam {
namespace {

using namespace vector_algebra;

// Points are written with a dozen digits or more, and computed ends carry rounding only.
constexpr double kEndTolerance = 1e-9;  // of the curve length
// Below this share of the coordinates, a length consists of rounding errors.
constexpr double kShortestRelativeLength = 1e-12;

}  // namespace

/// The end of an arc or helix may be a new point, where the next one starts: follow them from known points.
void SceneReader::place_curve_ends() {
  std::unordered_map<std::string, std::vector<std::size_t>> waiting;  // start point -> curved members
  std::vector<std::size_t> ready;
  for (std::size_t i = scene_.members.size(); i-- > 0;) {
    const Member& member = scene_.members[i];
    if (member.curve.shape == CurveShape::line) continue;
    if (point_index_.count(member.start_point) > 0)
      ready.push_back(i);
    else
      waiting[member.start_point].push_back(i);
  }
  while (!ready.empty()) {
    const std::size_t i = ready.back();
    ready.pop_back();
    place_curve_end(i);
    const auto next = waiting.find(scene_.members[i].end_point);
    if (next == waiting.end()) continue;
    ready.insert(ready.end(), next->second.begin(), next->second.end());
    waiting.erase(next);
  }
}

void SceneReader::place_curve_end(std::size_t member_index) {
  const Member& member = scene_.members[member_index];
  check_curve(member);
  const Vector3 start = position_of(member.start_point);
  const Vector3 end = curve_end(member.curve, start);
  const double length = curve_length(member.curve, start, end);
  const auto [known, is_new] = point_index_.emplace(member.end_point, scene_.points.size());
  if (is_new) {
    scene_.points.push_back(Point{member.end_point, end});
    return;
  }
  const Vector3& declared = scene_.points[known->second].position;
  if (norm(difference(declared, end)) <= kEndTolerance * length) return;
  throw source_.error(member_path(member, "End"), "value \"" + excerpt(member.end_point) + "\" is at " +
                                                      to_text(declared) + ", but the curve ends at " + to_text(end) +
                                                      "; allowed: equal to 1e-9 of the curve length " +
                                                      shortest(length) + ", or a new name");
}

void SceneReader::check_curve(const Member& member) const {
  const Curve& curve = member.curve;
  const ParameterPath path = member_path(member, "Curve");
  const Vector3 start = position_of(member.start_point);
  const Vector3 from_center = difference(start, curve.center);
  const double radius = norm(radius_vector(curve, start));
  if (radius < kShortestLength || radius <= kShortestRelativeLength * (norm(from_center) + norm(start))) {
    throw source_.error(child(path, "Center"), "value " + to_text(curve.center) + ": the start point \"" +
                                                   excerpt(member.start_point) +
                                                   "\" lies on the axis; allowed: a radius > 0");
  }
  const double height = dot(from_center, axis_direction(curve));
  if (curve.shape == CurveShape::circular_arc && std::abs(height) > kEndTolerance * radius) {
    const Vector3 center = sum(curve.center, scaled(height, axis_direction(curve)));
    throw source_.error(child(path, "Center"), "value " + to_text(curve.center) +
                                                   " is not in the plane of the arc; allowed: " + to_text(center) +
                                                   " for this start point and axis");
  }
  const double arc = radius * curve.angle;
  if (arc < kShortestLength || arc < kShortestRelativeLength * norm(start)) {
    throw source_.error(child(path, "Angle"),
                        "value " + shortest(curve.angle) + ": the member has no length; allowed: larger");
  }
}

void SceneReader::check_members() {
  point_touched_.assign(scene_.points.size(), false);
  for (const Member& member : scene_.members) {
    for (const std::string parameter : {"Start", "End"}) {
      const std::string& point = parameter == "Start" ? member.start_point : member.end_point;
      const auto known = point_index_.find(point);
      if (known == point_index_.end()) throw unknown(member_path(member, parameter), "point", point, point_index_);
      point_touched_[known->second] = true;
    }
    if (section_index_.count(member.section) == 0) {
      throw unknown(member_path(member, "Section"), "section", member.section, section_index_);
    }
    if (member.curve.shape == CurveShape::line) check_line(member);
    check_second_axis(member);
  }
}

void SceneReader::check_line(const Member& member) const {
  const Vector3& start = position_of(member.start_point);
  const Vector3& end = position_of(member.end_point);
  const double length = norm(difference(end, start));
  if (length >= kShortestLength && length > kShortestRelativeLength * std::max(norm(start), norm(end))) return;
  throw source_.error(member_path(member), "no length: it starts at \"" + excerpt(member.start_point) + "\" " +
                                               to_text(start) + " and ends at \"" + excerpt(member.end_point) + "\" " +
                                               to_text(end) + "; allowed: two different positions");
}

void SceneReader::check_second_axis(const Member& member) const {
  if (!list_.sublist("Members").sublist(member.name).isParameter("Second Axis")) return;
  const ParameterPath path = member_path(member, "Second Axis");
  const double size = norm(member.second_axis);
  if (size < kShortestLength) {
    throw source_.error(path, "value " + to_text(member.second_axis) + "; allowed: any vector but zero");
  }
  const Vector3 tangent = start_tangent(member.curve, position_of(member.start_point), position_of(member.end_point));
  if (norm(cross(tangent, scaled(1.0 / size, member.second_axis))) >= kSmallestSecondAxisAngle) return;
  throw source_.error(path, "value " + to_text(member.second_axis) + " is parallel to the start tangent " +
                                to_text(tangent) + "; allowed: any other direction");
}

}  // namespace mixbeam
