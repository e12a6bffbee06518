// Exact statements about solutions: they hold for the discrete solution, too, so no mesh enters their tolerances.
#include "kernels/math/rotation.hpp"
#include "tests/support/scene_units.hpp"
#include "tests/support/solve.hpp"

#include <vector>

namespace mixbeam::test::identities_test {
namespace {

// Both sides are solved to a scaled residual of 1e-11 at most; flexible members multiply it by a few.
constexpr double kSolved = 1e-10;
// Along a path the sizes of steps see rounding, and a last iteration may be needed or not.
constexpr int kIterationsApart = 1;
// Displacements of the arc are of the size of its radius, 100.
constexpr double kLongLever = 1e-8;

Mat3<double> some_rotation() { return exp_matrix(Vec3<double>{{0.7, -1.9, 1.3}}); }

using scene_change::turned;

/// Turned about the origin, without a shift.
Scene turned(const Mat3<double>& rotation, const Scene& scene) { return moved(rotation, {0, 0, 0}, scene); }

/// A frame with a kink, unequal bending stiffnesses and every kind of load that turns with the scene.
Scene frame_with_all_loads() {
  Scene scene = slope_discontinuity(3, 2);
  scene.sections[0].bending_stiffness = {20.0, 8.0};
  scene.members[0].second_axis = {0, 0.6, 0.8};
  scene.members[1].second_axis = {0, 0, 1};
  scene.members[2].second_axis = {1, 0, 0};
  scene.point_loads = {dead_load("tip", {-2, 0, -3}, {1, 0.5, 0}), follower_load("second corner", "leg 2", {1, 0, 2})};
  scene.distributed_loads = {{"leg 2", {0.5, 1.0, -1.5}, {0.3, 0, 0.2}, 1},
                             {"leg 3", {0, 1.0, -0.5}, {0.3, 0, 0.2}, 1, LoadFrame::follower}};
  scene.distributed_loads[1].force_formula[0] = "sin(3 * x)";
  scene.eigenstrains = {{"leg 1", {0.02, 0, 0}, {0.1, 0.2, -0.1}}};
  scene.eigenstrains[0].curvature_formula[0] = "0.2 * x";
  scene.supports[0].prescribed_displacement = {0.1, 0, -0.05};
  scene.supports[0].prescribed_rotation = {0.2, 0.3, -0.1};
  return scene;
}

TEST(Identities, TurningTheSceneTurnsTheAnswer) {
  const Mat3<double> rotation = some_rotation();
  for (const Scene& scene : {frame_with_all_loads(), arc_segment(100, 2, 8), fork(2, 3)}) {
    const Simulation here = solved(scene), there = solved(turned(rotation, scene));
    for (const Point& point : scene.points) {
      EXPECT_TRUE(agrees(there.displacement(point.name), turned(rotation, here.displacement(point.name)), kLongLever))
          << scene.name << ", " << point.name;
      EXPECT_TRUE(agrees(there.rotation(point.name), turned(rotation, here.rotation(point.name)), kSolved))
          << scene.name << ", " << point.name;
    }
    EXPECT_NEAR(here.result().newton_iterations, there.result().newton_iterations, kIterationsApart) << scene.name;
  }
}

TEST(Identities, UnitsDoNotMatter) {
  for (const Scene& scene : {frame_with_all_loads(), arc_segment(1e6, 2, 8), helix_experiment(1, 5)}) {
    const Simulation here = solved(scene);
    for (double length : {1e-6, 1.0, 1e6})
      for (double force : {1e-6, 1e6}) {
        const Simulation there = solved(in_other_units(scene, length, force));
        const Vector3 u = here.displacement("tip"), v = there.displacement("tip");
        EXPECT_TRUE(agrees_relatively({v[0] / length, v[1] / length, v[2] / length}, u, kSolved))
            << scene.name << ", length " << length << ", force " << force;
        EXPECT_TRUE(agrees(there.rotation("tip"), here.rotation("tip"), kSolved))
            << scene.name << ", length " << length << ", force " << force;
        EXPECT_EQ(here.result().newton_iterations, there.result().newton_iterations)
            << scene.name << ", length " << length << ", force " << force;
      }
  }
}

// C_gamma = c I and dead tip forces only: rotations do not depend on c, the centerline shifts by s F / c.
TEST(Identities, EqualForceStiffnessesShiftTheCenterline) {
  const double force = 600.0, bending = 1e7 / 12.0, arc_length = 100.0 * kPi / 4.0;
  for (int order : {1, 3}) {
    const auto arc = [&](double c) {
      return solved(arc_segment(section(c, c, bending, bending), force, 1.0, order, 8));
    };
    const Simulation rigid = arc(kRigid);
    for (double c : {1e4, 1e7}) {
      const Simulation soft = arc(c);
      EXPECT_TRUE(agrees(soft.rotation("tip"), rigid.rotation("tip"), kSolved)) << "order " << order << ", c " << c;
      Vector3 expected = rigid.displacement("tip");
      expected[2] += arc_length * force / c;
      EXPECT_TRUE(agrees_relatively(soft.displacement("tip"), expected, kSolved)) << "order " << order << ", c " << c;
    }
  }
}

// Which tine is loaded first does not matter in the end, and half a turn about e1 maps one path onto the other.
TEST(Identities, ReversedPathOfTheFork) {
  Simulation first(fork(3, 3, true), {}, this_rank()), second(fork(3, 3, false), {}, this_rank());
  std::vector<std::array<double, 6>> after_first_stage;
  const auto run = [&](Simulation& simulation, const std::string& loaded) {
    const int vertex = vertex_of(simulation.model().mesh(), loaded);
    simulation.run([&](const StepReport& report, const State& state) {
      if (report.load_factor == 1.0) after_first_stage.push_back(vertex_motion(simulation.model(), state, vertex));
    });
    EXPECT_TRUE(simulation.result().finished) << simulation.result().failure;
  };
  run(first, "tine 1");
  run(second, "tine 2");
  ASSERT_EQ(after_first_stage.size(), 2u);
  const auto& one = after_first_stage[0];
  const auto& two = after_first_stage[1];
  EXPECT_TRUE(agrees({two[0], two[1], two[2]}, {one[0], -one[1], -one[2]}, kSolved));
  EXPECT_TRUE(agrees({two[3], two[4], two[5]}, {one[3], -one[4], -one[5]}, kSolved));
  for (const char* point : {"branch", "tine 1", "tine 2"}) {
    EXPECT_TRUE(agrees(second.displacement(point), first.displacement(point), kSolved)) << point;
    EXPECT_TRUE(agrees(second.rotation(point), first.rotation(point), kSolved)) << point;
  }
  const Vector3 u = first.displacement("tine 1");
  EXPECT_TRUE(agrees(first.displacement("tine 2"), {u[0], -u[1], -u[2]}, kSolved));
}

}  // namespace
}  // namespace mixbeam::test::identities_test
