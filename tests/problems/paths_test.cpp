// Paths through limit points and past bifurcations, without any solver parameter, against closed forms and the
// reference values computed by shooting.
#include "tests/support/constrained_scenes.hpp"
#include "tests/support/solve.hpp"

namespace mixbeam::test::paths_test {
namespace {

/// Load factors of critical points: what the program promises.
constexpr double kLocated = 1e-8;
/// Displacements at them, linear in the error of the place on the path.
constexpr double kPlaced = 1e-7;

struct Walk {
  LoadPathResult result;
  std::vector<StepReport> steps;
  std::vector<StepFailure> failures;
  std::vector<CriticalPoint> critical;
};

Walk walk(Simulation& simulation) {
  Walk walk;
  PathControl control;
  control.step_failed = [&](const StepFailure& failure) { walk.failures.push_back(failure); };
  walk.result = simulation.run(
      [&](const StepReport& report, const State&) {
        walk.steps.push_back(report);
        walk.critical.insert(walk.critical.end(), report.critical_points.begin(), report.critical_points.end());
      },
      control);
  EXPECT_TRUE(walk.result.finished) << simulation.scene().name << ": " << walk.result.failure;
  return walk;
}

Walk walk(const Scene& scene, const SolverParameters& parameters = {}, const Communicator& comm = this_rank()) {
  Simulation simulation(scene, parameters, comm);
  return walk(simulation);
}

SolverParameters on_branch(Branch branch) {
  SolverParameters parameters;
  parameters.analysis.branch = branch;
  return parameters;
}

/// Largest of them: the cosine of the bars' slope has grown to its cube root.
double truss_limit() {
  const double cosine = kTrussHalfSpan / std::hypot(kTrussHalfSpan, kTrussRise);
  return 2.0 * kTrussAxial * std::pow(1.0 - std::pow(cosine, 2.0 / 3.0), 1.5);
}

TEST(Paths, ShallowTrussSnapsThroughBothLimitPoints) {
  const double force = 2.0 * truss_limit();
  const Walk truss = walk(shallow_truss(force));
  ASSERT_EQ(truss.critical.size(), 2u);
  for (const CriticalPoint& point : truss.critical) EXPECT_EQ(point.kind, CriticalKind::limit_point);
  EXPECT_NEAR(truss.critical[0].load_factor, 0.5, kLocated);
  EXPECT_NEAR(truss.critical[1].load_factor, -0.5, kLocated);
  EXPECT_EQ(truss.critical[0].negative_before, 0);
  EXPECT_EQ(truss.critical[0].negative_after, 1);
  EXPECT_EQ(truss.critical[1].negative_after, 0);
  ASSERT_FALSE(truss.failures.empty()) << "the whole load in one step has no equilibrium near the start";
  EXPECT_FALSE(truss.failures[0].cause.empty());
}

/// Once through, all members are in tension and the state is stable, as a cable's; Newton's method reaches it from the
/// start. Only limp members may leave out what lies between.
TEST(Paths, ATrussInTensionHasNotPassedItsLimitPointsUnseen) {
  const double rise = 0.2, cosine = kTrussHalfSpan / std::hypot(kTrussHalfSpan, rise);
  Scene scene = shallow_truss(4.0 * std::pow(1.0 - std::pow(cosine, 2.0 / 3.0), 1.5));
  scene.points[1].position = {0, rise, 0};
  Section& bar = scene.sections.front();
  bar = section(1.0, kRigid, 1e3, 1e3);
  const Walk truss = walk(scene);
  ASSERT_EQ(truss.critical.size(), 2u);
  EXPECT_NEAR(truss.critical[0].load_factor, 0.5, kLocated);
  EXPECT_NEAR(truss.critical[1].load_factor, -0.5, kLocated);
}

/// Pressed far beyond the snap, where the truss has stiffened, with a spring that leaves less and less of the dip:
/// neither both ends of a step nor the mean between them tell of the limit points inside.
TEST(Paths, ATracedTrussSnapsThroughHoweverFarItIsPressed) {
  SolverParameters traced;
  traced.analysis.trace = true;
  const double bar = std::hypot(kTrussHalfSpan, kTrussRise);
  const double ends_snap =
      2.0 * kTrussAxial * (1.0 / kTrussHalfSpan - 1.0 / bar);  // the bars are softest when they are level
  for (const double spring : {0.0, 0.5, 0.9})
    for (const double times : {2.0, 10.0, 100.0}) {
      SCOPED_TRACE(std::to_string(spring) + " of the spring that ends the snap, load " + std::to_string(times));
      const double stiffness = spring * ends_snap, force = times * (truss_limit() + stiffness * kTrussRise);
      Scene scene = shallow_truss(force);
      scene.supports.back().displacement_stiffness = {0.0, stiffness, 0.0};
      const Walk truss = walk(scene, traced);
      ASSERT_EQ(truss.critical.size(), 2u);
      // where truss_force(v) + stiffness v is stationary
      const double cosine = std::cbrt(kTrussHalfSpan / bar + stiffness * kTrussHalfSpan / (2.0 * kTrussAxial));
      const double height = kTrussHalfSpan * std::sqrt(1.0 / (cosine * cosine) - 1.0);
      for (int i = 0; i < 2; ++i) {
        const double v = i == 0 ? kTrussRise - height : kTrussRise + height;
        EXPECT_NEAR(truss.critical[i].load_factor, (truss_force(v) + stiffness * v) / force, kLocated);
        EXPECT_GT(std::abs(truss_force(v) + stiffness * v - 1.001 * truss.critical[i].load_factor * force), kLocated)
            << "the comparison sees a limit point that is off by a thousandth";
      }
    }
}

TEST(Paths, StepsOfTheTrussLieOnItsCurve) {
  Simulation simulation(shallow_truss(2.0 * truss_limit()), {}, this_rank());
  std::vector<std::array<double, 2>> points;
  simulation.run([&](const StepReport& report, const State&) {
    points.push_back({report.load_factor, -simulation.displacement("apex")[1]});
  });
  ASSERT_GT(points.size(), 5u);
  for (const auto& [load_factor, v] : points)
    EXPECT_NEAR(load_factor * 2.0 * truss_limit(), truss_force(v), 1e-9 * kTrussAxial) << "at " << v;
  EXPECT_GT(std::abs(truss_force(1.001 * points.back()[1]) - truss_force(points.back()[1])), 1e-6 * kTrussAxial)
      << "the comparison sees a deflection that is off by a thousandth";
}

TEST(Paths, ADisplacementDrivesTheTrussAgainstItsLoad) {
  SolverParameters parameters;
  parameters.analysis.control = MonitoredComponent{"apex", 1, -0.9 * kTrussRise};
  Simulation simulation(shallow_truss(1.0), parameters, this_rank());
  const Walk truss = walk(simulation);
  EXPECT_NEAR(simulation.displacement("apex")[1], -0.9 * kTrussRise, 1e-12);
  EXPECT_NEAR(truss.result.load_factor, truss_force(0.9 * kTrussRise), 1e-9);
  ASSERT_EQ(truss.critical.size(), 1u);
  EXPECT_NEAR(truss.critical[0].load_factor, truss_limit(), kLocated * truss_limit());
}

/// An inextensible column along e1, P towards the clamp; `second` and `third` are its bending stiffnesses.
Scene column(double second, double third, double load) {
  Section bar = section(kRigid, kRigid, 1.0, 1.0);
  bar.bending_stiffness = {second, third};
  Scene scene = cantilever(bar, 1.0, 4, 8);
  scene.name = "column";
  scene.point_loads = {dead_load("tip", {-load, 0, 0})};
  return scene;
}
constexpr double kEuler = kPi * kPi / 4.0;

/// Hinged in one plane and clamped in the other: the second load of the first and the first one of the second are the
/// same, 4 pi^2 EI / L^2, of two modes that have nothing to do with each other.
TEST(Paths, TwoUnrelatedModesAtOneLoad) {
  Scene scene = column(1.0, 1.0, 50.0);
  scene.supports = {hinged("clamp"), support("tip", {false, true, true}, {true, true, false})};
  scene.members[0].elements = 16;
  const Walk both = walk(scene);
  ASSERT_EQ(both.critical.size(), 2u);
  EXPECT_NEAR(both.critical[0].load_factor, kPi * kPi / 50.0, kLocated);
  EXPECT_NEAR(both.critical[1].load_factor, 4.0 * kPi * kPi / 50.0, kLocated);
  EXPECT_EQ(both.critical[1].modes, 2);
}

// Euler column, clamped-free, inextensible, shear-rigid: P / P_cr, x / L, y / L, reference values by shooting.
TEST(Paths, BothBuckledBranchesOfAColumn) {
  struct Reference {
    double load, x, y;
  };
  for (const Reference& r : {Reference{1.01539686554, 0.969730907364, 0.219413042396},
                             Reference{1.51838879329, 0.348989300415, 0.791539496537},
                             Reference{4.03008596605, -0.340318855691, 0.624603512953}}) {
    double first_side = 0.0;
    for (Branch branch : {Branch::positive, Branch::negative}) {
      Simulation simulation(column(100.0, 1.0, r.load * kEuler), on_branch(branch), this_rank());
      const Walk buckled = walk(simulation);
      const double side = branch == Branch::positive ? 1.0 : -1.0;
      const Vector3 tip = simulation.position("tip");
      EXPECT_TRUE(agrees({tip[0], std::abs(tip[1]), tip[2]}, {r.x, r.y, 0}, kPlaced)) << r.load;
      ASSERT_FALSE(buckled.critical.empty());
      EXPECT_NEAR(buckled.critical[0].load_factor, 1.0 / r.load, kLocated);
      EXPECT_EQ(simulation.result().finished, true);
      ASSERT_TRUE(buckled.steps.back().stability.has_value());
      EXPECT_EQ(buckled.steps.back().stability->negative, 0) << "the buckled column is stable";
      if (branch == Branch::positive) first_side = tip[1];
      EXPECT_GT(side * first_side * tip[1], 0.0) << "the branches lie on opposite sides";
    }
  }
}

TEST(Paths, WithoutAskingNobodyLeavesThePrimaryPath) {
  Simulation simulation(column(100.0, 1.0, 1.5 * kEuler), {}, this_rank());
  const Walk straight = walk(simulation);
  EXPECT_LT(std::abs(simulation.displacement("tip")[1]), 1e-9);
  EXPECT_EQ(straight.steps.back().stability->negative, 1) << "and the report says that it is unstable";
}

TEST(Paths, StabilityIsNotLookedAtWhereNotAskedFor) {
  SolverParameters parameters;
  parameters.analysis.stability = false;
  const Walk straight = walk(column(100.0, 1.0, 1.5 * kEuler), parameters);
  EXPECT_FALSE(straight.steps.back().stability.has_value());
  EXPECT_TRUE(straight.critical.empty());
  EXPECT_EQ(straight.result.steps, 1);
}

/// What is controlled does not move before the column buckles, and a load that pulls does not make it buckle, however
/// large: then the load sets out once more, pushing. P by elliptic integrals (a quarter of the column that is clamped
/// at both ends, known_paths_test.cpp).
TEST(Paths, WhatALoadThatGrowsDoesNotReachOneThatFallsMay) {
  constexpr double kPush = 41.5702557932 / 16.0, kShortening = 0.1, kMostPull = 1e6, kGrowth = 3.0;  // steps double
  SolverParameters parameters = on_branch(Branch::positive);
  parameters.analysis.control = MonitoredComponent{"tip", 0, -kShortening};
  const Walk pulled = walk(column(100.0, 1.0, -1.0), parameters);
  EXPECT_NEAR(pulled.result.load_factor, -kPush, kPlaced * kPush);
  double first = 0.0, largest = 0.0;
  for (const StepReport& report : pulled.steps) {
    if (first == 0.0) first = report.load_factor;
    largest = std::max(largest, report.load_factor);
  }
  EXPECT_GT(largest, kMostPull * std::max(1.0, first)) << "all loads are tried that mean something";
  EXPECT_LT(largest, kGrowth * kMostPull * std::max(1.0, first)) << "and no more";
  const Walk pushed = walk(column(100.0, 1.0, 1.0), parameters);
  EXPECT_NEAR(pushed.result.load_factor, kPush, kPlaced * kPush);
  for (const StepReport& report : pushed.steps) EXPECT_GE(report.load_factor, 0.0) << "one sense is enough";
}

/// A rod that cannot stretch, pulled at 45 degrees, never gets its tip beyond the direction of the load: the target is
/// sought up to a million times the first load, and the report says so.
TEST(Paths, ATargetOutOfReachIsGivenUp) {
  constexpr double kOutOfReach = 0.75;           // above the root of 1/2
  constexpr double kMost = 1e6, kGrowth = 10.0;  // with a step along the path, which stiffens
  Scene scene = column(100.0, 1.0, 0.0);
  scene.point_loads = {dead_load("tip", {1, 1, 0})};
  SolverParameters parameters;
  parameters.analysis.control = MonitoredComponent{"tip", 1, kOutOfReach};
  Simulation simulation(scene, parameters, this_rank());
  double first = 0.0, largest = 0.0;
  const LoadPathResult result = simulation.run([&](const StepReport& report, const State&) {
    if (first == 0.0) first = report.load_factor;
    largest = std::max(largest, std::abs(report.load_factor));
  });
  EXPECT_FALSE(result.finished);
  EXPECT_NE(result.failure.find("does not reach its target up to load factor"), std::string::npos) << result.failure;
  EXPECT_GT(largest, kMost * std::max(1.0, first));
  EXPECT_LT(largest, kGrowth * kMost * std::max(1.0, first));
}

// Lee's frame; its limit points are compared in apps/verification/lee_frame.xml.
Scene lee_frame(double force, double axial = 4320.0) {
  Section rod = section(axial, kRigid, 1e6, 1440.0);
  rod.bending_stiffness = {1e6, 1440.0};  // stays in its plane
  return structure({{"foot", {0, 0, 0}}, {"corner", {0, 120, 0}}, {"loaded", {24, 120, 0}}, {"end", {120, 120, 0}}},
                   {line("column", "foot", "corner", 4, 8), line("beam left", "corner", "loaded", 4, 2),
                    line("beam right", "loaded", "end", 4, 8)},
                   {hinged("foot"), hinged("end")}, {dead_load("loaded", {0, -force, 0})}, rod);
}

/// The inextensible frame is the limit of ever more slender ones, at the same limit points in as many steps.
TEST(Paths, SnapBackOfRigidAndSlenderFrames) {
  constexpr int kAttempt = 20;  // of two hundred: one failed attempt more or less
  SolverParameters closely;
  closely.analysis.trace = true;
  const Walk rigid = walk(lee_frame(2.0, kRigid), closely);
  ASSERT_EQ(rigid.critical.size(), 2u);
  for (const double slenderness : {1e4, 1e6, 1e8, 1e10, 1e12}) {
    const Walk slender = walk(lee_frame(2.0, 12.0 * 1440.0 * slenderness * slenderness / (120.0 * 120.0)), closely);
    ASSERT_EQ(slender.critical.size(), 2u) << slenderness;
    // the axial strain P/EA changes the limit load by a few times itself
    const double allowed = 100.0 / (slenderness * slenderness) + kLocated;
    for (int i : {0, 1})
      EXPECT_NEAR(slender.critical[i].load_factor, rigid.critical[i].load_factor, allowed) << slenderness;
    EXPECT_EQ(slender.result.steps, rigid.result.steps) << slenderness;
    EXPECT_NEAR(slender.result.newton_iterations, rigid.result.newton_iterations, kAttempt) << slenderness;
  }
}

TEST(Paths, FewIterationsFromPlainScenes) {
  for (const auto& [load, most] : {std::pair{1.0, 6}, {10.0, 9}, {1e3, 15}, {1e6, 24}}) {
    EXPECT_LE(walk(elastica(load, 4, 16)).result.newton_iterations, most) << "F L^2 / EI = " << load;
  }
}

std::vector<SolverParameters> ten_ways() {
  std::vector<SolverParameters> ways(1);
  for (int steps : {10, 16, 25, 40, 64}) {
    SolverParameters fixed;
    fixed.load_path.method = LoadPathMethod::fixed;
    fixed.load_path.steps = steps;
    ways.push_back(fixed);
  }
  for (double first : {0.02, 0.05, 0.12}) {
    SolverParameters adaptive;
    adaptive.load_path.method = LoadPathMethod::adaptive;
    adaptive.load_path.initial_step = first;
    ways.push_back(adaptive);
  }
  ways.emplace_back();
  ways.back().load_path.maximum_step = 0.07;
  return ways;
}

void expect_one_end(const Scene& scene, const std::vector<std::string>& points) {
  constexpr double kSame = 1e-11;  // relative to the size of the structure
  std::vector<Simulation> ends;
  for (SolverParameters way : ten_ways()) {
    way.newton.residual_tolerance = 1e-13;
    way.analysis.stability = false;
    ends.push_back(solved(scene, way));
    const double length = ends[0].model().structure().length;
    for (const std::string& point : points)
      EXPECT_TRUE(agrees(ends.back().position(point), ends[0].position(point), kSame * length))
          << scene.name << ", way " << ends.size();
  }
}

TEST(Paths, EndsDoNotDependOnTheWay) {
  expect_one_end(fork(3, 5), {"tine 1", "tine 2"});
  expect_one_end(helical_rod(3, 30), {"tip"});
}

TEST(MpiPaths, CriticalPointsAndBranchesAreTheSameOnAllRanks) {
  const Scene scene = column(100.0, 1.0, 1.5 * kEuler);
  const Walk together = walk(scene, on_branch(Branch::positive), all_ranks());
  const Walk alone = walk(scene, on_branch(Branch::positive));
  ASSERT_EQ(together.critical.size(), 1u);
  EXPECT_NEAR(together.critical[0].load_factor, alone.critical[0].load_factor, kLocated);
  EXPECT_EQ(together.result.steps, alone.result.steps);
  const Walk lee = walk(lee_frame(2.0, kRigid), {}, all_ranks());
  ASSERT_EQ(lee.critical.size(), 2u);
}

}  // namespace
}  // namespace mixbeam::test::paths_test
