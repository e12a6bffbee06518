/// The same scene in other units of length and force, or turned and shifted in space.
#pragma once

#include "discretization/geometry/reference_curve.hpp"
#include "discretization/mesh/mesh.hpp"
#include "discretization/scene/scene.hpp"

#include <regex>
#include <sstream>
#include <string>

namespace mixbeam {

namespace scene_change {

inline void scale(Vector3& v, double factor) {
  for (double& x : v) x *= factor;
}

inline std::string number(double x) {
  std::ostringstream text;
  text.precision(17);
  text << x;
  return "(" + text.str() + ")";
}

/// Formula of the arc length s, which is now measured in the new unit, times a factor.
inline void scale_formula(std::array<std::string, 3>& formula, double factor, double length) {
  for (std::string& text : formula)
    if (!text.empty()) {
      const std::string old_arc_length = std::regex_replace(text, std::regex("\\bs\\b"), "(s/" + number(length) + ")");
      text = number(factor) + "*(" + old_arc_length + ")";
    }
}

inline void scale_section(Section& s, double length, double force) {
  const double moment = force * length * length;
  s.axial_stiffness *= force;
  for (double& x : s.shear_stiffness) x *= force;
  s.torsional_stiffness *= moment;
  for (double& x : s.bending_stiffness) x *= moment;
  if (s.matrix)
    for (int i = 0; i < 6; ++i)
      for (int j = 0; j < 6; ++j) (*s.matrix)[i][j] *= force * (i < 3 ? 1.0 : length) * (j < 3 ? 1.0 : length);
  if (s.shape) {
    for (double* x : {&s.shape->size2, &s.shape->size3, &s.shape->wall, &s.shape->web}) *x *= length;
    s.shape->youngs_modulus *= force / (length * length);
    if (s.shape->shear_modulus) *s.shape->shear_modulus *= force / (length * length);
  }
}

inline void scale_curve(Curve& curve, double length) {
  scale(curve.center, length);
  curve.rise *= length;
  for (Vector3& point : curve.through) scale(point, length);
  for (std::string& text : curve.formula)
    if (!text.empty()) text = number(length) + "*(" + text + ")";
}

inline void scale_support(Support& support, double length, double force) {
  scale(support.prescribed_displacement, length);
  scale(support.displacement_stiffness, force / length);
  scale(support.rotation_stiffness, force * length);
}

}  // namespace scene_change

/// Lengths multiplied by `length`, forces by `force`; stiffnesses and moments follow.
inline Scene in_other_units(Scene scene, double length, double force) {
  using namespace scene_change;
  for (Section& section : scene.sections) scale_section(section, length, force);
  for (Point& point : scene.points) scale(point.position, length);
  for (Member& member : scene.members) scale_curve(member.curve, length);
  for (Support& support : scene.supports) scale_support(support, length, force);
  for (Joint& joint : scene.joints)
    joint.stiffness *= joint.kind == JointKind::slider ? force / length : force * length;
  for (PointLoad& load : scene.point_loads) {
    scale(load.force, force);
    scale(load.moment, force * length);
  }
  for (DistributedLoad& load : scene.distributed_loads) {
    scale(load.force, force / length);
    scale(load.couple, force);
    scale_formula(load.force_formula, force / length, length);
    scale_formula(load.couple_formula, force, length);
  }
  for (Eigenstrain& strain : scene.eigenstrains) {
    scale(strain.curvature, 1.0 / length);
    scale_formula(strain.strain_formula, 1.0, length);
    scale_formula(strain.curvature_formula, 1.0 / length, length);
  }
  return scene;
}

namespace scene_change {

inline Vector3 turned(const Mat3<double>& rotation, const Vector3& v) {
  const Vec3<double> t = rotation * Vec3<double>{{v[0], v[1], v[2]}};
  return {t[0], t[1], t[2]};
}

inline Vector3 moved(const Mat3<double>& rotation, const Vector3& shift, const Vector3& position) {
  const Vector3 t = turned(rotation, position);
  return {t[0] + shift[0], t[1] + shift[1], t[2] + shift[2]};
}

/// Formulas of the components of a spatial vector in the turned frame, absent ones standing for `constant`.
inline void turn_formula(const Mat3<double>& rotation, const Vector3& constant, const Vector3& shift,
                         std::array<std::string, 3>& formula) {
  if (formula[0].empty() && formula[1].empty() && formula[2].empty()) return;
  std::array<std::string, 3> old = formula;
  for (int i = 0; i < 3; ++i)
    if (old[i].empty()) old[i] = number(constant[i]);
  for (int i = 0; i < 3; ++i) {
    formula[i] = number(shift[i]);
    for (int j = 0; j < 3; ++j) formula[i] += "+" + number(rotation(i, j)) + "*(" + old[j] + ")";
  }
}

inline void move_curve(const Mat3<double>& rotation, const Vector3& shift, Curve& curve) {
  curve.center = moved(rotation, shift, curve.center);
  curve.axis = turned(rotation, curve.axis);
  for (Vector3& point : curve.through) point = moved(rotation, shift, point);
  for (Vector3& tangent : curve.end_tangents) tangent = turned(rotation, tangent);
  turn_formula(rotation, {}, shift, curve.formula);
}

}  // namespace scene_change

/// The scene with its supports and loads turned about the origin, then shifted. Second axes that the program would
/// choose, by a rule that knows the global frame, are those of the original scene.
inline Scene moved(const Mat3<double>& rotation, const Vector3& shift, Scene scene) {
  using namespace scene_change;
  const Mesh mesh = build_mesh(scene);
  for (std::size_t m = 0; m < scene.members.size(); ++m) {
    const Mat3<double> start = rotation_matrix(mesh.members[m].curve.triad(0.0));
    scene.members[m].second_axis = turned(rotation, {start(0, 1), start(1, 1), start(2, 1)});
    move_curve(rotation, shift, scene.members[m].curve);
  }
  for (Point& point : scene.points) point.position = moved(rotation, shift, point.position);
  for (Joint& joint : scene.joints) joint.axis = turned(rotation, joint.axis);
  for (Support& support : scene.supports)
    for (Vector3& axis : support.axes) axis = turned(rotation, axis);
  for (PointLoad& load : scene.point_loads)
    if (load.frame == LoadFrame::dead) {
      load.force = turned(rotation, load.force);
      load.moment = turned(rotation, load.moment);
    }
  for (DistributedLoad& load : scene.distributed_loads)
    if (load.frame == LoadFrame::dead) {
      turn_formula(rotation, load.force, {}, load.force_formula);
      turn_formula(rotation, load.couple, {}, load.couple_formula);
      load.force = turned(rotation, load.force);
      load.couple = turned(rotation, load.couple);
    }
  return scene;
}

}  // namespace mixbeam
