/// Scenes in a plane, solved with three unknowns per vertex and with six: the same solutions, and what happens out of
/// the plane is still seen.
#include "nonlinear/stability/stability.hpp"
#include "tests/support/buckling_scenes.hpp"
#include "tests/support/solve.hpp"

#include <functional>

namespace mixbeam::test::planar_test {
namespace {

/// Converged solutions of the same equations differ by what Newton's method leaves (1e-11 scaled), more where a
/// structure is soft in some direction.
constexpr double kSameSolution = 1e-10;

SolverParameters with_planar(bool planar) {
  SolverParameters parameters;
  parameters.planar = planar;
  return parameters;
}

bool is_planar(const Scene& scene) { return Model(scene, this_rank(), {}).plane().has_value(); }

/// Displacements and rotations of points, and reactions, by both paths.
void expect_same_solution(const Scene& scene, const std::vector<std::string>& points) {
  const std::vector<Simulation> both = solved_in_plane_and_in_space(scene);
  const Simulation &plane = both[0], &space = both[1];
  EXPECT_TRUE(plane.model().plane().has_value()) << scene.name;
  EXPECT_FALSE(space.model().plane().has_value());
  EXPECT_EQ(plane.work().newton_iterations, space.work().newton_iterations) << scene.name;
  for (const std::string& point : points) {
    EXPECT_TRUE(agrees(plane.displacement(point), space.displacement(point), kSameSolution)) << scene.name;
    EXPECT_TRUE(agrees(plane.rotation(point), space.rotation(point), kSameSolution)) << scene.name;
  }
}

/// The program's own choice of principal axes knows of no plane but those of the coordinates.
Scene turned_in_space(Scene scene) {
  scene.members[0].second_axis = {0, 1, 0};
  return turned(some_rotation(), scene);
}

TEST(Planar, SameSolutionAsInSpace) {
  for (int order : {1, 2, 3, 4, 8}) {
    expect_same_solution(elastica(10.0, order, 8), {"tip"});
    expect_same_solution(rollup(1000.0, order, 7), {"tip"});
  }
  expect_same_solution(arc_segment(arc_section(100.0), 0.0, 1.0, 2, 8), {"tip"});
}

TEST(Planar, PlaneTurnedInSpace) {
  expect_same_solution(turned_in_space(elastica(10.0, 2, 8)), {"tip"});
  expect_same_solution(turned_in_space(rollup(100.0, 3, 6)), {"tip"});
}

TEST(Planar, FramesWithJoints) {
  EXPECT_FALSE(is_planar(portal_of_joints(2, 2)));
  Scene frame = angle_frame(6);
  expect_same_solution(frame, {"tip", "foot"});
  frame.joints = {joint(JointKind::hinge, "tip", {"leg"}, {0, 0, 1}, 0.3)};
  expect_same_solution(frame, {"tip", "foot"});
  frame.joints = {joint(JointKind::ball, "tip", {"leg"}, {0, 0, 1}, 0.0)};
  frame.supports.back() = clamp("foot");
  expect_same_solution(frame, {"tip", "foot"});
}

/// Line loads that vary, on a part and on all of a frame, eigenstrains, and a force at its end.
Scene loaded_frame(int order) {
  Scene frame = angle_frame(6);
  for (Member& member : frame.members) member.order = order;
  const std::string first = frame.members.front().name, last = frame.members.back().name;
  frame.distributed_loads = {{first, {0.3, -0.8, 0.0}, {}, 1}, {last, {0.2, -0.5, 0.0}, {}, 1}};
  frame.distributed_loads[0].force_formula[1] = "-2 * x^2";
  frame.eigenstrains = {{first, {0.02, 0.0, 0.0}, {0.0, 0.0, 0.4}}};
  return frame;
}

TEST(Planar, LineLoadsAndEigenstrains) {
  for (int order : {1, 2, 4}) expect_same_solution(loaded_frame(order), {"tip", "foot"});
  Scene turned_frame = elastica(10.0, 3, 6);
  turned_frame.distributed_loads = {{turned_frame.members[0].name, {1.0, -3.0, 0.0}, {}, 1}};
  expect_same_solution(turned_in_space(turned_frame), {"tip"});
}

/// What is out of the plane by a millionth is not planar, whatever it is, nor fields whose tangent is not symmetric,
/// nor principal axes that are askew.
TEST(Planar, OutOfPlane) {
  constexpr double little = 1e-6;
  using Change = std::function<void(Scene&)>;
  const auto expect_out = [](const Scene& scene, const std::vector<Change>& changes) {
    EXPECT_TRUE(is_planar(scene));
    for (std::size_t i = 0; i < changes.size(); ++i) {
      Scene out = scene;
      changes[i](out);
      EXPECT_FALSE(is_planar(out)) << scene.name << ", change " << i;
    }
  };
  expect_out(loaded_frame(2), {[](Scene& s) { s.points[2].position[2] = little; },
                               [](Scene& s) { s.distributed_loads[1].force[2] = little; },
                               [](Scene& s) { s.distributed_loads[1].couple[2] = 1.0; },
                               [](Scene& s) { s.distributed_loads[1].frame = LoadFrame::follower; },
                               [](Scene& s) { s.eigenstrains[0].strain[2] = little; },
                               [](Scene& s) { s.eigenstrains[0].curvature[0] = little; }});
  expect_out(elastica(10.0, 2, 8), {[](Scene& s) { s.point_loads[0].force[2] = little; },
                                    [](Scene& s) { s.point_loads[0].moment[0] = little; },
                                    [](Scene& s) { s.supports[0].prescribed_displacement[2] = little; },
                                    [](Scene& s) {
                                      s.members[0].second_axis = Vector3{0, 1, 1};
                                    },
                                    [](Scene& s) { s.members[0].force_integration = ForceIntegration::full; }});
}

/// Lateral buckling of a strip bent in its stiff plane: the Newton path stays in the plane, stability sees the mode out
/// of it, and the branch leaves it.
TEST(Planar, BucklesOutOfItsPlane) {
  Scene scene = narrow_cantilever(2, 8);
  scene.point_loads[0].force[1] = -1.05 * kNarrowCantilever;
  ASSERT_TRUE(is_planar(scene));
  int negative[2];
  for (bool planar : {true, false}) {
    BeamProblem problem(scene, this_rank(), with_planar(planar));
    const Simulation simulation = solved(scene, with_planar(planar));
    Stability stability(problem);
    negative[planar ? 1 : 0] = stability.ask({simulation.state(), 1.0}, How::inertia)->negative;
    EXPECT_EQ(simulation.state().in_plane, planar);
    if (!planar) continue;
    const std::vector<EigenMode> modes = stability.modes_near_zero(simulation.state(), 1.0, 1);
    ASSERT_FALSE(modes.empty());
    EXPECT_FALSE(problem.model.is_in_plane(modes.front().mode));
    EXPECT_FALSE(problem.model.apply(simulation.state(), modes.front().mode, 1e-3).in_plane);
  }
  EXPECT_EQ(negative[1], 1);
  EXPECT_EQ(negative[0], negative[1]);
}

/// A motion in the plane stays there, one that leaves it does not come back.
TEST(Planar, StatesKnowWhetherTheyLieInThePlane) {
  const Model model(elastica(10.0, 2, 8), this_rank(), {});
  const State start = model.reference_state();
  EXPECT_TRUE(start.in_plane);
  MixedVector motion = model.create_vector();
  motion.fill(0.0);
  const int tip = vertex_of(model.mesh(), "tip");
  motion.vertex()(6 * tip + 1) = 0.1;
  EXPECT_TRUE(model.apply(start, motion, 1.0).in_plane);
  motion.vertex()(6 * tip + 2) = 1e-9;
  const State out = model.apply(start, motion, 1.0);
  EXPECT_FALSE(out.in_plane);
  motion.vertex()(6 * tip + 2) = 0.0;
  EXPECT_FALSE(model.apply(out, motion, 1.0).in_plane);
}

}  // namespace
}  // namespace mixbeam::test::planar_test
