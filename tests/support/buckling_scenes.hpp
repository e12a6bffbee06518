/// Structures with closed forms of their critical loads, inextensible and shear rigid unless a test changes them.
#pragma once

#include "tests/support/constrained_scenes.hpp"

namespace mixbeam::test {

/// A column of unit length along e1 under a unit compressive force at its tip, EI3 = 1; it buckles towards e2, because
/// EI2 = 6.
inline Scene column(int order, int elements, const std::vector<Support>& supports = {clamp("clamp")}) {
  Scene scene = cantilever(section(kRigid, kRigid, 1.0, 1.0), 1.0, order, elements);
  scene.name = "column";
  scene.sections[0].bending_stiffness = {6.0, 1.0};
  scene.members[0].second_axis = {0, 1, 0};
  scene.supports = supports;
  scene.point_loads = {dead_load("tip", {-1, 0, 0})};
  return scene;
}

struct ColumnEnds {
  const char* name;
  std::vector<Support> supports;
  double critical;  ///< P L^2 / EI
};

/// Euler's columns. Clamped and hinged: k L = tan(k L) = 4.493409457909064.
inline std::vector<ColumnEnds> euler_columns() {
  const std::array<bool, 3> across = {false, true, true}, twist = {true, false, false};
  const Support hinged_base = support("clamp", kHeld, twist);
  return {{"clamped and free", {clamp("clamp")}, 0.25 * kPi * kPi},
          {"clamped and guided", {clamp("clamp"), support("tip", {}, kHeld)}, kPi * kPi},
          {"hinged", {hinged_base, support("tip", across, {})}, kPi * kPi},
          {"clamped and hinged", {clamp("clamp"), support("tip", across, {})}, 4.493409457909064 * 4.493409457909064},
          {"clamped", {clamp("clamp"), support("tip", across, kHeld)}, 4.0 * kPi * kPi}};
}

/// Two halves of a hinged column, joined by a hinge about e3 with a spring of stiffness c.
inline Scene jointed_column(double spring, int order, int elements) {
  Scene scene = column(order, elements, euler_columns()[2].supports);
  scene.points.push_back({"middle", {0.5, 0, 0}});
  scene.members = {line("lower", "clamp", "middle", order, elements), line("upper", "middle", "tip", order, elements)};
  for (Member& member : scene.members) member.second_axis = {0, 1, 0};
  scene.joints = {joint(JointKind::hinge, "middle", {"upper"}, {0, 0, 1}, spring)};
  return scene;
}

/// Symmetric buckling of it: w = sin(k x) in the lower half has the moment P w = EI k^2 w in the joint, which turns by
/// 2 k cos(k/2): k tan(k/2) = 2 c.
inline double jointed_column_load(double spring) {
  double low = 0.0, high = kPi;
  for (int i = 0; i < 200; ++i) {
    const double k = 0.5 * (low + high);
    (k * std::tan(0.5 * k) < 2.0 * spring ? low : high) = k;
  }
  return low * low;
}

/// A narrow strip along e1, rigid in the plane of the load (e1, e2), EI2 = 2 out of it, GIt = 0.5: sqrt(EI GIt) = 1.
inline Scene strip(int order, int elements) {
  Scene scene = column(order, elements);
  scene.name = "strip";
  scene.sections[0].torsional_stiffness = 0.5;
  scene.sections[0].bending_stiffness = {2.0, kRigid};
  return scene;
}

/// End load on the clamped strip: P = 2 j sqrt(EI GIt)/L^2, j = 2.0062996717894 the first zero of J_{-1/4} (Prandtl,
/// Michell, 1899), whatever its sign.
constexpr double kNarrowCantilever = 4.0125993435789;
inline Scene narrow_cantilever(int order, int elements) {
  Scene scene = strip(order, elements);
  scene.point_loads = {dead_load("tip", {0, -1, 0})};
  return scene;
}

/// Uniform moment on the strip with forked ends: M = pi sqrt(EI GIt)/L (Michell, 1899).
inline Scene uniform_moment(int order, int elements) {
  Scene scene = strip(order, elements);
  scene.supports = {support("clamp", kHeld, {true, false, false}),
                    support("tip", {false, true, true}, {true, false, false})};
  scene.point_loads = {dead_load("clamp", {}, {0, 0, -1}), dead_load("tip", {}, {0, 0, 1})};
  return scene;
}

/// Tip force of which the part `eta` follows: cos(k L) = -eta / (1 - eta), from w'' = 0 and w''' + (1 - eta) k^2 w' = 0
/// at the tip of w = A (cos k x - 1) + B (sin k x - k x); no divergence from eta = 1/2 on.
inline Scene partial_follower(double eta, int order, int elements) {
  Scene scene = column(order, elements);
  scene.point_loads = {dead_load("tip", {-(1.0 - eta), 0, 0}), follower_load("tip", "beam", {-eta, 0, 0})};
  return scene;
}

}  // namespace mixbeam::test
