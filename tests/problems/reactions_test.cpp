// Reactions against statics in closed form, and the balance of everything that acts from outside.
#include "tests/support/solve.hpp"

namespace mixbeam::test::reactions_test {
namespace {

/// What issue 3 asks of every converged run.
constexpr double kBalanced = 1e-10;

void expect_balanced(const Simulation& simulation) {
  const Balance balance = simulation.balance();
  EXPECT_LT(balance.force_error, kBalanced) << simulation.scene().name;
  EXPECT_LT(balance.moment_error, kBalanced) << simulation.scene().name;
}

/// A clamp carries the load and its moment about the clamp, in the deformed configuration.
TEST(Reactions, OfAClampUnderADeadLoad) {
  const Vector3 force = {3, -20, 50}, moment = {1, 2, -3};
  Scene scene = cantilever(section(1e4, 5e3, 80, 100), 2.0, 3, 4);
  scene.point_loads = {dead_load("tip", force, moment)};
  const Simulation simulation = solved(scene);
  const std::vector<Reaction> reactions = simulation.reactions();
  ASSERT_EQ(reactions.size(), 1u);
  EXPECT_EQ(reactions[0].point, "clamp");
  const Vector3 tip = simulation.position("tip");
  EXPECT_TRUE(agrees_relatively(reactions[0].force, {-3, 20, -50}, kBalanced));
  EXPECT_TRUE(agrees_relatively(
      reactions[0].moment,
      {-(moment[0] + tip[1] * force[2] - tip[2] * force[1]), -(moment[1] + tip[2] * force[0] - tip[0] * force[2]),
       -(moment[2] + tip[0] * force[1] - tip[1] * force[0])},
      kBalanced));
  expect_balanced(simulation);
}

/// Simply supported beam, tiny uniform load: q L / 2 at each end, and only along the fixed components.
TEST(Reactions, OfASimplySupportedBeamUnderALineLoad) {
  constexpr double kTiny = 1e-6;
  Scene scene = cantilever(section(1e4, 5e3, 80, 100), 2.0, 2, 4);
  scene.supports[0].rotation_fixed = {true, false, true};
  scene.supports.push_back(support("tip", {false, true, true}, {}));
  scene.distributed_loads = {{"beam", {0, 0, -kTiny}, {}, 1}};
  const Simulation simulation = solved(scene);
  const std::vector<Reaction> reactions = simulation.reactions();
  ASSERT_EQ(reactions.size(), 2u);
  for (const Reaction& reaction : reactions) {
    EXPECT_TRUE(agrees(reaction.force, {0, 0, kTiny}, 1e-10 * kTiny)) << reaction.point;
    EXPECT_TRUE(agrees(reaction.moment, {0, 0, 0}, 1e-10 * kTiny)) << reaction.point;
  }
  expect_balanced(simulation);
  const Balance balance = simulation.balance();
  EXPECT_TRUE(agrees(balance.applied_force, {0, 0, -2 * kTiny}, 1e-12 * kTiny));
  EXPECT_TRUE(agrees(balance.applied_moment, {0, 0, 0}, 1e-10 * kTiny));
}

/// Levers are exact however far the structure is from the origin: coordinates of 1e6 hold ten digits of displacements.
TEST(Balance, OfAStructureFarFromTheOrigin) {
  Scene scene = cantilever(section(1e4, 5e3, 80, 100), 2.0, 3, 4);
  for (Point& point : scene.points)
    for (double& coordinate : point.position) coordinate += 1e6;
  scene.point_loads = {dead_load("tip", {3, -20, 50}, {1, 2, -3})};
  const Balance balance = solved(scene).balance();
  EXPECT_LT(balance.force_error, kBalanced);
  EXPECT_LT(balance.moment_error, 1e-2 * kBalanced);
}

/// Couples along a member: their sum, and a sum of moments that large displacements do not spoil.
TEST(Balance, OfLineLoadsAndCouples) {
  Scene scene = slope_discontinuity(3, 3);
  scene.distributed_loads = {{"leg 2", {1, 2, -3}, {0.5, 0, 1}, 1}, {"leg 3", {0, 1, 0}, {}, 1}};
  for (int order : {1, 2, 4}) {
    for (Member& member : scene.members) member.order = order;
    scene.members[1].order = order + 1;
    const Simulation simulation = solved(scene);
    expect_balanced(simulation);
    EXPECT_TRUE(agrees(simulation.balance().applied_force, {-9, 3, -13}, 1e-12));
    EXPECT_LT(simulation.balance().curve_moment, 1e-14);  // straight members
  }
}

/// Curved members: what the quadrature does not see of the curve is told apart, and vanishes with the elements.
TEST(Balance, OfCurvedMembers) {
  for (ForceIntegration rule : {ForceIntegration::both_reduced, ForceIntegration::full, ForceIntegration::axial_reduced,
                                ForceIntegration::shear_reduced}) {
    double before = 0.0;
    for (int elements : {2, 4}) {
      Scene scene = arc_segment(100, 2, elements);
      scene.members[0].force_integration = rule;
      scene.distributed_loads = {{"arc", {1e-2, 2e-2, -3e-2}, {0.5, 0, 1}, 1}};
      SolverParameters parameters;
      parameters.newton.maximum_iterations = 60;
      const Simulation simulation = solved(scene, parameters);
      expect_balanced(simulation);
      const double curve = simulation.balance().curve_moment;
      EXPECT_GT(curve, 0.0);
      EXPECT_TRUE(before == 0.0 || rule != ForceIntegration::both_reduced || curve < before / 8) << curve;
      before = curve;
    }
  }
}

TEST(Balance, OfEveryStepOfAFork) {
  Scene scene = fork(4, 4);
  scene.supports[0].prescribed_rotation = {0.3, 0.2, -0.1};
  Simulation simulation(scene, {}, this_rank());
  int steps = 0;
  simulation.run([&](const StepReport& report, const State&) {
    EXPECT_EQ(report.load_factor, simulation.load_factor());
    expect_balanced(simulation);
    ++steps;
  });
  EXPECT_TRUE(simulation.result().finished);
  EXPECT_GE(steps, 3);
}

// The twin that must fail: a state that is no equilibrium is not balanced.
TEST(Balance, OfAStateThatIsNoEquilibriumIsSeen) {
  Simulation simulation(slope_discontinuity(2, 2), {}, this_rank());
  const Model model(simulation.scene(), this_rank(), {});
  const Balance unloaded = balance(model, simulation.state(), 0.0);
  EXPECT_LT(unloaded.force_error, kBalanced);
  const Balance loaded = balance(model, simulation.state(), 1.0);
  EXPECT_GT(loaded.force_error, 0.5);
  EXPECT_GT(loaded.moment_error, 0.3);  // moments are measured by the forces at work too
}

/// Reading the balance of a step leaves the path alone, bit for bit.
TEST(Balance, DisturbsNothing) {
  Scene scene = slope_discontinuity(3, 3);
  scene.distributed_loads = {{"leg 2", {1, 2, -3}, {0.5, 0, 1}, 1}};
  SolverParameters parameters;
  parameters.load_path.method = LoadPathMethod::fixed;
  parameters.load_path.steps = 3;
  const Simulation quiet = solved(scene, parameters);
  Simulation watched(scene, parameters, this_rank());
  watched.run([&](const StepReport&, const State&) { expect_balanced(watched); });
  EXPECT_EQ(quiet.displacement("tip"), watched.displacement("tip"));
}

}  // namespace
}  // namespace mixbeam::test::reactions_test
