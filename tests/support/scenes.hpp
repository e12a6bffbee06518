/// The scenes of the paper and of the references, built by the program: what the tests of the assembled equations, of
/// the solver and of whole problems share.
#pragma once

#include "discretization/scene/scene.hpp"
#include "tests/support/numbers.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <string>

namespace mixbeam::test {

constexpr double kRigid = std::numeric_limits<double>::infinity();
constexpr std::array<bool, 3> kHeld = {true, true, true};

/// The same stiffness in both directions of shear and of bending.
inline Section section(double axial, double shear, double torsion, double bending) {
  return {"section", axial, {shear, shear}, torsion, {bending, bending}};
}

inline Member line(const std::string& name, const std::string& start, const std::string& end, int order, int elements) {
  Member member;
  member.name = name;
  member.start_point = start;
  member.end_point = end;
  member.section = "section";
  member.order = order;
  member.elements = elements;
  return member;
}

inline Member arc(const std::string& name, const std::string& start, const std::string& end, const Vector3& center,
                  const Vector3& axis, double angle, int order, int elements) {
  Member member = line(name, start, end, order, elements);
  member.curve.shape = CurveShape::circular_arc;
  member.curve.center = center;
  member.curve.axis = axis;
  member.curve.angle = angle;
  return member;
}

inline Support clamp(const std::string& point) {
  Support support;
  support.point = point;
  support.displacement_fixed = support.rotation_fixed = kHeld;
  return support;
}

inline PointLoad dead_load(const std::string& point, const Vector3& force, const Vector3& moment = {}) {
  PointLoad load;
  load.point = point;
  load.force = force;
  load.moment = moment;
  return load;
}

/// Components in the triad of the member's end.
inline PointLoad follower_load(const std::string& point, const std::string& member, const Vector3& force,
                               const Vector3& moment = {}) {
  PointLoad load = dead_load(point, force, moment);
  load.frame = LoadFrame::follower;
  load.member = member;
  return load;
}

inline Support support(const std::string& point, const std::array<bool, 3>& displacement,
                       const std::array<bool, 3>& rotation) {
  Support support = clamp(point);
  support.displacement_fixed = displacement;
  support.rotation_fixed = rotation;
  return support;
}

/// Of one section; members name it "section".
inline Scene structure(const std::vector<Point>& points, const std::vector<Member>& members,
                       const std::vector<Support>& supports, const std::vector<PointLoad>& loads = {},
                       const Section& section = {}) {
  Scene scene;
  scene.sections = {section};
  if (section.name.empty()) scene.sections[0].name = "section";
  scene.points = points;
  scene.members = members;
  scene.supports = supports;
  scene.point_loads = loads;
  return scene;
}

/// A straight beam "beam" along e1 from the clamped "clamp" at the origin to "tip", without loads.
inline Scene cantilever(const Section& section, double length, int order, int elements) {
  Scene scene = structure({{"clamp", {0, 0, 0}}, {"tip", {length, 0, 0}}},
                          {line("beam", "clamp", "tip", order, elements)}, {clamp("clamp")}, {}, section);
  scene.name = "cantilever";
  return scene;
}

/// Inextensible and shear-rigid, EI = L = 1, under a dead force across its tip.
inline Scene elastica(double force, int order, int elements) {
  Scene scene = cantilever(section(kRigid, kRigid, 1.0, 1.0), 1.0, order, elements);
  scene.name = "elastica";
  scene.point_loads = {dead_load("tip", {0, force, 0})};
  return scene;
}
/// Displacement and rotation of its tip for F L^2 / EI = 10, elliptic integrals.
constexpr Vector3 kElasticaTip = {-0.5549955977538, 0.8106090248803, 0.0};
constexpr double kElasticaAngle = 1.4302855388039;

/// Cubic lattice of n points along each edge, cell 1, EI = 1; its lowest layer is clamped, and forces on the highest
/// one shear it. No members between clamped points.
inline Scene lattice(int n, int order = 1, int elements = 1) {
  Scene scene;
  scene.name = "lattice";
  scene.sections = {section(400.0, 140.0, 0.8, 1.0)};
  const auto name = [](int i, int j, int k) {
    return std::to_string(i) + "," + std::to_string(j) + "," + std::to_string(k);
  };
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      for (int k = 0; k < n; ++k) {
        const std::string here = name(i, j, k);
        scene.points.push_back({here, {1.0 * i, 1.0 * j, 1.0 * k}});
        if (k == 0) scene.supports.push_back(clamp(here));
        if (k == n - 1) scene.point_loads.push_back(dead_load(here, {0.06, 0, 0}));
        for (const std::string& next : {name(i + 1, j, k), name(i, j + 1, k), name(i, j, k + 1)}) {
          const bool inside = (next == name(i + 1, j, k) && i + 1 < n && k > 0) ||
                              (next == name(i, j + 1, k) && j + 1 < n && k > 0) ||
                              (next == name(i, j, k + 1) && k + 1 < n);
          if (inside) scene.members.push_back(line(here + " to " + next, here, next, order, elements));
        }
      }
  return scene;
}
/// Points of one side of it only: a square in the plane of x and z.
inline Scene side_of_lattice(int n) {
  Scene scene = lattice(n);
  const auto drop = [&](auto& list, const auto& point_of) {
    list.erase(std::remove_if(list.begin(), list.end(), [&](const auto& item) { return point_of(item)[2] != '0'; }),
               list.end());
  };
  drop(scene.points, [](const Point& p) { return p.name; });
  drop(scene.members, [](const Member& m) { return m.end_point; });
  drop(scene.supports, [](const Support& s) { return s.point; });
  drop(scene.point_loads, [](const PointLoad& l) { return l.point; });
  return scene;
}

/// The same structure with its members in no order, so that neighbours are far apart in the mesh.
inline Scene shuffled(Scene scene) {
  std::shuffle(scene.members.begin(), scene.members.end(), std::mt19937(1));
  return scene;
}

/// Humer, Steinbrecher, Pechstein, arc segment under out-of-plane force: square section of side R / slenderness.
inline Section arc_section(double slenderness) {
  const double a = 100.0 / slenderness, axial = 1e7 * a * a, bending = 1e7 * a * a * a * a / 12.0;
  return section(axial, 0.5 * axial, bending, bending);
}
inline double arc_force(double slenderness) { return 600.0 * std::pow(100.0 / slenderness, 4); }

/// `side` +1: the arc curves towards +e2 (paper), -1: towards -e2 (reference values).
inline Scene arc_segment(const Section& section, double force, double side, int order, int elements) {
  Scene scene = structure({{"clamp", {0, 0, 0}}},
                          {arc("arc", "clamp", "tip", {0, side * 100.0, 0}, {0, 0, side}, kPi / 4.0, order, elements)},
                          {clamp("clamp")}, {dead_load("tip", {0, 0, force})}, section);
  scene.name = "arc segment";
  return scene;
}
inline Scene arc_segment(double slenderness, int order, int elements) {
  return arc_segment(arc_section(slenderness), arc_force(slenderness), 1.0, order, elements);
}

/// Humer, Steinbrecher, Pechstein, structure with slope discontinuity: three legs of unit length along e1, e2, e3.
inline Scene slope_discontinuity(int order, int elements_per_leg) {
  Scene scene =
      structure({{"clamp", {0, 0, 0}}, {"first corner", {1, 0, 0}}, {"second corner", {1, 1, 0}}, {"tip", {1, 1, 1}}},
                {line("leg 1", "clamp", "first corner", order, elements_per_leg),
                 line("leg 2", "first corner", "second corner", order, elements_per_leg),
                 line("leg 3", "second corner", "tip", order, elements_per_leg)},
                {clamp("clamp")}, {dead_load("tip", {-10, 0, -10})}, section(1e4, 5e3, 100.0 / 12.0, 100.0 / 12.0));
  scene.name = "slope discontinuity";
  return scene;
}

/// Humer, Steinbrecher, Pechstein, fork: a shaft that branches into two quarter circles; one tine is loaded in each
/// stage.
inline Scene fork(int order, int elements_per_member, bool first_tine_first = true) {
  Scene scene;
  scene.name = "fork";
  scene.sections = {section(1e4, 1e4, 1e2, 1e2)};
  scene.points = {{"clamp", {0, 0, 0}}, {"branch", {1, 0, 0}}, {"tine 1", {2, 1, 0}}, {"tine 2", {2, -1, 0}}};
  scene.members = {line("shaft", "clamp", "branch", order, elements_per_member),
                   arc("left", "branch", "tine 1", {2, 0, 0}, {0, 0, -1}, kPi / 2.0, order, elements_per_member),
                   arc("right", "branch", "tine 2", {2, 0, 0}, {0, 0, 1}, kPi / 2.0, order, elements_per_member)};
  scene.supports = {clamp("clamp")};
  scene.point_loads = {dead_load("tine 1", {0, 0, 200}), dead_load("tine 2", {0, 0, -200})};
  scene.point_loads[first_tine_first ? 1 : 0].stage = 2;
  scene.stages = 2;
  return scene;
}

/// Humer, Steinbrecher, Pechstein, rod bent to helical shape, ten coils; `part` scales moment and force.
inline Scene helical_rod(int order, int elements, double part = 1.0) {
  Scene scene = cantilever(section(1e4, 1e4, 1e2, 1e2), 10.0, order, elements);
  scene.name = "helical rod";
  scene.point_loads = {dead_load("tip", {0, 0, 50.0 * part}, {0, 0, 200.0 * kPi * part})};
  return scene;
}

/// Humer, Steinbrecher, Pechstein, roll-up to a double circle: unit length, square section of side 1 / slenderness, EI
/// = 1. The paper leaves the shear stiffness open; nothing depends on it.
inline Section rollup_section(double slenderness) {
  const double axial = 12.0 * slenderness * slenderness;
  return section(axial, 0.5 * axial, 1.0, 1.0);
}
inline Scene rollup(double slenderness, int order, int elements) {
  Scene scene = cantilever(rollup_section(slenderness), 1.0, order, elements);
  scene.name = "roll-up";
  scene.point_loads = {dead_load("tip", {}, {0, 0, 4.0 * kPi})};
  return scene;
}

/// Humer, Steinbrecher, Pechstein, helix experiment: two coils of radius 10 over a height of 50, from a straight rod.
/// The clamp turns by -arctan(c) e2 (with the printed sign the tangent at the clamp would point below the plane),
/// either in a stage of its own or together with the moment.
constexpr double kHelixRadius = 10.0, kHelixHeight = 50.0, kHelixCoils = 2.0;
constexpr double kHelixPitch = kHelixHeight / (2.0 * kPi * kHelixCoils * kHelixRadius);
inline double helix_length() {
  return std::sqrt(1.0 + kHelixPitch * kHelixPitch) * 2.0 * kPi * kHelixCoils * kHelixRadius;
}
inline Scene helix_experiment(int order, int elements, int stages = 1) {
  const double length = helix_length(), r = length / 20.0, area = r * r * kPi, bending = r * r * r * r * kPi / 4.0;
  Scene scene = cantilever(section(area, 0.5 * area, bending, bending), length, order, elements);
  scene.name = "helix experiment";
  for (Point& point : scene.points) point.position[1] = -kHelixRadius;
  scene.supports[0].prescribed_rotation = {0, -std::atan(kHelixPitch), 0};
  const double curvature = 1.0 / (kHelixRadius * (1.0 + kHelixPitch * kHelixPitch));
  scene.point_loads = {follower_load("tip", "beam", {}, {curvature * bending * kHelixPitch, 0, curvature * bending})};
  scene.point_loads[0].stage = scene.stages = stages;
  return scene;
}

}  // namespace mixbeam::test
