// Jumps from one stable state to another: against closed forms, against paths that are followed beyond both limit
// points, and the potential down which they go.
#include "discretization/state/potential.hpp"
#include "kernels/math/constants.hpp"
#include "nonlinear/newton/step.hpp"
#include "nonlinear/path/path_measure.hpp"
#include "tests/nonlinear/stability_fixture.hpp"
#include "tests/support/buckling_scenes.hpp"
#include "tests/support/solve.hpp"

#include <functional>

namespace mixbeam::test::jumps_test {
namespace {

/// Stable states are equilibria to 1e-11, and so are those of paths that lead to them.
constexpr double kSame = 1e-9;

struct Walk {
  std::vector<RecordedJump> jumps;
  StabilityResult last;
  int steps = 0;
};

SolverParameters jumping(int steps = 0, Branch branch = Branch::primary) {
  SolverParameters parameters;
  parameters.analysis.snap = Snap::jump;
  parameters.analysis.branch = branch;
  if (steps > 0) parameters.load_path.method = LoadPathMethod::fixed;
  if (steps > 0) parameters.load_path.steps = steps;
  return parameters;
}

Walk walk(Simulation& simulation) {
  Walk walk;
  const LoadPathResult& result = simulation.run([&](const StepReport& report, const State&) {
    if (report.jump) walk.jumps.push_back(*report.jump);
    EXPECT_EQ(report.point.jumps, static_cast<int>(walk.jumps.size()));
    walk.last = report.stability.value();
    walk.steps = report.step;
  });
  EXPECT_TRUE(result.finished) << simulation.scene().name << ": " << result.failure;
  return walk;
}

// ---- the shallow truss of constrained_scenes.hpp

const double kBar = std::hypot(kTrussHalfSpan, kTrussRise);
/// Energy of both bars with the apex down by v.
double truss_energy(double v) {
  return kTrussAxial / kBar * std::pow(std::hypot(kTrussHalfSpan, kTrussRise - v) - kBar, 2);
}
/// Where the force has a value, between two places that enclose it.
double where(double force, double low, double high) {
  const bool rises = truss_force(high) > truss_force(low);
  for (int i = 0; i < 200; ++i) {
    const double middle = 0.5 * (low + high);
    ((truss_force(middle) < force) == rises ? low : high) = middle;
  }
  return low;
}

TEST(Jumps, TrussReleasesTheAreaBelowItsPath) {
  const double top = kTrussRise - std::sqrt(std::pow(kBar, 2.0 / 3.0) - 1.0);  // the bars' cosine to its cube root
  const double limit = truss_force(top), force = 1.5 * limit;
  constexpr int kSteps = 8;
  Simulation simulation(shallow_truss(force), jumping(kSteps), this_rank());
  const Walk walked = walk(simulation);
  ASSERT_EQ(walked.jumps.size(), 1u);
  const RecordedJump& jump = walked.jumps[0];
  EXPECT_LE(jump.from * force, limit);
  EXPECT_GE(jump.to * force, limit);
  EXPECT_LE(jump.to - jump.from, 1.001 / kSteps);
  const double before = where(jump.from * force, 0.0, top),
               after = where(jump.to * force, 2.0 * kTrussRise, 3.0 * kTrussRise);
  const double released =
      0.5 * (jump.from + jump.to) * force * (after - before) - (truss_energy(after) - truss_energy(before));
  EXPECT_NEAR(jump.released, released, kSame * released);
  EXPECT_GT(std::abs(1.001 * jump.released - released), kSame * released);
  EXPECT_NEAR(jump.largest, after - before, kSame);
  EXPECT_EQ(jump.place, "point \"apex\"");
  EXPECT_GT(jump.motion, 0.1 * jump.largest / std::hypot(2.0 * kTrussHalfSpan, kTrussRise));
  EXPECT_NEAR(-simulation.displacement("apex")[1], where(force, 2.0 * kTrussRise, 3.0 * kTrussRise), kSame);
  EXPECT_EQ(walked.last.negative, 0);
}

TEST(Jumps, WithoutLoadBeyondTheLimitNothingJumps) {
  Simulation simulation(shallow_truss(0.2), jumping(), this_rank());
  EXPECT_TRUE(walk(simulation).jumps.empty());
}

// ---- arches, against the path

/// The path is followed by the displacement of the crown, beyond the limit points, to where the jump has led: there it
/// has the load of the jump's end.
void expect_where_the_path_leads(const Scene& scene) {
  Simulation jumped(scene, jumping(), this_rank());
  const Walk walked = walk(jumped);
  ASSERT_EQ(walked.jumps.size(), 1u);
  EXPECT_EQ(walked.last.verdict(), Verdict::stable);
  EXPECT_GT(walked.jumps[0].released, 0.0);
  SolverParameters pushed;
  pushed.analysis.control = MonitoredComponent{"crown", 1, jumped.displacement("crown")[1]};
  Simulation followed(scene, pushed, this_rank());
  int limit_points = 0;
  const LoadPathResult& result = followed.run([&](const StepReport& report, const State&) {
    for (const CriticalPoint& point : report.critical_points) limit_points += point.kind == CriticalKind::limit_point;
  });
  ASSERT_TRUE(result.finished) << result.failure;
  EXPECT_GE(limit_points, 2);
  EXPECT_NEAR(followed.load_factor(), 1.0, kSame);
  EXPECT_TRUE(agrees(to_array(jumped.sample("left half", 0.5).displacement),
                     to_array(followed.sample("left half", 0.5).displacement), kSame));
  EXPECT_NEAR(jumped.strain_energy().moment, followed.strain_energy().moment, kSame);
}

TEST(Jumps, AHingedArchArrivesWhereItsPathDoes) {
  expect_where_the_path_leads(loaded_arch(hinged("left"), true, 60.0));
}

/// A clicker: two stable shapes, from one to the other by its crown.
TEST(Jumps, AClickerArrivesWhereItsCrownIsPushed) {
  expect_where_the_path_leads(loaded_arch(clamp("left"), true, 100.0));
}

/// Not guided it leaves by the side, at a bifurcation, and arrives where the symmetric path does all the same.
TEST(Jumps, AnArchThatBucklesAsideArrivesOnItsSymmetricPath) {
  constexpr int kSteps = 40;
  Simulation free(loaded_arch(hinged("left"), false, 60.0), jumping(kSteps), this_rank()),
      guided(loaded_arch(hinged("left"), true, 60.0), jumping(kSteps), this_rank());
  const Walk by_the_side = walk(free), upright = walk(guided);
  ASSERT_EQ(by_the_side.jumps.size(), 1u);
  ASSERT_EQ(upright.jumps.size(), 1u);
  EXPECT_LT(by_the_side.jumps[0].from, upright.jumps[0].from) << "it buckles before it snaps";
  EXPECT_TRUE(agrees(free.displacement("crown"), guided.displacement("crown"), kSame));
}

// ---- a perfect column: its push has the sign of branches

Scene column(double load) {
  Scene scene = cantilever(section(1e4, 1e4, 1.0, 1.0), 1.0, 3, 6);
  scene.name = "column";
  scene.supports.push_back(support("tip", {false, false, true}, {true, true, false}));
  scene.point_loads = {dead_load("tip", {-load, 0, 0})};
  return scene;
}

TEST(Jumps, APerfectColumnTakesTheBranchThatIsAskedFor) {
  const Scene scene = column(1.2 * 0.25 * kPi * kPi);
  for (const Branch branch : {Branch::positive, Branch::negative}) {
    SolverParameters following;
    following.analysis.branch = branch;
    Simulation jumped(scene, jumping(0, branch), this_rank());
    const Simulation followed = solved(scene, following);
    const Walk walked = walk(jumped);
    ASSERT_EQ(walked.jumps.size(), 1u);
    EXPECT_GT(branch == Branch::positive ? jumped.displacement("tip")[1] : -jumped.displacement("tip")[1], 0.1);
    EXPECT_TRUE(agrees(jumped.displacement("tip"), followed.displacement("tip"), kSame));
  }
}

// ---- a lattice whose struts buckle: any number of steps, one energy

Scene held_lattice(int size) {
  Scene scene;
  scene.name = "lattice";
  scene.sections = {section(3600.0, 1260.0, 0.8, 1.0)};
  const auto name = [](int i, int j) { return "p" + std::to_string(i) + "_" + std::to_string(j); };
  for (int i = 0; i < size; ++i)
    for (int j = 0; j < size; ++j) {
      scene.points.push_back({name(i, j), {1.0 * i, 1.0 * j, 0}});
      const bool is_inside = i > 0 && i < size - 1;
      scene.supports.push_back(is_inside ? support(name(i, j), {false, false, true}, {true, true, false})
                                         : clamp(name(i, j)));
      if (i == size - 1) scene.supports.back().prescribed_displacement = {-0.02 * i, 0.1 * i, 0};
      if (i > 0) scene.members.push_back(line("x" + name(i, j), name(i - 1, j), name(i, j), 2, 2));
      if (j > 0 && i > 0 && i < size - 1)
        scene.members.push_back(line("y" + name(i, j), name(i, j - 1), name(i, j), 2, 2));
    }
  return scene;
}

TEST(Jumps, ALatticeEndsAtOneEnergyInAnyNumberOfSteps) {
  double energy = 0.0;
  for (const int steps : {1, 20}) {
    Simulation simulation(held_lattice(8), jumping(steps), this_rank());
    const Walk walked = walk(simulation);
    EXPECT_EQ(walked.steps, steps);
    EXPECT_GE(walked.jumps.size(), 1u);
    EXPECT_EQ(walked.last.negative, 0);
    const StrainEnergy strain = simulation.strain_energy();
    if (steps > 1) {
      EXPECT_NEAR(strain.force + strain.moment, energy, kSame * energy);
    }
    energy = strain.force + strain.moment;
  }
}

/// Elements that buckle between their vertices are not followed: the run ends with the cause.
TEST(Jumps, WithoutAStableStateThePathEnds) {
  Scene scene = cantilever(section(1e4, 1e4, 1.0, 1.0), 1.0, 6, 1);
  scene.supports.push_back(clamp("tip"));
  scene.supports.back().displacement_fixed = {false, true, true};
  const double critical = 4.0 * kPi * kPi;
  scene.point_loads = {dead_load("tip", {-2.0 * critical, 0, 0})};
  Simulation simulation(scene, jumping(), this_rank());
  std::vector<StepFailure> failures;
  PathControl control;
  control.step_failed = [&](const StepFailure& failure) { failures.push_back(failure); };
  const LoadPathResult& result = simulation.run({}, control);
  EXPECT_FALSE(result.finished);
  ASSERT_FALSE(failures.empty());
  EXPECT_NE(failures.back().cause.find("buckle between their vertices"), std::string::npos) << failures.back().cause;
  EXPECT_NEAR(result.load_factor, 0.5, 0.05) << "of both clamped ends, but for axial and shear strains";
}

// ---- the potential

/// Everything that stores energy or does work: springs, joints with springs, line loads, eigenstrains.
Scene springs_and_loads(double load) {
  Scene scene = portal_of_joints(2, 3, load);
  for (PointLoad& one : scene.point_loads) one.moment = {0, 0, 0};
  scene.point_loads.pop_back();
  scene.supports[0].prescribed_displacement = {0.05 * load, -0.02 * load, 0.0};
  scene.eigenstrains = {{"beam 1", {2e-3 * load, 0, 0}, {0, 0.05 * load, 0.1 * load}}};
  return scene;
}

/// Slope of the potential along an admissible motion, by a central difference.
double slope(const Model& model, const State& state, double load_factor, const MixedVector& motion) {
  constexpr double kStep = 1e-4;
  return (potential_energy(model, model.apply(state, motion, kStep), load_factor) -
          potential_energy(model, model.apply(state, motion, -kStep), load_factor)) /
         (2.0 * kStep);
}

TEST(Potential, IsStationaryInEquilibriumAndNowhereElse) {
  BeamProblem problem(springs_and_loads(1.0), this_rank(), {});
  const Simulation simulation = solved(springs_and_loads(1.0));
  const Model& model = problem.model;
  MixedVector rows = model.create_vector(), motion = model.create_vector();
  const EvaluationPoint point = mixed_residual(model, simulation.state(), 1.0, rows);
  Linearization linearization(problem, point, cap_for(model, point.scales), {});
  MixedVector forces = model.create_vector();
  forces.fill(0.0);
  for (size_t i = 0; i < forces.vertex().extent(0); ++i)
    forces.vertex()(i) = model.fixed_rows()(i) != 0 ? 0.0 : std::sin(1.0 + 3.0 * static_cast<double>(i));
  linearization.solve(forces, motion);
  const double size = std::abs(potential_energy(model, simulation.state(), 1.0));
  motion.scale(1.0 / motion.maximum_norm());
  EXPECT_LT(std::abs(slope(model, simulation.state(), 1.0, motion)), 1e-6 * size);
  EXPECT_GT(std::abs(slope(model, simulation.state(), 0.99, motion)), 1e-4 * size) << "with other loads it is not";
}

/// To third order in the step, as the trapezoidal rule is.
TEST(Potential, NothingIsReleasedAlongAPath) {
  const auto released_in = [](double step) {
    SolverParameters parameters;
    parameters.load_path.method = LoadPathMethod::fixed;
    parameters.load_path.steps = static_cast<int>(std::lround(1.0 / step));
    Simulation simulation(springs_and_loads(1.0), parameters, this_rank());
    State before;
    double last = 0.0, released = 0.0;
    simulation.run([&](const StepReport& report, const State& state) {
      if (report.step == parameters.load_path.steps)
        released = released_energy(simulation.model(), before, last, state, report.load_factor);
      before = state;
      last = report.load_factor;
    });
    return released;
  };
  const double coarse = released_in(1.0 / 4.0), fine = released_in(1.0 / 8.0);
  EXPECT_NEAR(coarse / fine, 8.0, 3.0);
}

/// One path alone runs through a limit point, and once.
TEST(Way, MeetsALimitPointAgain) {
  StabilityFixture beam(column(1.0));
  const Model& model = beam.problem().model;
  const PathMeasure measure(model);
  const Station begin{model.reference_state(), 0.0, {model.create_vector(), 1.0}};
  MixedVector aside = model.create_vector();
  aside.fill(0.0);
  const auto rows = aside.vertex();
  rows(rows.extent(0) - kVertexDofs + 1) = 0.01;
  const PathDirection step{aside.clone(true), 0.5};
  const auto meets_again = [&](double load_factor, double share, CriticalKind kind) {
    const auto point_at = [&](double load, double part, CriticalKind k) {
      return CriticalPoint{k, load, 0, 1, model.apply(begin.state, aside, part), model.create_vector()};
    };
    Way way(begin);
    way.add(measure, step, model, {point_at(0.7, 1.0, CriticalKind::limit_point)});
    EXPECT_FALSE(way.returns(measure, begin, step));
    way.add(measure, step, model, {point_at(load_factor, share, kind)});
    return way.returns(measure, begin, step);
  };
  EXPECT_TRUE(meets_again(0.7 + 1e-9, 1.0 + 1e-5, CriticalKind::limit_point));
  EXPECT_FALSE(meets_again(0.7, 0.9, CriticalKind::limit_point));  // equal parts snap one after the other
  EXPECT_FALSE(meets_again(0.7, 0.99, CriticalKind::limit_point)) << "and may be a hundredth of the structure";
  EXPECT_FALSE(meets_again(0.71, 1.0, CriticalKind::limit_point));
  EXPECT_FALSE(meets_again(0.7, 1.0, CriticalKind::bifurcation));  // crossed by two branches
}

}  // namespace
}  // namespace mixbeam::test::jumps_test
