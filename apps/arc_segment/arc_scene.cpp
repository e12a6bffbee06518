#include "apps/arc_segment/arc_scene.hpp"

#include "apps/common/studies/variants.hpp"
#include "discretization/geometry/vector_algebra.hpp"
#include "discretization/text/errors.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mixbeam {

namespace {

void scale(Vector3& vector, double factor) { vector = vector_algebra::scaled(factor, vector); }

}  // namespace

ArcScene::ArcScene(const Scene& scene) : scene_(scene) {
  if (scene.members.size() != 1 || scene.members.front().curve.shape != CurveShape::circular_arc)
    throw InputError("the study needs a scene of one member, an arc; other scenes: --single");
  const Member& arc = scene.members.front();
  const auto start = std::find_if(scene.points.begin(), scene.points.end(),
                                  [&](const Point& point) { return point.name == arc.start_point; });
  const auto section = std::find_if(scene.sections.begin(), scene.sections.end(),
                                    [&](const Section& s) { return s.name == arc.section; });
  radius_ = vector_algebra::norm(vector_algebra::difference(start->position, arc.curve.center));
  const double side = std::sqrt(12.0 * section->bending_stiffness[1] / section->axial_stiffness);  // EI = EA a^2/12
  slenderness_ = radius_ / side;
}

Scene ArcScene::variant(const ArcVariant& arc) const {
  constexpr double rigid = std::numeric_limits<double>::infinity();
  Scene scene = with_mesh(scene_, arc.order, arc.elements);
  const double side = slenderness_ / arc.slenderness;  // new over old
  const double area = std::pow(side, 2), inertia = std::pow(side, 4);
  for (Section& section : scene.sections) {
    section.axial_stiffness = arc.inextensible ? rigid : area * section.axial_stiffness;
    for (double& shear : section.shear_stiffness) shear = arc.shear_rigid ? rigid : area * shear;
    section.torsional_stiffness *= inertia;
    for (double& bending : section.bending_stiffness) bending *= inertia;
  }
  for (PointLoad& load : scene.point_loads) {
    scale(load.force, inertia * arc.force_factor);
    scale(load.moment, inertia * arc.force_factor);
  }
  for (DistributedLoad& load : scene.distributed_loads) {
    scale(load.force, inertia * arc.force_factor);
    scale(load.couple, inertia * arc.force_factor);
  }
  return scene;
}

}  // namespace mixbeam
