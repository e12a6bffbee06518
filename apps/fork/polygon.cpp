#include "apps/fork/polygon.hpp"

#include "discretization/geometry/reference_curve.hpp"

#include <algorithm>

namespace mixbeam {

namespace {

Vector3 position_of(const Scene& scene, const std::string& point) {
  const auto found = std::find_if(scene.points.begin(), scene.points.end(),
                                  [&point](const Point& candidate) { return candidate.name == point; });
  return found->position;  // a scene that was read names no other points
}

/// Corner `i` of the polygon in place of a member; the ends are points of the scene.
std::string corner_name(const Member& member, int i) {
  if (i == 0) return member.start_point;
  return i == member.elements ? member.end_point : member.name + " corner " + std::to_string(i);
}

void replace_by_chain(const Member& arc, Scene& scene) {
  const ReferenceCurve curve = make_reference_curve(arc, position_of(scene, arc.start_point), {});
  for (int i = 0; i < arc.elements; ++i) {
    if (i > 0) {
      const Vec3<double> corner = curve.position(i * curve.length / arc.elements);
      scene.points.push_back({corner_name(arc, i), {corner[0], corner[1], corner[2]}});
    }
    Member side = arc;
    side.name += " side " + std::to_string(i + 1);
    side.start_point = corner_name(arc, i);
    side.end_point = corner_name(arc, i + 1);
    side.curve = Curve{};
    side.elements = 1;
    scene.members.push_back(side);
  }
}

}  // namespace

Scene with_polygons(const Scene& scene) {
  Scene result = scene;
  result.members.clear();
  for (const Member& member : scene.members) {
    if (member.curve.shape == CurveShape::circular_arc)
      replace_by_chain(member, result);
    else
      result.members.push_back(member);
  }
  return result;
}

}  // namespace mixbeam
