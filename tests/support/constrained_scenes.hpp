/// Scenes with joints, springs and supports in any axes, and the same scenes turned in space.
#pragma once

#include "kernels/element/layout.hpp"
#include "tests/support/scene_units.hpp"
#include "tests/support/scenes.hpp"

#include <cmath>
#include <random>

namespace mixbeam::test {

inline Joint joint(JointKind kind, const std::string& point, const std::vector<std::string>& members,
                   const Vector3& axis = {0, 0, 1}, double stiffness = 0.0) {
  return {"joint at " + point, point, members, kind, axis, stiffness};
}

/// A hinge about e3.
inline Support hinged(const std::string& point) { return support(point, kHeld, {true, true, false}); }

inline Vec to_vec(const Vector3& v) { return {{v[0], v[1], v[2]}}; }
inline Vector3 to_array(const Vec& v) { return {v[0], v[1], v[2]}; }
inline Vector3 turned(const Mat& rotation, const Vector3& v) { return to_array(rotation * to_vec(v)); }
inline Scene turned(const Mat& rotation, const Scene& scene) { return moved(rotation, {0, 0, 0}, scene); }

inline Mat some_rotation() { return rotation_matrix(exp_quaternion(Vec{{0.7, -1.1, 1.9}})); }

/// A frame in a plane, of two orders: a beam on a leg with a hinged foot.
inline Scene angle_frame(int elements) {
  Scene scene = cantilever(section(1e4, 5e3, 1.0, 1.0), 1.0, 2, elements);
  scene.name = "frame";
  scene.points.push_back({"foot", {1, -1, 0}});
  scene.members.push_back(line("leg", "tip", "foot", 3, elements - 1));
  scene.supports.push_back(hinged("foot"));
  scene.point_loads = {dead_load("tip", {1, 2, 0})};
  return scene;
}

/// A portal in space with a hinge, a ball joint and a slider, axes in general directions, springs, and supports of
/// every kind: the left leg clamped, the right one held by springs and one fixed rotation, the strut by a hinge.
inline Scene portal_of_joints(int order, int elements, double load = 1.0) {
  Scene scene;
  scene.name = "portal of joints";
  scene.sections = {section(1e4, 5e3, 80, 100)};
  scene.points = {{"A", {0, 0, 0}}, {"B", {0, 3, 0}}, {"C", {2, 3.5, 0.3}}, {"D", {4, 3, 0}},
                  {"E", {4, 0, 0}}, {"F", {2, 3, 2}}, {"G", {5, 3, 1}}};
  scene.members = {line("left", "A", "B", order, elements),   line("beam 1", "B", "C", order, elements),
                   line("beam 2", "C", "D", order, elements), line("right", "D", "E", order, elements),
                   line("strut", "C", "F", order, elements),  line("arm", "D", "G", order, elements)};
  scene.members[2].second_axis = {0, 0, 1};  // a follower load refers to it, wherever the scene is turned
  scene.joints = {joint(JointKind::hinge, "B", {"beam 1"}, {0.2, 0.3, 1}, 15.0), joint(JointKind::ball, "C", {"strut"}),
                  joint(JointKind::hinge, "D", {"right"}, {0.1, -0.2, 1}),
                  joint(JointKind::slider, "D", {"arm"}, {1, 0.2, -0.3}, 60.0)};
  Support springs = clamp("E");
  springs.axes = {{{0, 0.6, 0.8}, {1, 0, 0}, {0, 0.8, -0.6}}};
  springs.displacement_fixed = {true, false, true};
  springs.displacement_stiffness = {0, 200.0, 0};
  springs.rotation_fixed = {false, true, false};
  springs.rotation_stiffness = {50.0, 0, 70.0};
  Support strut = hinged("F");
  strut.axes = {{{0, 0, 1}, {1, 0, 0}, {0, 1, 0}}};
  scene.supports = {clamp("A"), springs, strut};
  scene.point_loads = {dead_load("B", {2 * load, -3 * load, load}),
                       dead_load("C", {load, -5 * load, 2 * load}, {load, 2 * load, -load}),
                       dead_load("G", {-load, -4 * load, 3 * load}, {0, load, 2 * load}),
                       follower_load("D", "beam 2", {0, 2 * load, 0}, {load, 0, -load})};
  scene.distributed_loads = {{"arm", {0, -load, 0.5 * load}, {}, 1}, {"beam 1", {0, -load, 0}, {}, 1}};
  return scene;
}

// ---- a shallow truss of two bars on hinges (von Mises): strains are l / l0 - 1, so everything is elementary

inline constexpr double kTrussHalfSpan = 1.0, kTrussRise = 0.3, kTrussAxial = 100.0;

/// An arch of radius 1 under a force at its crown, which is guided or not; `half`: its half angle.
inline Scene loaded_arch(const Support& ends, bool guided, double force, double half = 0.5) {
  const double x = std::sin(half), y = std::cos(half);
  Scene scene = structure({{"left", {-x, y, 0}}, {"crown", {0, 1, 0}}, {"right", {x, y, 0}}},
                          {arc("left half", "left", "crown", {0, 0, 0}, {0, 0, -1}, half, 4, 6),
                           arc("right half", "crown", "right", {0, 0, 0}, {0, 0, -1}, half, 4, 6)},
                          {ends, ends, support("crown", {guided, false, true}, {true, true, guided})},
                          {dead_load("crown", {0, -force, 0})}, section(1e4, 1e4, 1.0, 1.0));
  scene.name = "arch";
  scene.supports[0].point = "left";
  scene.supports[1].point = "right";
  return scene;
}

/// `force` downwards at the apex, which is guided in the plane.
inline Scene shallow_truss(double force) {
  Scene scene = structure(
      {{"left", {-kTrussHalfSpan, 0, 0}}, {"apex", {0, kTrussRise, 0}}, {"right", {kTrussHalfSpan, 0, 0}}},
      {line("left bar", "left", "apex", 2, 1), line("right bar", "apex", "right", 2, 1)},
      {hinged("left"), hinged("right"), support("apex", {true, false, true}, {})}, {dead_load("apex", {0, -force, 0})},
      section(kTrussAxial, kTrussAxial, 1e2, 1e2));  // too stiff to buckle between the hinges
  scene.name = "shallow truss";
  scene.joints = {joint(JointKind::hinge, "apex", {"right bar"})};
  return scene;
}

/// Force at which the apex has gone down by v.
inline double truss_force(double v) {
  const double length0 = std::hypot(kTrussHalfSpan, kTrussRise), height = kTrussRise - v,
               length = std::hypot(kTrussHalfSpan, height);
  return 2.0 * kTrussAxial * (1.0 / length - 1.0 / length0) * height;
}

}  // namespace mixbeam::test
