// Load continuation: steps, recovery, stages, and an honest end when no equilibrium is found.
#include "nonlinear/path/load_path.hpp"

#include "kernels/math/constants.hpp"
#include "nonlinear/path/corrector.hpp"
#include "nonlinear/path/step_size.hpp"
#include "tests/nonlinear/beam_fixture.hpp"
#include "tests/support/constrained_scenes.hpp"
#include "tests/support/text.hpp"

#include <numeric>

namespace mixbeam::test::load_path_test {
namespace {

SolverParameters with_method(LoadPathMethod method, int steps = 1) {
  SolverParameters parameters;
  parameters.load_path.method = method;
  parameters.load_path.steps = steps;
  return parameters;
}
SolverParameters fixed_steps(int steps) { return with_method(LoadPathMethod::fixed, steps); }
/// In load factors.
SolverParameters adaptive_steps(double initial, double maximum, double minimum = 1e-6) {
  SolverParameters parameters = with_method(LoadPathMethod::adaptive);
  parameters.load_path.initial_step = initial;
  parameters.load_path.maximum_step = maximum;
  parameters.load_path.minimum_step = minimum;
  return parameters;
}
constexpr LoadPathMethod kMethods[] = {LoadPathMethod::automatic, LoadPathMethod::fixed, LoadPathMethod::adaptive};

int iterations_of(const std::vector<StepReport>& reports) {
  return std::accumulate(reports.begin(), reports.end(), 0,
                         [](int sum, const StepReport& report) { return sum + report.newton_iterations; });
}

struct Path {
  LoadPathResult result;
  std::vector<StepReport> reports;
  State end;
  Vector3 tip{};
};

Path follow(const Scene& scene, const SolverParameters& parameters) {
  Path path;
  Simulation simulation(scene, parameters, this_rank());
  path.result = simulation.run([&](const StepReport& report, const State&) { path.reports.push_back(report); });
  path.end = simulation.state();
  path.tip = simulation.displacement(scene.points.back().name == "tip" ? "tip" : "tine 1");
  return path;
}

/// A large bending problem with one equilibrium.
Scene elastica(double force = 10.0) {
  Scene scene = cantilever(section(1e6, 1e6, 1.0, 1.0), 1.0, 2, 8);
  scene.point_loads = {dead_load("tip", {0, force, 0})};
  return scene;
}

constexpr double kSameEquilibrium = 1e-10;  // both solved to a scaled residual of 1e-11

TEST(LoadPath, FixedSteps) {
  const Path path = follow(elastica(), fixed_steps(4));
  EXPECT_TRUE(path.result.finished);
  EXPECT_TRUE(path.result.failure.empty());
  EXPECT_EQ(path.result.steps, 4);
  EXPECT_EQ(path.result.failed_steps, 0);
  ASSERT_EQ(path.reports.size(), 5u);
  for (size_t i = 0; i < path.reports.size(); ++i) {
    EXPECT_EQ(path.reports[i].step, static_cast<int>(i));
    EXPECT_NEAR(path.reports[i].load_factor, 0.25 * static_cast<double>(i), 1e-14);
    EXPECT_LE(path.reports[i].residual, SolverParameters().newton.residual_tolerance);
    EXPECT_TRUE(path.reports[i].converged);
  }
  EXPECT_EQ(path.reports.back().load_factor, 1.0);
  EXPECT_EQ(iterations_of(path.reports), path.result.newton_iterations);
  EXPECT_EQ(path.result.iterations_of_stage, std::vector<int>{path.result.newton_iterations});
}

TEST(LoadPath, AdaptiveStepsGrow) {
  const Path path = follow(elastica(), adaptive_steps(0.05, 0.4));
  ASSERT_TRUE(path.result.finished);
  ASSERT_GE(path.reports.size(), 4u);
  EXPECT_NEAR(path.reports[1].load_factor, 0.05, 1e-14);
  StepSizeRule rule;
  const double second = rule.after_success(0.05, path.reports[1].newton_iterations);
  EXPECT_GT(second, 0.05);
  EXPECT_NEAR(path.reports[2].load_factor, 0.05 + second, 1e-14);
  for (size_t i = 1; i < path.reports.size(); ++i)
    EXPECT_LE(path.reports[i].load_factor - path.reports[i - 1].load_factor, 0.4 + 1e-14);
  EXPECT_EQ(path.reports.back().load_factor, 1.0);
  EXPECT_TRUE(agrees(path.tip, follow(elastica(), fixed_steps(1)).tip, kSameEquilibrium));
}

TEST(LoadPath, RecoversFromFailedSteps) {
  for (LoadPathMethod method : {LoadPathMethod::fixed, LoadPathMethod::adaptive}) {
    SolverParameters parameters = with_method(method);
    parameters.newton.maximum_iterations = 6;  // too few for the whole load
    const Path path = follow(elastica(), parameters);
    EXPECT_TRUE(path.result.finished) << path.result.failure;
    EXPECT_GE(path.result.failed_steps, 1);
    EXPECT_GT(path.result.steps, 1);
    // failed attempts count
    EXPECT_EQ(iterations_of(path.reports), path.result.newton_iterations);
    EXPECT_GT(path.result.newton_iterations, 6 * path.result.failed_steps);
    EXPECT_EQ(path.reports.back().load_factor, 1.0);
    EXPECT_TRUE(agrees(path.tip, follow(elastica(), {}).tip, kSameEquilibrium));
  }
}

TEST(LoadPath, Stages) {
  const Path path = follow(fork(2, 3), fixed_steps(3));
  ASSERT_TRUE(path.result.finished);
  EXPECT_EQ(path.result.steps, 6);
  ASSERT_EQ(path.reports.size(), 7u);  // the end of a stage is not reported again as the start of the next one
  EXPECT_EQ(path.reports[3].load_factor, 1.0);
  EXPECT_EQ(path.reports[6].load_factor, 2.0);
  ASSERT_EQ(path.result.iterations_of_stage.size(), 2u);
  EXPECT_EQ(path.result.iterations_of_stage[0] + path.result.iterations_of_stage[1], path.result.newton_iterations);
  for (int stage : {0, 1}) {
    const auto first = path.reports.begin() + 3 * stage + 1;
    EXPECT_EQ(iterations_of({first, first + 3}), path.result.iterations_of_stage[stage]) << "stage " << stage + 1;
  }
}

TEST(LoadPath, GivesUpAtTheMinimumStepWithTheLastConvergedState) {
  SolverParameters parameters = adaptive_steps(0.5, 1.0, 0.1);
  parameters.newton.maximum_iterations = 4;
  Scene scene = elastica(1.0);
  // twice the load of the first half in the second stage: too much for four iterations in steps of a tenth
  scene.point_loads.push_back(dead_load("tip", {0, -3000.0, 500.0}));
  scene.point_loads[1].stage = scene.stages = 2;
  Simulation simulation(scene, parameters, this_rank());
  State last;
  double last_load_factor = -1.0;
  const LoadPathResult result = simulation.run([&](const StepReport& report, const State& state) {
    last = state;
    last_load_factor = report.load_factor;
  });
  EXPECT_FALSE(result.finished);
  EXPECT_GE(result.failed_steps, 1);
  EXPECT_GE(result.load_factor, 1.0);
  EXPECT_LT(result.load_factor, 2.0);
  EXPECT_EQ(result.load_factor, last_load_factor);
  EXPECT_TRUE(same_bits(simulation.state(), last));
  expect_in(result.failure,
            {"no equilibrium was found beyond load factor", "minimum of 0.1", "Minimum Step", "more elements"});
}

TEST(LoadPath, GivesUpAfterTheLargestNumberOfSteps) {
  SolverParameters parameters = adaptive_steps(0.1, 0.1);
  parameters.load_path.maximum_steps = 3;
  for (LoadPathMethod method : {LoadPathMethod::automatic, LoadPathMethod::adaptive}) {
    parameters.load_path.method = method;
    const Path path = follow(elastica(), parameters);
    EXPECT_FALSE(path.result.finished);
    EXPECT_FALSE(path.result.failure.empty());
    EXPECT_LE(path.result.steps, 3);
    EXPECT_EQ(path.result.load_factor, path.reports.back().load_factor);
  }
}

// What was asked for is permitted; the limit is for what comes on top.
TEST(LoadPath, TakesAsManyFixedStepsAsAreAskedFor) {
  Scene scene = cantilever(section(1e6, 1e6, 1.0, 1.0), 1.0, 1, 1);
  scene.point_loads = {dead_load("tip", {0, 1.0, 0})};
  SolverParameters parameters = fixed_steps(20);
  parameters.load_path.maximum_steps = 20;
  parameters.analysis.stability = false;
  const Path path = follow(scene, parameters);
  EXPECT_TRUE(path.result.finished) << path.result.failure;
  EXPECT_EQ(path.result.steps, parameters.load_path.steps);
  parameters.load_path.method = LoadPathMethod::adaptive;
  parameters.load_path.initial_step = parameters.load_path.maximum_step = 0.5 / parameters.load_path.maximum_steps;
  EXPECT_FALSE(follow(scene, parameters).result.finished);
}

/// One element whose ends turn by `share` of pi against its triad.
Path rolled_up(double share, bool planar) {
  Scene scene = cantilever(section(1e6, 1e6, 1.0, 1.0), 1.0, 1, 1);
  scene.point_loads = {dead_load("tip", {}, {0, 0, share * 2.0 * kPi})};
  SolverParameters parameters;
  parameters.analysis.stability = false;
  parameters.planar = planar;
  const Path path = follow(scene, parameters);
  EXPECT_EQ(path.end.in_plane, planar);
  return path;
}

// The step converges, but rotations are no longer unique: that is a failed path with a report, not an exception.
TEST(LoadPath, AnElementThatTurnsByPiAtTheEndIsReported) {
  for (bool planar : {true, false}) {
    EXPECT_TRUE(rolled_up(1.0 - 1e-6, planar).result.finished);
    const LoadPathResult result = rolled_up(1.0 - 1e-11, planar).result;
    EXPECT_FALSE(result.finished);
    EXPECT_EQ(result.load_factor, 1.0);
    EXPECT_GE(result.failed_steps, 1);
    ASSERT_TRUE(result.report.has_value());
    EXPECT_EQ(result.report->cause, FailureCause::end_angle);
    expect_in(result.failure,
              {"element 0 of member \"beam\" turns by pi", "too long for the rotations", "\"Elements\""});
  }
}

/// A beam that slides along its axis: no equilibrium, and a singular tangent from the start.
Scene mechanism() {
  Scene scene = elastica();
  scene.supports[0].displacement_fixed = {false, true, true};
  scene.point_loads = {dead_load("tip", {1, 0, 0})};
  return scene;
}

TEST(LoadPath, WhatIsNotANumberEndsTheAttemptAtOnce) {
  const Path path = follow(mechanism(), adaptive_steps(1.0, 1.0, 0.3));
  EXPECT_FALSE(path.result.finished);
  EXPECT_EQ(path.result.load_factor, 0.0);
  // steps of 1, 0.5 and the minimum, one iteration each
  EXPECT_LE(path.result.newton_iterations, 3);
  expect_in(path.result.failure, {"Last linear solve"});
  for (double u : path.tip) EXPECT_EQ(u, 0.0);
}

/// The paper's superimposed rotation: a quarter circle under a moment that turns with the beam, then ten turns of the
/// clamp.
Scene superimposed_rotation(double turns) {
  Scene scene = cantilever(rollup_section(10.0), 1.0, 3, 4);
  scene.point_loads = {follower_load("tip", "beam", {}, {0, -kPi / 2.0, 0})};
  scene.supports[0].prescribed_rotation = {0, 0, 2.0 * kPi * turns};
  scene.supports[0].stage = scene.stages = 2;
  return scene;
}

TEST(LoadPath, ManyTurnsOfASupportAreFollowedInShortSteps) {
  const Path path = follow(superimposed_rotation(10.0), {});
  ASSERT_TRUE(path.result.finished) << path.result.failure;
  EXPECT_EQ(path.result.failed_steps, 0);
  EXPECT_GE(path.result.steps, 1 + 40);  // no step beyond a quarter turn
  for (size_t i = 2; i < path.reports.size(); ++i)
    EXPECT_LE(path.reports[i].load_factor - path.reports[i - 1].load_factor, 0.025 + 1e-12);
}

TEST(LoadPath, TurningTheBentBeamChangesNeitherHeightNorEnergy) {
  constexpr double kObjective = 1e-12;
  Simulation simulation(superimposed_rotation(10.0), fixed_steps(71), this_rank());
  const int tip = vertex_of(simulation.model().mesh(), "tip");
  double height = 0.0, energy = 0.0, largest = 0.0;
  int steps = 0;
  simulation.run([&](const StepReport& report, const State& state) {
    if (report.load_factor < 1.0) return;
    const double h = vertex_motion(simulation.model(), state, tip)[2];
    const StrainEnergy e = strain_energy(simulation.model(), state);
    if (report.load_factor == 1.0) {
      height = h;
      energy = e.moment;
    }
    ++steps;
    largest = std::max({largest, std::abs(h - height), std::abs(e.moment - energy) / energy});
  });
  ASSERT_TRUE(simulation.result().finished) << simulation.result().failure;
  EXPECT_EQ(steps, 72);
  EXPECT_LE(largest, kObjective);
  // a quarter circle of unit length, its tangent integrated with three Gauss points for each pi / 8: 1.8e-9 of the
  // chord
  constexpr double kGauss = 2e-9;
  EXPECT_NEAR(height, 2.0 / kPi, kGauss);
  EXPECT_TRUE(agrees(simulation.position("tip"), {2.0 / kPi, 0, 2.0 / kPi}, kGauss));
}

TEST(LoadPath, TwoRunsGiveTheSameBits) {
  SolverParameters parameters;
  parameters.load_path.initial_step = 0.3;
  const Path first = follow(fork(3, 3), parameters), second = follow(fork(3, 3), parameters);
  EXPECT_TRUE(same_bits(first.end, second.end));
  ASSERT_EQ(first.reports.size(), second.reports.size());
  for (size_t i = 0; i < first.reports.size(); ++i) {
    EXPECT_EQ(first.reports[i].load_factor, second.reports[i].load_factor);
    EXPECT_EQ(first.reports[i].residual, second.reports[i].residual);
    EXPECT_EQ(first.reports[i].newton_iterations, second.reports[i].newton_iterations);
  }
}

/// Newton's method for the whole load at once, without any check. The tip's displacement.
Vector3 plain_newton(const Scene& scene, int most_iterations) {
  const SolverParameters parameters;
  const auto problem = Teuchos::rcp(new BeamProblem(scene, this_rank(), parameters));
  SolveRecord record;
  Corrector corrector(problem, parameters, record);
  const Correction found = corrector.at_load(problem->model.reference_state(), 1.0, most_iterations);
  EXPECT_TRUE(found.converged) << found.cause;
  const std::array<double, 6> motion =
      vertex_motion(problem->model, found.state, vertex_of(problem->model.mesh(), "tip"));
  return {motion[0], motion[1], motion[2]};
}

// Far beyond the convergence of plain Newton steps (design: 8, 11, 13, 16, 20 iterations with a limit of 0.5).
TEST(LoadPath, RotationLimitBringsLargeLoadsInOneStep) {
  for (double force : {10.0, 1e2, 1e3, 1e4, 1e6}) {
    Scene scene = elastica(force);
    scene.sections = {section(kRigid, kRigid, 1.0, 1.0)};
    EXPECT_GT(plain_newton(scene, 30)[1], 0.0) << force;
  }
}

/// All that is kept of a solve, by NOX or as it is by default.
std::vector<double> record_of_solve(double load_factor, bool by_nox) {
  SolverParameters parameters;
  if (by_nox) parameters.nox = Teuchos::rcp(new Teuchos::ParameterList("NOX"));
  const auto problem = Teuchos::rcp(new BeamProblem(elastica(1.0), this_rank(), parameters));
  int asked = 0;
  problem->leave_if_asked = [&] { ++asked; };
  problem->objection = problem->last_failure = "of the step before";
  SolveRecord record;
  Corrector corrector(problem, parameters, record);
  const Correction found = corrector.at_load(problem->model.reference_state(), load_factor, 20);
  std::vector<double> kept = {found.converged ? 1.0 : 0.0,
                              found.load_factor,
                              found.moved.maximum_norm(),
                              1.0 * found.iterations,
                              found.residual,
                              1.0 * asked,
                              1.0 * (problem->objection.size() + problem->last_failure.size()),
                              1.0 * problem->work.residuals,
                              1.0 * problem->work.newton_iterations,
                              1.0 * record.attempt,
                              1.0 * record.iterations};
  for (const NewtonIteration& one : record.history)
    kept.insert(kept.end(), {1.0 * one.attempt, 1.0 * one.iteration, one.residual});
  return kept;
}

TEST(LoadPath, EquilibriumIsRecordedAsNoxRecordsIt) {
  EXPECT_EQ(record_of_solve(0.0, false), record_of_solve(0.0, true));
  EXPECT_EQ(record_of_solve(1.0, false), record_of_solve(1.0, true));
  EXPECT_NE(record_of_solve(0.0, false), record_of_solve(1.0, false));
}

/// A cantilever under P EI/L^2 along its axis and e P across it.
Scene imperfect_column(double p, double e) {
  Scene scene = elastica(0.0);
  scene.sections = {section(kRigid, kRigid, 1.0, 1.0)};
  scene.point_loads[0].force = {-p, e * p, 0.0};
  return scene;
}

// Newton's method in one step ends on the other side, with every sign of convergence.
TEST(LoadPath, FixedAndAdaptiveStepsFollowThePath) {
  for (LoadPathMethod method : {LoadPathMethod::fixed, LoadPathMethod::adaptive})
    for (double e : {1e-2, -1e-2, 1e-4, -1e-4}) {
      SolverParameters parameters = adaptive_steps(1.0, 1.0);
      parameters.load_path.method = method;
      const Path path = follow(imperfect_column(4.0, e), parameters);
      EXPECT_TRUE(path.result.finished) << e << path.result.failure;
      EXPECT_GT(path.tip[1] * e, 0.0) << e;  // the lateral force pushes it there
      EXPECT_LT(plain_newton(imperfect_column(4.0, e), 50)[1] * e, 0.0) << e;
    }
}

// Steps over the largest load and over a kink. The end is that of a load of the same size.
TEST(LoadPath, LoadsTurnBack) {
  const std::vector<std::pair<std::string, double>> histories = {{"sin(4.2*t)", std::sin(4.2)},
                                                                 {"abs(t-0.4)-0.4", 0.2}};
  for (LoadPathMethod method : kMethods)
    for (const auto& [formula, end] : histories) {
      Scene scene = elastica(10.0);
      scene.point_loads[0].amplitude = formula;
      SolverParameters parameters = with_method(method, 7);
      parameters.load_path.initial_step = parameters.load_path.maximum_step = 0.13;
      const Path path = follow(scene, parameters);
      EXPECT_TRUE(path.result.finished) << formula << path.result.failure;
      EXPECT_LE(path.result.steps, 20) << formula;
      const Path direct = follow(elastica(10.0 * end), {});
      EXPECT_TRUE(agrees(path.tip, direct.tip, kSameEquilibrium)) << formula;
      EXPECT_FALSE(agrees(path.tip, follow(elastica(10.01 * end), {}).tip, kSameEquilibrium)) << formula;
    }
}

/// Straight, twice its Euler load at amplitude 1.
Scene perfect_column(const std::string& amplitude) {
  Scene scene = cantilever(section(1e9, 1e9, 1.0, 1.0), 1.0, 5, 4);
  scene.point_loads = {dead_load("tip", {-0.5 * kPi * kPi, 0, 0})};
  scene.point_loads[0].amplitude = amplitude;
  return scene;
}

// Euler's load is passed twice within a pulse of 1e-4 of the stage, between whose ends nothing has moved.
TEST(LoadPath, PulsesAreNotPassedUnseen) {
  constexpr double kOfPulse = 1e-6 * 5e-5;  // the cap and the strains shift critical loads by 1e-7
  const Path path = follow(perfect_column("max(0, 1 - abs(t-0.3)/5e-5)"), {});
  ASSERT_TRUE(path.result.finished) << path.result.failure;
  std::vector<double> critical;
  for (const StepReport& report : path.reports)
    for (const CriticalPoint& point : report.critical_points) critical.push_back(point.load_factor);
  ASSERT_EQ(critical.size(), 2u);
  EXPECT_NEAR(critical[0], 0.3 - 2.5e-5, kOfPulse);
  EXPECT_NEAR(critical[1], 0.3 + 2.5e-5, kOfPulse);
  EXPECT_EQ(follow(perfect_column("0.49*max(0, 1 - abs(t-0.3)/5e-5)"), {}).reports.back().point.critical_points, 0);
}

// Two loads of which none turns back, while their sum does. The toggle (one half of it) has snapped when they cancel,
// and its path leads through loads that no load factor stands for. The end is that of the sum's own rise and fall.
TEST(LoadPath, LoadsTurnAsASum) {
  constexpr double kRise = 0.3, kPull = -600.0;
  Scene sum =
      structure({{"foot", {-1, 0, 0}}, {"tip", {0, kRise, 0}}}, {line("leg", "foot", "tip", 5, 4)},
                {hinged("foot"), support("tip", {true, false, true}, kHeld)}, {}, section(1e4, kRigid, 1.0, 1.0));
  Scene stages = sum;
  sum.point_loads = {dead_load("tip", {0, kPull, 0}), dead_load("tip", {0, -kPull, 0})};
  sum.point_loads[0].amplitude = "t";
  sum.point_loads[1].amplitude = "t^2";
  stages.stages = 2;
  stages.point_loads = {dead_load("tip", {0, kPull / 4, 0}), dead_load("tip", {0, -kPull / 4, 0})};
  stages.point_loads[1].stage = 2;
  const Path path = follow(sum, {}), reference = follow(stages, {});
  ASSERT_TRUE(path.result.finished) << path.result.failure;
  ASSERT_TRUE(reference.result.finished) << reference.result.failure;
  EXPECT_TRUE(agrees(path.tip, reference.tip, kSameEquilibrium));
  EXPECT_LT(path.tip[1], -1.5 * kRise) << "it has snapped";
}

// The load goes straight from the value before a jump to that after it, in a step of its own.
TEST(LoadPath, JumpsAreSteps) {
  Scene scene = elastica(10.0);
  scene.point_loads[0].amplitude = "(t < 0.5) ? t : 0.2";
  for (LoadPathMethod method : kMethods) {
    std::vector<std::pair<double, double>> rows;
    Simulation simulation(scene, with_method(method, 4), this_rank());
    simulation.run([&](const StepReport& report, const State& state) {
      rows.emplace_back(report.load_factor, simulation.at(state, report.load_factor).displacement("tip")[1]);
    });
    ASSERT_TRUE(simulation.result().finished) << simulation.result().failure;
    const auto before = std::find_if(rows.begin(), rows.end(), [](const auto& row) { return row.first > 0.5 - 1e-12; });
    ASSERT_NE(before, rows.end());
    EXPECT_NEAR(before->first, (before + 1)->first, 1e-15);
    EXPECT_NEAR(before->second, follow(elastica(5.0), {}).tip[1], kSameEquilibrium);
    EXPECT_NEAR((before + 1)->second, follow(elastica(2.0), {}).tip[1], kSameEquilibrium);
    EXPECT_EQ(rows.size(), method == LoadPathMethod::fixed ? 6u : rows.size());  // 0 to 1 by quarters, and the jump
  }
}

// One of two structures that do not touch: the motion of the other one, by far the larger, hides nothing.
TEST(LoadPath, PartsAreJudgedOneByOne) {
  Scene scene = imperfect_column(4.0, 1e-2);
  scene.points.insert(scene.points.begin(), {{"foot", {0, 3, 0}}, {"end", {1, 3, 0}}});
  scene.members.push_back(scene.members[0]);
  scene.members[1].name = "second";
  scene.members[1].start_point = "foot";
  scene.members[1].end_point = "end";
  scene.supports.push_back(scene.supports[0]);
  scene.supports[1].point = "foot";
  scene.point_loads.push_back(scene.point_loads[0]);
  scene.point_loads[1].point = "end";
  scene.point_loads[1].force = {0, 30, 0};
  const Path path = follow(scene, {});
  EXPECT_TRUE(path.result.finished) << path.result.failure;
  EXPECT_GT(path.tip[1], 0.0);
  EXPECT_LT(plain_newton(scene, 50)[1], 0.0);
}

TEST(LoadPath, NothingToDo) {
  Scene scene = elastica();
  scene.point_loads.clear();
  const Path path = follow(scene, {});
  EXPECT_TRUE(path.result.finished) << path.result.failure;
  EXPECT_TRUE(agrees(path.tip, {0, 0, 0}, 0.0));
}

}  // namespace
}  // namespace mixbeam::test::load_path_test
