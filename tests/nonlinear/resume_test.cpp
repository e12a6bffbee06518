// A path that goes on from any of its steps arrives with the very bits of the one that never stopped.
#include "discretization/state/difference.hpp"
#include "nonlinear/path/step_size.hpp"
#include "tests/nonlinear/beam_fixture.hpp"
#include "tests/support/buckling_scenes.hpp"

namespace mixbeam::test {
namespace {

struct Step {
  StepReport report;
  StateSnapshot state;
};

std::vector<Step> steps_of(Simulation& simulation, const PathControl& control = {}) {
  std::vector<Step> steps;
  simulation.run(
      [&](const StepReport& report, const State& state) {
        steps.push_back({report, snapshot_of(simulation.model(), state)});
      },
      control);
  return steps;
}

/// Two stages of bending and twisting with kinks in mesh order: two orders, so that there is more than one block.
Scene two_stages() {
  Scene scene = cantilever(section(1e6, 1e6, 1.0, 1.0), 1.0, 2, 8);
  scene.points.push_back({"end", {1.2, 0.9, 0.3}});
  scene.members.push_back(line("second", "tip", "end", 3, 5));
  scene.point_loads = {dead_load("end", {0, 6, 2})};
  PointLoad later = dead_load("tip", {0, -3, 5});
  later.stage = 2;
  scene.point_loads.push_back(later);
  scene.stages = 2;
  return scene;
}

/// Steps that fail and shrink, and grow again.
SolverParameters eventful(LoadPathMethod method) {
  SolverParameters parameters;
  parameters.load_path.method = method;
  parameters.newton.maximum_iterations = 5;
  parameters.load_path.initial_step = 0.8;
  parameters.load_path.maximum_step = 0.8;
  return parameters;
}

void expect_same(const CriticalPoint& a, const CriticalPoint& b) {
  EXPECT_EQ(a.kind, b.kind);
  EXPECT_EQ(a.load_factor, b.load_factor);
  EXPECT_EQ(a.negative_before, b.negative_before);
  EXPECT_EQ(a.negative_after, b.negative_after);
  EXPECT_TRUE(same_bits(a.state, b.state));
  EXPECT_TRUE(same_bits(a.mode, b.mode));
}

void expect_same(const StepReport& a, const StepReport& b) {
  EXPECT_EQ(a.step, b.step);
  EXPECT_EQ(a.load_factor, b.load_factor);
  EXPECT_EQ(a.newton_iterations, b.newton_iterations);
  EXPECT_EQ(a.residual, b.residual);
  EXPECT_EQ(a.point.step_size, b.point.step_size);
  EXPECT_EQ(a.point.iterations, b.point.iterations);
  EXPECT_EQ(a.point.attempts_left, b.point.attempts_left);
  EXPECT_EQ(a.point.failed_steps, b.point.failed_steps);
  EXPECT_EQ(a.point.newton_iterations, b.point.newton_iterations);
  EXPECT_EQ(a.point.stage, b.point.stage);
  EXPECT_EQ(a.point.critical_points, b.point.critical_points);
  EXPECT_EQ(a.point.jumps, b.point.jumps);
  ASSERT_EQ(a.jump.has_value(), b.jump.has_value());
  if (a.jump) {
    EXPECT_EQ(a.jump->released, b.jump->released);
  }
  EXPECT_EQ(a.point.path_length, b.point.path_length);
  EXPECT_EQ(a.point.direction, b.point.direction);
  EXPECT_EQ(a.point.negative, b.point.negative);
  EXPECT_EQ(a.point.branched, b.point.branched);
  ASSERT_EQ(a.critical_points.size(), b.critical_points.size());
  for (size_t i = 0; i < a.critical_points.size(); ++i) expect_same(a.critical_points[i], b.critical_points[i]);
  ASSERT_EQ(a.history.size(), b.history.size());
  for (size_t i = 0; i < a.history.size(); ++i) {
    EXPECT_EQ(a.history[i].attempt, b.history[i].attempt);
    EXPECT_EQ(a.history[i].iteration, b.history[i].iteration);
    EXPECT_EQ(a.history[i].residual, b.history[i].residual);
  }
}

void expect_resumable_everywhere(const Scene& scene, const SolverParameters& parameters) {
  Simulation whole(scene, parameters, this_rank());
  const std::vector<Step> steps = steps_of(whole);
  ASSERT_TRUE(whole.result().finished) << whole.result().failure;
  ASSERT_GE(steps.size(), 4u);
  for (size_t from = 0; from < steps.size(); ++from) {
    SCOPED_TRACE("resumed behind step " + std::to_string(from));
    Simulation rest(scene, parameters, this_rank());
    rest.restore(steps[from].state, steps[from].report.load_factor);
    EXPECT_TRUE(same_bits(snapshot_of(rest.model(), rest.state()), steps[from].state));
    const std::vector<Step> later = steps_of(rest, {steps[from].report.point, {}});
    EXPECT_TRUE(rest.result().finished) << rest.result().failure;
    EXPECT_EQ(rest.result().steps, whole.result().steps);
    EXPECT_EQ(rest.result().failed_steps, whole.result().failed_steps);
    EXPECT_EQ(rest.result().newton_iterations, whole.result().newton_iterations);
    ASSERT_EQ(later.size() + from + 1, steps.size());
    for (size_t i = 0; i < later.size(); ++i) {
      expect_same(later[i].report, steps[from + 1 + i].report);
      EXPECT_TRUE(same_bits(later[i].state, steps[from + 1 + i].state));
    }
  }
}

TEST(Resume, StepsWithFailures) {
  for (LoadPathMethod method : {LoadPathMethod::automatic, LoadPathMethod::adaptive}) {
    const SolverParameters parameters = eventful(method);
    Simulation whole(two_stages(), parameters, this_rank());
    whole.run();
    EXPECT_GT(whole.result().failed_steps, 0) << "the example is meant to have failed steps";
    expect_resumable_everywhere(two_stages(), parameters);
  }
}

/// A path that stops at load factors that are asked for.
TEST(Resume, PartsOfAStage) {
  for (LoadPathMethod method : {LoadPathMethod::automatic, LoadPathMethod::fixed}) {
    SolverParameters parameters;
    parameters.load_path.method = method;
    parameters.load_path.steps = 2;
    parameters.analysis.modes.load_factors = {0.3, 1.4};
    Simulation whole(two_stages(), parameters, this_rank());
    std::vector<double> at;
    for (const Step& step : steps_of(whole)) at.push_back(step.report.load_factor);
    for (const double asked : {0.3, 1.0, 1.4, 2.0}) EXPECT_EQ(std::count(at.begin(), at.end(), asked), 1) << asked;
    expect_resumable_everywhere(two_stages(), parameters);
  }
}

/// A sheet of struts that is bent out of its plane; large enough for two levels.
Scene sheet() {
  constexpr int kSide = 30;
  Scene scene;
  scene.sections = {section(400.0, 140.0, 0.8, 1.0)};
  const auto name = [](int i, int j) { return "p" + std::to_string(i) + "_" + std::to_string(j); };
  for (int i = 0; i < kSide; ++i)
    for (int j = 0; j < kSide; ++j) {
      scene.points.push_back({name(i, j), {1.0 * i, 1.0 * j, 0.0}});
      if (i == 0) scene.supports.push_back(clamp(name(i, j)));
      if (i == kSide - 1) scene.point_loads.push_back(dead_load(name(i, j), {0.0, 0.0, 1e-3}));
      if (i > 0) scene.members.push_back(line("x" + name(i, j), name(i - 1, j), name(i, j), 2, 1));
      if (j > 0) scene.members.push_back(line("y" + name(i, j), name(i, j - 1), name(i, j), 2, 1));
    }
  return scene;
}

/// Coarse spaces are kept within a step, and what is kept changes the last digits.
TEST(Resume, NetworksSolvedByIteration) {
  SolverParameters parameters;
  parameters.linear.method = kIterative;
  parameters.load_path.initial_step = parameters.load_path.maximum_step = 0.25;
  expect_resumable_everywhere(sheet(), parameters);
}

/// Lee's frame, coarse: three critical points, two of them limit points with a snap-back between them.
Scene snapping_frame() {
  Scene scene;
  scene.sections = {section(4320.0, kRigid, 1440.0, 1440.0)};
  scene.points = {{"foot", {0, 0, 0}}, {"corner", {0, 120, 0}}, {"loaded", {24, 120, 0}}, {"end", {120, 120, 0}}};
  const std::vector<std::string> way = {"foot", "corner", "loaded", "end"};
  for (size_t i = 0; i + 1 < way.size(); ++i)
    scene.members.push_back(line(way[i], way[i], way[i + 1], 3, i == 1 ? 2 : 5));
  scene.supports = {hinged("foot"), hinged("end")};
  scene.point_loads = {dead_load("loaded", {0, -3, 0})};
  return scene;
}

/// Rows are written where a load factor stands for the loads: not within the jump, in which the frame snaps back.
TEST(Resume, LoadsThatTurnAndJump) {
  Scene scene = snapping_frame();
  scene.point_loads[0].amplitude = "(t < 0.6) ? 3*t*(1-t) : -0.2*t";
  expect_resumable_everywhere(scene, {});
}

TEST(Resume, PathThroughLimitPoints) {
  Simulation whole(snapping_frame(), {}, this_rank());
  int limit_points = 0, steps_along_path = 0;
  whole.run([&](const StepReport& report, const State&) {
    for (const CriticalPoint& point : report.critical_points) limit_points += point.kind == CriticalKind::limit_point;
    steps_along_path += report.point.path_length > 0.0;
  });
  EXPECT_EQ(limit_points, 2);
  EXPECT_GT(steps_along_path, 5);
  expect_resumable_everywhere(snapping_frame(), {});
  SolverParameters in_parts;  // the path goes back below where its first part ended
  in_parts.analysis.modes.load_factors = {0.5};
  expect_resumable_everywhere(snapping_frame(), in_parts);
}

TEST(Resume, BranchBehindABifurcation) {
  Scene column = cantilever(section(kRigid, kRigid, 1.0, 2.0), 1.0, 3, 6);
  // in this plane it buckles, else it could choose
  column.supports.push_back(support("tip", {false, false, true}, {true, true, false}));
  column.point_loads = {dead_load("tip", {-6, 0, 0})};
  SolverParameters parameters;
  parameters.analysis.branch = Branch::positive;
  expect_resumable_everywhere(column, parameters);
}

TEST(Resume, PathWithJumps) {
  SolverParameters parameters;
  parameters.analysis.snap = Snap::jump;
  Simulation whole(snapping_frame(), parameters, this_rank());
  int jumps = 0;
  whole.run([&](const StepReport& report, const State&) { jumps = report.point.jumps; });
  EXPECT_EQ(jumps, 1);
  expect_resumable_everywhere(snapping_frame(), parameters);
}

/// A point of a path that has not branched yet is not one behind a branch: what is kept for resuming matters.
TEST(Resume, NoticesAnotherDirection) {
  Simulation whole(snapping_frame(), {}, this_rank());
  const std::vector<Step> steps = steps_of(whole);
  ASSERT_GT(steps.size(), 6u);
  const Step& from = steps[5];
  ASSERT_GT(from.report.point.path_length, 0.0);
  Simulation rest(snapping_frame(), {}, this_rank());
  rest.restore(from.state, from.report.load_factor);
  PathPoint other = from.report.point;
  other.direction = -other.direction;
  const std::vector<Step> later = steps_of(rest, {other, {}});
  ASSERT_FALSE(later.empty());
  EXPECT_NE(later[0].report.load_factor, steps[6].report.load_factor);
}

TEST(Resume, FixedStepsAndAUsersLists) {
  SolverParameters parameters;
  parameters.load_path.method = LoadPathMethod::fixed;
  parameters.load_path.steps = 3;
  expect_resumable_everywhere(two_stages(), parameters);
  parameters.nox = Teuchos::rcp(new Teuchos::ParameterList);
  parameters.nox->sublist("Line Search").set("Method", "Backtrack");
  parameters.loca = Teuchos::rcp(new Teuchos::ParameterList);
  parameters.loca->sublist("Step Size").set("Successful Step Increase Factor", 2.0);
  // relative to the residual at the start of a solve: asked again where the path goes on, it would want more iterations
  parameters.status_tests = Teuchos::rcp(new Teuchos::ParameterList);
  parameters.status_tests->set("Test Type", "NormF").set("Scale Type", "Unscaled").set("Tolerance", 1e-9);
  EXPECT_EQ(obstacle_to_resuming(parameters), "");
  expect_resumable_everywhere(two_stages(), parameters);
}

/// A strip that bends upright and buckles sideways: a critical point behind several steps of one stage.
Scene strip() {
  Section upright = section(1e4, 1e4, 1.0, 1.0);
  upright.bending_stiffness = {1.0, 20.0};
  Scene scene = cantilever(upright, 1.0, 3, 4);
  scene.point_loads = {dead_load("tip", {0, -7, 0})};
  return scene;
}

TEST(Resume, CriticalPointsOfFixedAndAdaptiveSteps) {
  SolverParameters parameters;
  parameters.load_path.steps = 7;
  parameters.load_path.initial_step = 0.1;
  for (LoadPathMethod method : {LoadPathMethod::fixed, LoadPathMethod::adaptive}) {
    parameters.load_path.method = method;
    Simulation whole(strip(), parameters, this_rank());
    const std::vector<Step> steps = steps_of(whole);
    const auto at =
        std::find_if(steps.begin(), steps.end(), [](const Step& step) { return !step.report.critical_points.empty(); });
    ASSERT_NE(at, steps.end());
    EXPECT_GT(at - steps.begin(), 2) << "the example is meant to have a stage that began long before";
    expect_resumable_everywhere(strip(), parameters);
  }
}

/// Of whole turns, which states do not have, it takes those of the sum; of the sum's rounding nothing.
TEST(IncrementBetween, LeadsFromOneStateToTheOther) {
  Simulation simulation(two_stages(), {}, this_rank());
  const Model& model = simulation.model();
  const State first = model.reference_state();
  MixedVector way = model.create_vector();
  for (size_t i = 0; i < way.vertex().extent(0); ++i) way.vertex()(i) = 4.0 * std::sin(2.0 + static_cast<double>(i));
  const KernelView<double*> interior = way.writable_interior(false);
  for (size_t i = 0; i < interior.extent(0); ++i) interior(i) = std::cos(static_cast<double>(i));
  ASSERT_GT(way.largest_vertex_spin(), kPi);
  const State second = model.apply(first, way, 1.0);
  MixedVector found = increment_between(model, first, second, way);
  MixedVector rounded = way.clone(true);
  rounded.scale(1.0 + 1e-9);
  EXPECT_TRUE(increment_between(model, first, second, rounded).same_values(found));
  EXPECT_FALSE(rounded.same_values(way));
  const MixedVector shortest = increment_between(model, first, second, model.create_vector());
  EXPECT_LE(shortest.largest_vertex_spin(), kPi * (1.0 + 1e-15));
  constexpr double kRounding = 1e-13;  // of rotations composed and taken apart
  MixedVector missed = shortest.clone(true);
  missed.update(-1.0, way, 1.0);
  EXPECT_GT(missed.maximum_norm(), 1.0);
  found.update(-1.0, way, 1.0);
  EXPECT_LT(found.maximum_norm(), kRounding);
}

TEST(Resume, RefusesWhatRemembersMore) {
  const auto with_loca = [](const char* list, const char* name, const char* value) {
    SolverParameters parameters;
    parameters.loca = Teuchos::rcp(new Teuchos::ParameterList);
    parameters.loca->sublist(list).set(name, value);
    return obstacle_to_resuming(parameters);
  };
  EXPECT_NE(with_loca("Stepper", "Continuation Method", "Arc Length").find("arc length"), std::string::npos);
  EXPECT_NE(with_loca("Predictor", "Method", "Secant").find("extrapolates"), std::string::npos);
  EXPECT_EQ(with_loca("Predictor", "Method", "Constant"), "");
  EXPECT_EQ(obstacle_to_resuming(SolverParameters()), "");
}

TEST(Resume, StopsAfterTheStepItIsAskedAt) {
  Simulation simulation(two_stages(), eventful(LoadPathMethod::automatic), this_rank());
  int steps = 0;
  PathControl control;
  control.stop = [&] { return steps == 2; };
  simulation.run([&](const StepReport& report, const State&) { steps = report.step; }, control);
  EXPECT_TRUE(simulation.result().interrupted);
  EXPECT_FALSE(simulation.result().finished);
  EXPECT_EQ(simulation.result().steps, 2);
}

TEST(Resume, RefusesTheStateOfAnotherMesh) {
  Simulation one(two_stages(), eventful(LoadPathMethod::automatic), this_rank());
  Scene other = two_stages();
  other.members[0].elements = 9;
  Simulation another(other, eventful(LoadPathMethod::automatic), this_rank());
  const StateSnapshot snapshot = snapshot_of(another.model(), another.state());
  EXPECT_THROW(one.restore(snapshot, 0.0), std::invalid_argument);
}

TEST(StepSize, RulesAsPublishedByLoca) {
  StepSizeRule rule;
  rule.initial = 0.25;
  EXPECT_EQ(rule.after_success(0.25, 0), 0.375);  // LOCA manual: ds (1 + a ((N_max - N) / N_max)^2), a = 0.5
  EXPECT_EQ(rule.after_success(0.25, 25), 0.25 * 1.125);
  EXPECT_EQ(rule.after_failure(0.25), 0.125);
  rule.method = LoadPathMethod::fixed;
  EXPECT_EQ(rule.after_success(0.25, 3), 0.25);
  EXPECT_EQ(rule.after_success(0.125, 3), 0.125 * 1.26);
  EXPECT_EQ(rule.after_success(0.24, 3), 0.25);
}

}  // namespace
}  // namespace mixbeam::test
