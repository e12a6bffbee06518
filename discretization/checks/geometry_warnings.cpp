#include "discretization/checks/survey.hpp"

#include "discretization/geometry/point_grid.hpp"
#include "discretization/text/message_text.hpp"
#include "discretization/text/number_text.hpp"
#include "kernels/math/vector_algebra.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace mixbeam {
namespace {

using namespace vector_algebra;

// Coordinates that people type agree to six digits where they are meant to be the same.
constexpr double kSamePlace = 1e-6;  // of the size of the structure
// Walking along all members takes time in proportion to this number; beyond it the search is left out.
constexpr double kMostSteps = 3e6;
constexpr int kProjections = 8;  // each squares the error of a point's foot on a smooth curve, lines need one
constexpr std::size_t kMostOnOneMember = 100;  // between the same points: the comparison is of each with each

void add_close_points(const SceneSurvey& survey, WarningList& list) {
  const std::vector<Point>& points = survey.scene.points;
  const double tolerance = kSamePlace * survey.size;
  const PointGrid grid(points, tolerance);
  for (std::size_t i = 0; i < points.size(); ++i) {
    std::set<std::size_t> seen;  // two cells with one key would be visited twice
    grid.around(points[i].position, tolerance, [&](std::size_t j) {
      const double distance = norm(difference(points[i].position, points[j].position));
      if (j <= i || distance > tolerance || seen.size() > kMostOnOneMember || !seen.insert(j).second) return;
      list.add("pairs of coincident points", "Points / " + excerpt(points[j].name) + ": lies at " +
                                                 to_text(points[j].position) + ", " + shortest(distance) + " from \"" +
                                                 excerpt(points[i].name) +
                                                 "\", but members at them are not connected; usually they should be "
                                                 "one point");
    });
  }
}

/// Whether two members between the same points have their quarters at the same places.
bool same_course(const ReferenceCurve& a, const ReferenceCurve& b, bool reversed, double tolerance) {
  for (const double x : {0.25, 0.5, 0.75}) {
    const Vector3 on_a = to_array(a.position(x * a.length));
    const Vector3 on_b = to_array(b.position((reversed ? 1.0 - x : x) * b.length));
    if (norm(difference(on_a, on_b)) > tolerance) return false;
  }
  return true;
}

void add_equal_members(const SceneSurvey& survey, WarningList& list) {
  const std::vector<Member>& members = survey.scene.members;
  std::map<std::pair<std::string, std::string>, std::vector<std::size_t>> between;
  for (std::size_t i = 0; i < members.size(); ++i) {
    std::vector<std::size_t>& same_ends = between[std::minmax(members[i].start_point, members[i].end_point)];
    for (const std::size_t j : same_ends) {
      const bool reversed = members[i].start_point != members[j].start_point;
      if (!same_course(survey.curves[i], survey.curves[j], reversed, kSamePlace * survey.size)) continue;
      list.add("coincident members", "Members / " + excerpt(members[i].name) + ": lies on \"" +
                                         excerpt(members[j].name) +
                                         "\" all along; usually one of them was copied by mistake");
      break;
    }
    if (same_ends.size() < kMostOnOneMember) same_ends.push_back(i);
  }
}

/// Arc length of the point's foot on the curve near `s`, inside the curve.
double foot(const ReferenceCurve& curve, const Vector3& point, double s) {
  for (int i = 0; i < kProjections; ++i) {
    const Vector3 offset = difference(point, to_array(curve.position(s)));
    s = std::clamp(s + dot(offset, to_array(curve.tangent(s))), 0.0, curve.length);
  }
  return s;
}

bool knows(const Member& member, const std::string& point) {
  return member.start_point == point || member.end_point == point ||
         std::any_of(member.inner_points.begin(), member.inner_points.end(),
                     [&](const InnerPoint& inner) { return inner.point == point; });
}

/// Points inside one member that it does not know.
void add_points_on(std::size_t index, const SceneSurvey& survey, const PointGrid& grid, double step,
                   WarningList& list) {
  const Member& member = survey.scene.members[index];
  const ReferenceCurve& curve = survey.curves[index];
  const double tolerance = kSamePlace * survey.size;
  std::set<std::size_t> seen;
  const int steps = static_cast<int>(std::ceil(curve.length / step));
  for (int i = 0; i <= steps; ++i) {
    const double start = curve.length * i / steps;
    const Vector3 sample = to_array(curve.position(start));
    grid.around(sample, step, [&](std::size_t p) {
      const Point& point = survey.scene.points[p];
      // Every point of the curve is within half a step of a sample.
      if (norm(difference(point.position, sample)) > 0.5 * step + tolerance) return;
      if (seen.count(p) > 0 || knows(member, point.name)) return;
      const double s = foot(curve, point.position, start);
      if (norm(difference(point.position, to_array(curve.position(s)))) > tolerance) return;
      if (s <= tolerance || s >= curve.length - tolerance) return;  // at its ends: two points at one place
      seen.insert(p);
      list.add("points on members",
               "Points / " + excerpt(point.name) + ": lies on \"" + excerpt(member.name) + "\", " +
                   shortest(s / curve.length) +
                   " of its length from the start, but is not connected with it; usually it should "
                   "be an inner point of it");
    });
  }
}

void add_points_on_members(const SceneSurvey& survey, WarningList& list) {
  double total = 0.0;
  for (const ReferenceCurve& curve : survey.curves) total += curve.length;
  // Few points in each cell: of points that fill the space, and of those along a chain, whose box is nearly empty.
  const double filled = survey.size / std::cbrt(static_cast<double>(survey.scene.points.size()));
  const double step = std::min(filled, total / static_cast<double>(survey.curves.size()));
  if (total / step + static_cast<double>(survey.curves.size()) > kMostSteps) {
    list.add("searches", "the scene is large: not searched for points that lie on members without being connected");
    return;
  }
  const PointGrid grid(survey.scene.points, step);
  for (std::size_t i = 0; i < survey.curves.size(); ++i) add_points_on(i, survey, grid, step, list);
}

}  // namespace

SceneSurvey::SceneSurvey(const Scene& surveyed) : scene(surveyed), names(surveyed) {
  for (const Section& section : scene.sections) sections.emplace(section.name, &section);
  Box box;
  for (const Point& point : scene.points) box.enclose(point.position);
  size = box.diagonal();
  curves.reserve(scene.members.size());
  for (const Member& member : scene.members) {
    curves.push_back(
        make_reference_curve(member, names.position(member.start_point), names.position(member.end_point)));
    size = std::max(size, curves.back().length);
  }
}

std::array<double, 2> SceneSurvey::element_lengths(std::size_t member) const {
  const std::vector<double>& stations = scene.members[member].stations;
  const double length = curves[member].length;
  if (stations.empty()) return {length / scene.members[member].elements, length / scene.members[member].elements};
  double shortest = 1.0, longest = 0.0;
  for (std::size_t i = 1; i < stations.size(); ++i) {
    shortest = std::min(shortest, stations[i] - stations[i - 1]);
    longest = std::max(longest, stations[i] - stations[i - 1]);
  }
  return {shortest * length, longest * length};
}

double SceneSurvey::end_element_length(std::size_t member, int end) const {
  const std::vector<double>& stations = scene.members[member].stations;
  const double length = curves[member].length;
  if (stations.size() < 2) return length / scene.members[member].elements;
  const std::size_t last = stations.size() - 1;
  return length * (end == 0 ? stations[1] - stations[0] : stations[last] - stations[last - 1]);
}

void add_geometry_warnings(const SceneSurvey& survey, WarningList& list) {
  add_close_points(survey, list);
  add_equal_members(survey, list);
  add_points_on_members(survey, list);
}

}  // namespace mixbeam
