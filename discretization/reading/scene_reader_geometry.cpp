/// The part of SceneReader that checks where members are and completes their points.

#include "discretization/geometry/placement.hpp"
#include "discretization/geometry/reference_curve.hpp"
#include "discretization/reading/scene_reader.hpp"
#include "discretization/scene/section_law.hpp"
#include "discretization/text/message_text.hpp"
#include "discretization/text/number_text.hpp"
#include "discretization/text/result_names.hpp"
#include "kernels/math/vector_algebra.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <queue>
#include <stdexcept>

namespace mixbeam {
namespace {

using namespace vector_algebra;

// Below this share of the coordinates, a length consists of rounding errors.
constexpr double kShortestRelativeLength = 1e-12;

/// One element for each length, the others where they are longest. Takes the logarithm of the lines for each line, and
/// nothing for each element.
std::vector<int> shared_by_length(int elements, const std::vector<double>& lengths) {
  const double whole = std::accumulate(lengths.begin(), lengths.end(), 0.0);
  const int spare = elements - static_cast<int>(lengths.size());
  std::vector<int> shares(lengths.size(), 1);
  if (spare <= 0 || !(whole > 0.0)) return shares;
  std::priority_queue<std::pair<double, std::size_t>> longest;
  int left = elements;
  for (std::size_t i = 0; i < lengths.size(); ++i) {
    shares[i] = std::max(1, static_cast<int>(spare * (lengths[i] / whole)));
    left -= shares[i];
    longest.emplace(lengths[i] / shares[i], i);
  }
  for (; left > 0; --left) {
    const std::size_t i = longest.top().second;
    longest.pop();
    longest.emplace(lengths[i] / ++shares[i], i);
  }
  return shares;
}

/// Names in the order of the scene.
std::vector<std::string> in_order(const std::unordered_map<std::string, std::size_t>& index) {
  std::vector<std::string> names(index.size());
  for (const auto& [name, i] : index) names[i] = name;
  return names;
}

}  // namespace

void SceneReader::place_members() {
  const auto needed = [this](const Member& member) { return points_needed(member); };
  for (const std::size_t member : placement_order(scene_, needed))
    if (!geometry_of(member).attempt([&] { place_member(member); })) place_.source().cannot_mend();
}

/// What must be known before a member can be placed.
std::vector<std::string> SceneReader::points_needed(const Member& member) const {
  const auto arc = open_arcs_.find(member_index_.at(member.name));
  const bool needs_end = arc == open_arcs_.end() ? !defines_end(member.curve) : arc->second.needs_end();
  if (needs_end && member.end_point != member.start_point) return {member.start_point, member.end_point};
  return {member.start_point};
}

void SceneReader::place_member(std::size_t index) {
  const CurveShape shape = scene_.members[index].curve.shape;
  if (shape == CurveShape::circular_arc) complete_open_arc(index);
  if (shape == CurveShape::circular_arc || shape == CurveShape::helix) check_curve(index);
  const Member& member = scene_.members[index];
  if (shape == CurveShape::line && !member.inner_points.empty()) check_line(index);
  const Vector3 start = position_of(member.start_point);  // a copy: points are added
  for (const PointOfMember& point : points_of_member(member, start, [&] { return reference_curve_of(index); }))
    place_point(point, index);
}

void SceneReader::complete_open_arc(std::size_t index) {
  const auto arc = open_arcs_.find(index);
  if (arc == open_arcs_.end()) return;
  Member& member = scene_.members[index];
  const Vector3 start = position_of(member.start_point);
  const Vector3 end = arc->second.needs_end() ? position_of(member.end_point) : start;
  try {
    complete_arc(member.curve, arc->second, start, end);
  } catch (const std::invalid_argument& problem) {
    const std::string name = arc->second.given == ArcDefinition::Given::point ? "Through" : "Radius";
    throw member_error(index, {"Curve", name}, std::string("there is no such arc: ") + problem.what());
  }
}

/// Curve of a member whose points are known as far as it needs them.
ReferenceCurve SceneReader::reference_curve_of(std::size_t index) const {
  const Member& member = scene_.members[index];
  const Vector3& start = position_of(member.start_point);
  const auto end = point_index_.find(member.end_point);
  try {
    return make_reference_curve(member, start, end == point_index_.end() ? start : scene_.points[end->second].position);
  } catch (const std::invalid_argument& problem) {
    throw member_error(index, {"Curve"},
                       std::string(problem.what()) + "; allowed: a smooth curve that never stops or turns back");
  }
}

/// Adds the point, or checks that it is there.
void SceneReader::place_point(const PointOfMember& placed, std::size_t member) {
  using Role = PointOfMember::Role;
  const Role role = placed.role;
  const ParameterPath parameter = role == Role::start ? ParameterPath{"Start"}
                                  : role == Role::end ? ParameterPath{"End"}
                                                      : ParameterPath{"Inner Points", placed.point};
  const Problem problem = result_name_problem(placed.point);
  if (!problem.empty()) throw member_error(member, parameter, "name " + problem);
  if (add_point(placed.point, placed.position)) return;
  const Vector3& declared = position_of(placed.point);
  if (norm(difference(declared, placed.position)) <= kPlaceTolerance * placed.length) return;
  const std::string where = role == Role::start ? "formulas begin at "
                            : role == Role::end ? "curve ends at "
                                                : "curve passes at ";
  throw member_error(member, parameter,
                     "value \"" + excerpt(placed.point) + "\" is at " + to_text(declared) + ", but the " + where +
                         to_text(placed.position) + "; allowed: equal to 1e-9 of the curve length " +
                         shortest(placed.length) + (role == Role::start ? "" : ", or a new name"));
}

void SceneReader::check_curve(std::size_t index) const {
  const Member& member = scene_.members[index];
  const Curve& curve = member.curve;
  const Vector3 start = position_of(member.start_point);
  const Vector3 from_center = difference(start, curve.center);
  const double radius = norm(radius_vector(curve, start));
  if (radius < kShortestLength || radius <= kShortestRelativeLength * (norm(from_center) + norm(start))) {
    throw member_error(index, {"Curve", "Center"},
                       "value " + to_text(curve.center) + ": the start point \"" + excerpt(member.start_point) +
                           "\" lies on the axis; allowed: a radius > 0");
  }
  const double height = dot(from_center, axis_direction(curve));
  if (curve.shape == CurveShape::circular_arc && std::abs(height) > kPlaceTolerance * radius) {
    const Vector3 center = sum(curve.center, scaled(height, axis_direction(curve)));
    throw member_error(index, {"Curve", "Center"},
                       "value " + to_text(curve.center) + " is not in the plane of the arc; allowed: " +
                           to_text(center) + " for this start point and axis");
  }
  const double arc = radius * curve.angle;
  if (arc < kShortestLength || arc < kShortestRelativeLength * norm(start)) {
    throw member_error(index, {"Curve", "Angle"},
                       "value " + shortest(curve.angle) + ": the member has no length; allowed: larger");
  }
}

/// Elements of polylines: one for each line, the others in proportion to the lengths.
void SceneReader::share_out_elements() {
  for (const Polyline& polyline : polylines_) {
    std::vector<double> lengths;
    for (std::size_t i = 0; i < polyline.lines; ++i) {
      const Member& line = scene_.members[polyline.first_member + i];
      const auto start = point_index_.find(line.start_point), end = point_index_.find(line.end_point);
      if (start == point_index_.end() || end == point_index_.end()) return;  // check_members will say it
      lengths.push_back(norm(difference(scene_.points[end->second].position, scene_.points[start->second].position)));
    }
    const std::vector<int> elements = shared_by_length(polyline.elements, lengths);
    for (std::size_t i = 0; i < polyline.lines; ++i) scene_.members[polyline.first_member + i].elements = elements[i];
  }
}

void SceneReader::check_members() {
  point_touched_.assign(scene_.points.size(), false);
  for (std::size_t i = 0; i < scene_.members.size(); ++i) {
    check_known(i, &Member::start_point, "Start", "point", point_index_);
    check_known(i, &Member::end_point, "End", "point", point_index_);
    check_known(i, &Member::section, "Section", "section", section_index_);
    if (!scene_.members[i].end_section.empty())
      check_known(i, &Member::end_section, "End Section", "section", section_index_);
    place_.source().require_mended();
    geometry_of(i).attempt([&] { check_member(i); });
  }
}

/// Where mistakes of its geometry count: in the whole scene as long as there are others, from which they may follow.
InputPlace SceneReader::geometry_of(std::size_t member) const {
  return place_.source().has_mistakes() ? place_ : place_["Members"][scene_.members[member].name];
}

void SceneReader::check_known(std::size_t index, std::string Member::*name, const std::string& parameter,
                              const std::string& what, const Index& known) {
  Member& member = scene_.members[index];
  std::string& given = member.*name;
  if (known.count(given) > 0) return;
  const std::vector<std::string> names = in_order(known);
  place_["Members"][member.name][parameter].attempt([&] {
    const std::string seen =
        given.empty() ? "missing " + what : "value \"" + excerpt(given) + "\" is not a " + what + " of the scene";
    throw member_error(index, {parameter}, seen + "; allowed: " + quoted_list(names) + did_you_mean(given, names));
  });
  const std::string nearest = nearest_name(given, names);
  const bool is_anywhere = member.curve.shape != CurveShape::line || !member.inner_points.empty();
  if (names.empty() || (what == "point" && is_anywhere)) return place_.source().cannot_mend();
  given = nearest.empty() ? names.front() : nearest;
}

void SceneReader::check_member(std::size_t i) {
  const Member& member = scene_.members[i];
  touch_point(member.start_point);
  touch_point(member.end_point);
  for (const InnerPoint& inner : member.inner_points) touch_point(inner.point);
  if (!member.end_section.empty()) check_taper_values(i);
  if (member.curve.shape == CurveShape::line) check_line(i);
  if (member.curve.shape == CurveShape::spline || member.keeps_second_axis || member.second_axis_from)
    reference_curve_of(i);
  if (!is_zero(member.second_axis)) check_second_axis(i);
}

/// At the vertices and the samples of the elements; between them the elements look themselves.
void SceneReader::check_taper_values(std::size_t index) const {
  constexpr int kMostPlaces = 20'000;  // of a member: a hundredth of a second
  const Member& member = scene_.members[index];
  const int places = std::min(kMostPlaces, member.elements) * std::max(4, 2 * member.order);
  try {
    const SectionLaw law(scene_, member);
    for (int i = 0; i <= places; ++i) law.compliance(static_cast<double>(i) / places);
  } catch (const std::invalid_argument& problem) {
    throw member_error(index, {member.taper.empty() ? "End Section" : "Taper"}, problem.what());
  }
}

void SceneReader::check_line(std::size_t index) const {
  const Member& member = scene_.members[index];
  const Vector3& start = position_of(member.start_point);
  const Vector3& end = position_of(member.end_point);
  const double length = norm(difference(end, start));
  if (length >= kShortestLength && length > kShortestRelativeLength * std::max(norm(start), norm(end))) return;
  throw member_error(index, {},
                     "no length: it starts at \"" + excerpt(member.start_point) + "\" " + to_text(start) +
                         " and ends at \"" + excerpt(member.end_point) + "\" " + to_text(end) +
                         "; allowed: two different positions");
}

void SceneReader::check_second_axis(std::size_t index) const {
  const Member& member = scene_.members[index];
  if (member.curve.shape == CurveShape::spline || member.curve.shape == CurveShape::parametric) return;  // done
  const Vector3 tangent = start_tangent(member.curve, position_of(member.start_point), position_of(member.end_point));
  if (norm(cross(tangent, scaled(1.0 / norm(member.second_axis), member.second_axis))) >= kSmallestSecondAxisAngle)
    return;
  throw member_error(index, {"Second Axis"},
                     "value " + to_text(member.second_axis) + " is parallel to the start tangent " + to_text(tangent) +
                         "; allowed: any other direction");
}

}  // namespace mixbeam
