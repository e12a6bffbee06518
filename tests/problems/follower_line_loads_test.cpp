// Loads per length that turn with the section.
#include "tests/support/solve.hpp"

namespace mixbeam::test::follower_line_loads_test {
namespace {

// Solved to a scaled residual of 1e-11 at most.
constexpr double kSolved = 1e-10;
constexpr double kRadius = 3.0;

DistributedLoad follower(const std::string& member, const Vector3& force, const Vector3& couple = {}) {
  return {member, force, couple, 1, LoadFrame::follower};
}

/// A closed circle of two half circles in the plane of e1 and e2 about the origin; g2 points to the centre.
Scene ring(const Section& section, int order, int elements_per_half) {
  Support also_east = support("east", {false, true, true}, kHeld);
  return structure({{"east", {kRadius, 0, 0}}, {"west", {-kRadius, 0, 0}}},
                   {arc("north", "east", "west", {}, {0, 0, 1}, kPi, order, elements_per_half),
                    arc("south", "west", "east", {}, {0, 0, 1}, kPi, order, elements_per_half)},
                   {clamp("east"), also_east}, {}, section);
}

/// N and M at the middle of every element.
std::vector<PointSample> middles(const Simulation& simulation) {
  std::vector<PointSample> samples;
  const Model& model = simulation.model();
  for (int e = 0; e < static_cast<int>(model.mesh().elements.size()); ++e)
    samples.push_back(sample_element(model.structure(), model.mesh(), simulation.state(), e, 0.0));
  return samples;
}

// An inextensible circle under pressure p from outside, below the critical 3 EI / R^3, and from inside: N = -p R, no
// moment, the same circle. The element knows the circle at its Gauss points only: errors of order h^2k.
TEST(FollowerLineLoads, RingUnderPressure) {
  const double bending = 2.0, critical = 3.0 * bending / (kRadius * kRadius * kRadius);
  const double error[5] = {0, 2e-2, 1e-4, 1e-5, 1e-8};
  for (int order : {1, 2, 3, 4})
    for (double pressure : {0.5 * critical, -2.0 * critical}) {
      Scene scene = ring(section(kRigid, kRigid, 3.0, bending), order, 8);
      scene.distributed_loads = {follower("north", {0, pressure, 0}), follower("south", {0, pressure, 0})};
      const Simulation simulation = solved(scene);
      for (const PointSample& p : middles(simulation)) {
        EXPECT_NEAR(p.force[0], -pressure * kRadius, error[order] * std::abs(pressure) * kRadius) << order;
        EXPECT_LE(std::abs(p.moment[2]), error[order] * std::abs(pressure) * kRadius * kRadius) << order;
      }
      EXPECT_LE(largest_component(simulation.displacement("west")), error[order] * kRadius) << order;
      EXPECT_LE(simulation.balance().force_error, kSolved);
      EXPECT_LE(simulation.balance().moment_error, kSolved);
    }
}

// A cantilever under a couple per length about its own g3: the moment is c (L - s), as in the plane for a dead couple.
TEST(FollowerLineLoads, CoupleInThePlaneIsThatOfADeadOne) {
  Scene scene = cantilever(section(11.0, 7.0, 5.0, 3.0), 2.0, 3, 8);
  scene.distributed_loads = {follower("beam", {}, {0, 0, 3.0})};
  const Simulation turning = solved(scene);
  scene.distributed_loads[0].frame = LoadFrame::dead;
  const Simulation dead = solved(scene);
  EXPECT_TRUE(agrees(turning.position("tip"), dead.position("tip"), kSolved));
}

// A torque per length about the own tangent of a member bent into a quarter circle by its reference: in space, a
// follower couple c g1 and a force both enter global equilibrium with the triads of the solution itself.
TEST(FollowerLineLoads, ReactionsBalanceInSpace) {
  for (int order : {1, 2, 3, 4}) {
    Scene scene = cantilever(section(1100.0, 700.0, 5.0, 3.0), 2.0, order, 6);
    scene.distributed_loads = {follower("beam", {0.3, 1.0, -0.7}, {0.5, -0.2, 0.4})};
    scene.distributed_loads[0].force_formula[1] = "1 + sin(3 * s)";
    const Simulation beam = solved(scene);
    EXPECT_LE(beam.balance().force_error, kSolved) << order;
    EXPECT_LE(beam.balance().moment_error, kSolved) << order;
    EXPECT_GT(largest_component(beam.displacement("tip")), 0.3) << order;
  }
}

// A follower force and its own reference: a member that turns as a whole (clamp turned by 90 degrees) takes its load
// along, a dead load does not.
TEST(FollowerLineLoads, TurnsWithTheClamp) {
  Scene scene = cantilever(section(1100.0, 700.0, 5.0, 3.0), 2.0, 3, 4);
  scene.distributed_loads = {follower("beam", {0, 0.4, 0.3}, {0.1, 0, 0})};
  const Vector3 tip = solved(scene).position("tip");
  scene.supports[0].prescribed_rotation = {0, 0, 0.5 * kPi};
  EXPECT_TRUE(agrees(solved(scene).position("tip"), {-tip[1], tip[0], tip[2]}, kSolved));
  scene.distributed_loads[0].frame = LoadFrame::dead;
  EXPECT_GT(distance(solved(scene).position("tip"), {-tip[1], tip[0], tip[2]}), 0.1);
}

// Elastic catenary (Irvine, Cable Structures, 1981): a cable of length L, weight w per length and horizontal pull H
// spans
//   H L / EA + 2 H/w asinh(w L / 2 H)   and sags by   w L^2 / 8 EA + H/w (sqrt(1 + (w L / 2 H)^2) - 1).
// A beam with hinged ends deviates from it by its bending stiffness over H times the square of its length.
TEST(LineLoads, CableHangsInACatenary) {
  constexpr double kLength = 2.5, kWeight = 1.0, kAxial = 100.0, kPull = 0.8, kBending = 1e-6;
  constexpr double kModel = 20.0 * kBending;
  const double steepness = 0.5 * kWeight * kLength / kPull;
  const double span = kPull * kLength / kAxial + 2.0 * kPull / kWeight * std::asinh(steepness);
  const double sag =
      kWeight * kLength * kLength / (8.0 * kAxial) + kPull / kWeight * (std::sqrt(1.0 + steepness * steepness) - 1.0);
  Scene scene = cantilever(section(kAxial, kRigid, kBending, kBending), kLength, 3, 40);
  scene.supports[0].rotation_fixed = {true, true, false};
  scene.supports.push_back(scene.supports[0]);
  scene.supports[1].point = "tip";
  // a slack cable has no stiffness: it is pulled, loaded and let go
  scene.supports[1].prescribed_displacement = {kLength - span, 0, 0};
  scene.supports[1].amplitude = "t < 2 ? 0.02 * min(t, 1) : 0.02 - 1.02 * (t - 2)";
  scene.distributed_loads = {{"beam", {0, -kWeight, 0}, {}, 2}};
  scene.stages = 3;
  const Simulation cable = solved(scene);
  EXPECT_NEAR(cable.position("tip")[0], span, kSolved);
  const std::vector<Reaction> reactions = cable.reactions();
  EXPECT_NEAR(reactions[0].force[1], 0.5 * kWeight * kLength, kSolved);
  EXPECT_NEAR(reactions[1].force[0], kPull, kModel);
  const PointSample middle = sample_element(cable.model().structure(), cable.model().mesh(), cable.state(), 20, -1.0);
  EXPECT_NEAR(middle.position[1], -sag, kModel);
}

}  // namespace
}  // namespace mixbeam::test::follower_line_loads_test
