#include "apps/common/studies/variants.hpp"

#include "kernels/math/vector_algebra.hpp"

#include <algorithm>
#include <cmath>

namespace mixbeam {

namespace {

bool is_clamp(const Support& support, const std::string& point) {
  const std::array<bool, 3> all = {true, true, true};
  return support.point == point && support.displacement_fixed == all && support.rotation_fixed == all &&
         support.prescribed_displacement == Vector3{} && support.prescribed_rotation == Vector3{};
}

}  // namespace

const Vector3& position_of(const Scene& scene, const std::string& point) {
  return std::find_if(scene.points.begin(), scene.points.end(), [&](const Point& p) { return p.name == point; })
      ->position;
}

const Section& section_of(const Scene& scene, const Member& member) {
  return *std::find_if(scene.sections.begin(), scene.sections.end(),
                       [&](const Section& s) { return s.name == member.section; });
}

Member straight_member(const std::string& start, const std::string& end, const std::string& section, int order,
                       int elements) {
  Member member;
  member.name = start + " to " + end;
  member.start_point = start;
  member.end_point = end;
  member.section = section;
  member.order = order;
  member.elements = elements;
  return member;
}

Support support_of(const std::string& point, const std::array<bool, 3>& displacement,
                   const std::array<bool, 3>& rotation) {
  Support support;
  support.point = point;
  support.displacement_fixed = displacement;
  support.rotation_fixed = rotation;
  return support;
}

bool is_straight_cantilever(const Scene& scene) {
  if (scene.members.size() != 1 || scene.supports.size() != 1 || scene.point_loads.size() != 1) return false;
  if (!scene.distributed_loads.empty() || !scene.eigenstrains.empty() || !scene.joints.empty() || scene.stages != 1)
    return false;
  const Member& rod = scene.members.front();
  const PointLoad& load = scene.point_loads.front();
  if (rod.curve.shape != CurveShape::line || position_of(scene, rod.start_point) != Vector3{}) return false;
  const Vector3& end = position_of(scene, rod.end_point);
  return end[0] > 0.0 && end[1] == 0.0 && end[2] == 0.0 && is_clamp(scene.supports.front(), rod.start_point) &&
         load.point == rod.end_point && load.frame == LoadFrame::dead;
}

bool asks_for_path(const SolverParameters& parameters, const std::vector<ExpectedValue>& expected,
                   const std::string& load_case, const Scene& scene) {
  const AnalysisParameters& analysis = parameters.analysis;
  const LoadPathParameters& path = parameters.load_path;
  const bool by_analysis =
      analysis.trace || analysis.control || analysis.branch != Branch::primary || analysis.buckling_modes > 0;
  const bool by_steps = path.method == LoadPathMethod::fixed && path.steps > 1;
  const bool by_values = std::any_of(expected.begin(), expected.end(), [&](const ExpectedValue& value) {
    return value.load_case == load_case &&
           (value.critical_point || value.load_factor.value_or(scene.stages) != scene.stages);
  });
  return by_analysis || by_steps || by_values || scene.stages > 1;
}

Scene with_mesh(Scene scene, int order, int elements_per_member) {
  for (Member& member : scene.members) {
    member.order = order;
    member.elements = elements_per_member;
  }
  return scene;
}

Scene with_side(Scene scene, double side) {
  const double area = std::pow(side, 2), inertia = std::pow(side, 4);
  for (Section& section : scene.sections) {
    section.axial_stiffness *= area;
    section.torsional_stiffness *= inertia;
    for (double& shear : section.shear_stiffness) shear *= area;
    for (double& bending : section.bending_stiffness) bending *= inertia;
  }
  return with_loads(std::move(scene), inertia);
}

Scene with_loads(Scene scene, double factor) {
  const auto scale = [factor](Vector3& vector) { vector = vector_algebra::scaled(factor, vector); };
  for (PointLoad& load : scene.point_loads) {
    scale(load.force);
    scale(load.moment);
  }
  for (DistributedLoad& load : scene.distributed_loads) {
    scale(load.force);
    scale(load.couple);
  }
  return scene;
}

SolverParameters with_fixed_steps(SolverParameters parameters, int steps) {
  parameters.load_path.method = LoadPathMethod::fixed;
  parameters.load_path.steps = steps;
  return parameters;
}

}  // namespace mixbeam
