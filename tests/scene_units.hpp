/// The same scene in other units of length and force.
#pragma once

#include "discretization/scene.hpp"

#include <cstdio>
#include <string>

namespace mixbeam {

/// A formula times a factor.
inline void scale_formula(std::string& formula, double factor) {
  if (formula.empty()) return;
  char digits[32];
  std::snprintf(digits, sizeof digits, "%.17g", factor);
  formula = std::string(digits) + " * (" + formula + ")";
}

/// Lengths multiplied by `length`, forces by `force`; stiffnesses and moments follow. Formulas along members may use x,
/// not s.
inline Scene in_other_units(Scene scene, double length, double force) {
  const auto scale = [](Vector3& v, double factor) {
    for (double& x : v) x *= factor;
  };
  for (Section& s : scene.sections) {
    s.axial_stiffness *= force;
    for (double& x : s.shear_stiffness) x *= force;
    s.torsional_stiffness *= force * length * length;
    for (double& x : s.bending_stiffness) x *= force * length * length;
    if (s.matrix)
      for (int i = 0; i < 6; ++i)
        for (int j = 0; j < 6; ++j) (*s.matrix)[i][j] *= force * (i < 3 ? 1.0 : length) * (j < 3 ? 1.0 : length);
    if (!s.shape) continue;
    for (double* x : {&s.shape->size2, &s.shape->size3, &s.shape->wall, &s.shape->web}) *x *= length;
    s.shape->youngs_modulus *= force / (length * length);
    if (s.shape->shear_modulus) *s.shape->shear_modulus *= force / (length * length);
  }
  for (Point& point : scene.points) scale(point.position, length);
  for (Member& member : scene.members) {
    scale(member.curve.center, length);
    for (Vector3& point : member.curve.through) scale(point, length);
    member.curve.rise *= length;
  }
  for (Support& support : scene.supports) scale(support.prescribed_displacement, length);
  for (PointLoad& load : scene.point_loads) {
    scale(load.force, force);
    scale(load.moment, force * length);
  }
  for (DistributedLoad& load : scene.distributed_loads) {
    scale(load.force, force / length);
    scale(load.couple, force);
    for (std::string& formula : load.force_formula) scale_formula(formula, force / length);
    for (std::string& formula : load.couple_formula) scale_formula(formula, force);
  }
  for (Eigenstrain& strain : scene.eigenstrains) {
    scale(strain.curvature, 1.0 / length);
    for (std::string& formula : strain.curvature_formula) scale_formula(formula, 1.0 / length);
  }
  return scene;
}

}  // namespace mixbeam
