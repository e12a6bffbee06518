#include "apps/economies/economy.hpp"

#include <cmath>
#include <limits>

namespace mixbeam {

namespace {

/// What Newton's tolerance leaves of a displacement, with a margin for soft structures.
constexpr double kSameSolution = 1e-9;
/// Inner points that carry a load of zero.
constexpr int kInnerPoints = 1000;
constexpr int kLoadSteps = 10;
/// A line load that rounding swallows; one of zero would not be looked at.
constexpr double kNothing = 1e-200;
/// Stiffness beside which 1 is bending: what is left of its strain is rounding.
constexpr double kNearlyRigid = 1e14;

PointLoad& tip_load(Scene& scene) { return scene.point_loads.at(0); }
Member& rod_of(Scene& scene) { return scene.members.at(0); }

/// Loads at the tip that keep the rod in the plane of x and y.
Scene in_plane(Scene scene) {
  tip_load(scene).force[2] = 0.0;
  for (int i = 0; i < 2; ++i) tip_load(scene).moment[i] = 0.0;
  return scene;
}

/// The same straight line from the origin along x, as any curve may be given.
Scene by_formula(Scene scene) {
  Curve& curve = rod_of(scene).curve;
  curve.shape = CurveShape::parametric;
  curve.formula = {"t", "0", "0"};
  for (const Point& point : scene.points)
    if (point.name == tip_load(scene).point) curve.range = {0.0, point.position[0]};
  return scene;
}

Scene with_line_load_of_nothing(Scene scene, LoadFrame frame) {
  DistributedLoad load;
  load.member = rod_of(scene).name;
  load.frame = frame;
  load.force[1] = kNothing;
  scene.distributed_loads.push_back(load);
  return scene;
}

Scene with_matrix(Scene scene) {
  Section& section = scene.sections.at(0);
  Matrix6 matrix{};
  const double diagonal[6] = {section.axial_stiffness,     section.shear_stiffness[0],   section.shear_stiffness[1],
                              section.torsional_stiffness, section.bending_stiffness[0], section.bending_stiffness[1]};
  for (int i = 0; i < 6; ++i) matrix[i][i] = diagonal[i];
  section.matrix = matrix;
  return scene;
}

Scene with_inner_points(Scene scene, bool loaded) {
  for (int i = 1; i <= kInnerPoints; ++i) {
    const std::string name = "inner " + std::to_string(i);
    rod_of(scene).inner_points.push_back({name, i / (kInnerPoints + 1.0)});
    PointLoad load;
    load.point = name;
    if (loaded) scene.point_loads.push_back(load);
  }
  return scene;
}

/// Axial force and shear cannot strain it.
Scene with_force_stiffness(Scene scene, double stiffness) {
  Section& section = scene.sections.at(0);
  section.axial_stiffness = stiffness;
  section.shear_stiffness = {stiffness, stiffness};
  return scene;
}

/// A support that holds the rotation about x at the tip, where nothing turns it.
Scene with_held_twist(Scene scene) {
  Support support;
  support.point = tip_load(scene).point;
  support.rotation_fixed = {true, false, false};
  scene.supports.push_back(support);
  return scene;
}

/// Half as long again, without any load on the new part.
Scene with_overhang(Scene scene, int order, int elements) {
  Member overhang = rod_of(scene);
  overhang.name = "overhang";
  overhang.start_point = tip_load(scene).point;
  overhang.end_point = "end";
  overhang.order = order;
  overhang.elements = elements;
  Vector3 end{};
  for (const Point& point : scene.points)
    if (point.name == overhang.start_point) end = point.position;
  end[0] *= 1.5;
  scene.points.push_back({"end", end});
  scene.members.push_back(overhang);
  return scene;
}

template <class Change>
SolverParameters changed(SolverParameters solver, const Change& change) {
  change(solver);
  return solver;
}

}  // namespace

std::vector<Economy> unused_features(const Scene& rod, const SolverParameters& given) {
  const auto solver = changed(given, [](auto& s) { s.analysis.stability = false; });
  const auto in_space = changed(solver, [](auto& s) { s.planar = false; });
  const double rigid = std::numeric_limits<double>::infinity();
  const int order = rod.members.at(0).order, elements = rod.members.at(0).elements;
  const auto steps = changed(solver, [](auto& s) {
    s.load_path.method = LoadPathMethod::fixed;
    s.load_path.steps = kLoadSteps;
  });
  return {
      {"plane",
       {"rod in a plane, three unknowns for each vertex", in_plane(rod), solver},
       {"six unknowns", in_plane(rod), in_space},
       kSameSolution,
       ""},
      {"straight",
       {"straight line", rod, solver},
       {"the same line as a parametric curve, triads and curvature by formula", by_formula(rod), solver},
       kSameSolution,
       "Elements read the reference tangents at their Gauss points and the triads at their ends, straight or not; "
       "curvature costs time once, when the mesh is made."},
      {"line_loads",
       {"no line load", rod, solver},
       {"dead line load of 1e-200: elements one by one, with loops over loads",
        with_line_load_of_nothing(rod, LoadFrame::dead), solver},
       kSameSolution,
       ""},
      {"potential",
       {"all forces have a potential: symmetric tangents, chains condensed", rod, solver},
       {"follower line load of 1e-200: unsymmetric tangents, sparse solver",
        with_line_load_of_nothing(rod, LoadFrame::follower), solver},
       kSameSolution,
       ""},
      {"section",
       {"six stiffnesses", rod, solver},
       {"the same as a 6 x 6 matrix", with_matrix(rod), solver},
       kSameSolution,
       ""},
      {"point_loads",
       {"1000 inner points without loads", with_inner_points(rod, false), solver},
       {"loads of zero there: none of these vertices is eliminated in a chain", with_inner_points(rod, true), solver},
       kSameSolution,
       ""},
      {"rotation_support",
       {"free end", in_plane(rod), in_space},
       {"rotation about the axis held there: one row that depends on the rotation", with_held_twist(in_plane(rod)),
        in_space},
       kSameSolution,
       "The row is evaluated with the vertex it belongs to; elements know nothing of it."},
      {"rigid",
       {"inextensible and shear rigid", with_force_stiffness(rod, rigid), solver},
       {"EA = GA = 1e14", with_force_stiffness(rod, kNearlyRigid), solver},
       kSameSolution,
       "The force of a rigid strain stays an unknown of the element, its constitutive row becomes the constraint: "
       "there "
       "is no strain term to leave out."},
      {"one_step", {"one load step", rod, solver}, {"ten equal load steps", rod, steps}, kSameSolution, ""},
      {"stability",
       {"stability not asked for", rod, solver},
       {"negative eigenvalues counted in every state", rod,
        changed(solver, [](auto& s) { s.analysis.stability = true; })},
       kSameSolution,
       ""},
      {"estimate", {"error not estimated", rod, solver}, {"estimate at the end", rod, solver, true}, kSameSolution, ""},
      {"result_file",
       {"no result file", rod, solver},
       {"HDF5 and XDMF written", rod, solver, false, true},
       kSameSolution,
       ""},
      {"mesh_by_member",
       {"overhang without load: one element of order 1", with_overhang(rod, 1, 1), solver},
       {"overhang divided like the rest", with_overhang(rod, order, elements / 2), solver},
       kSameSolution,
       ""},
      {"chains",
       {"chains condensed to their ends", rod, solver},
       {"KLU2 on the whole matrix", rod, changed(solver, [](auto& s) { s.linear.method = "KLU2"; })},
       kSameSolution,
       ""},
      {"loose",
       {"linear solves checked to 1e-8", rod, solver},
       {"to 1e-3", rod, changed(solver, [](auto& s) { s.linear.residual_tolerance = 1e-3; })},
       kSameSolution,
       "Solves are direct: the first answer is far below either tolerance, and a looser one saves nothing."},
  };
}

}  // namespace mixbeam
