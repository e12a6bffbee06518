#include "apps/helix/helix_scenes.hpp"

#include <algorithm>
#include <cmath>

namespace mixbeam {

double slenderness_of(const Scene& scene, const ExactHelix& exact) {
  const Section& section = scene.sections.front();
  return exact.length() / (4.0 * std::sqrt(section.bending_stiffness[1] / section.axial_stiffness));
}

Scene with_slenderness(Scene scene, double slenderness, const ExactHelix& exact) {
  const double radius = slenderness_of(scene, exact) / slenderness;  // new over old
  const double area = std::pow(radius, 2), inertia = std::pow(radius, 4);
  for (Section& section : scene.sections) {
    section.axial_stiffness *= area;
    section.torsional_stiffness *= inertia;
    for (double& stiffness : section.shear_stiffness) stiffness *= area;
    for (double& stiffness : section.bending_stiffness) stiffness *= inertia;
  }
  for (PointLoad& load : scene.point_loads)
    for (double& component : load.moment) component *= inertia;
  return scene;
}

Scene with_turned_clamp(Scene scene, const ExactHelix& exact) {
  const Member& rod = scene.members.front();
  const auto point = [&scene](const std::string& name) -> Vector3& {
    return std::find_if(scene.points.begin(), scene.points.end(), [&](const Point& p) { return p.name == name; })
        ->position;
  };
  point(rod.end_point) = point(rod.start_point);
  point(rod.end_point)[0] += exact.length();
  scene.supports.front().prescribed_rotation = {0.0, -std::atan(exact.slope()), 0.0};
  return scene;
}

}  // namespace mixbeam
