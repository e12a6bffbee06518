// Where and why no equilibrium was found: the fields of the report, for one scene of each cause.
#include "nonlinear/diagnosis/failure_report.hpp"

#include "tests/nonlinear/beam_fixture.hpp"
#include "tests/support/constrained_scenes.hpp"
#include "tests/support/text.hpp"

namespace mixbeam::test::failure_report_test {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// A large bending problem with one equilibrium.
Scene elastica(double force) {
  Scene scene = cantilever(section(1e6, 1e6, 1.0, 1.0), 1.0, 2, 8);
  scene.point_loads = {dead_load("tip", {0, force, 0})};
  return scene;
}

struct Outcome {
  LoadPathResult result;
  std::vector<StepFailure> failures;
};

Outcome follow(const Scene& scene, const SolverParameters& parameters = {}) {
  Outcome outcome;
  Simulation simulation(scene, parameters, this_rank());
  PathControl control;
  control.step_failed = [&outcome](const StepFailure& failure) { outcome.failures.push_back(failure); };
  outcome.result = simulation.run({}, control);
  return outcome;
}

SolverParameters in_steps(double initial, double minimum, int iterations = 50) {
  SolverParameters parameters;
  parameters.load_path.method = LoadPathMethod::adaptive;
  parameters.load_path.initial_step = initial;
  parameters.load_path.minimum_step = minimum;
  parameters.load_path.maximum_step = initial;
  parameters.newton.maximum_iterations = iterations;
  return parameters;
}

/// Throws where there is none.
const FailureReport& report_of(const Outcome& outcome, FailureCause cause) {
  EXPECT_EQ(outcome.result.report.value().cause, cause) << outcome.result.failure;
  return *outcome.result.report;
}

SolverParameters in_three_steps(double step) {
  SolverParameters parameters = in_steps(step, SolverParameters().load_path.minimum_step);
  parameters.load_path.maximum_steps = 3;
  return parameters;
}

bool advises(const FailureReport& report, AdviceKind kind) {
  return std::any_of(report.next.begin(), report.next.end(), [&](const Advice& a) { return a.kind == kind; });
}

TEST(FailureReport, OfALoadWithoutValue) {
  Scene scene = elastica(1.0);
  scene.point_loads[0].amplitude = "t*sqrt(0.7-t)";
  const Outcome outcome = follow(scene, in_steps(0.5, 0.1));
  const FailureReport& report = report_of(outcome, FailureCause::load_not_finite);
  EXPECT_GE(report.last_load_factor, 0.6);
  EXPECT_LE(report.last_load_factor, 0.7);
  EXPECT_TRUE(report.step_at_minimum);
  ASSERT_FALSE(report.attempts.empty());
  const FailedAttempt& last = report.attempts.back();
  ASSERT_TRUE(last.not_finite.has_value());
  EXPECT_EQ(last.not_finite->source, NotFinite::Source::load);
  EXPECT_EQ(last.not_finite->iteration, 0);  // found before anything is solved
  EXPECT_EQ(last.iterations, 0);
  EXPECT_EQ(report.next.front().kind, AdviceKind::correct_load);
  expect_in(outcome.result.failure, {"load at point \"tip\"", "no finite value", "What to try"});
  ASSERT_FALSE(outcome.failures.empty());
  EXPECT_EQ(static_cast<int>(outcome.failures.size()), outcome.result.failed_steps);
  EXPECT_GT(outcome.failures.back().load_factor, 0.7);
  EXPECT_EQ(outcome.failures.back().step, outcome.result.steps + 1);
}

TEST(FailureReport, IsNotMadeWhereAllGoesWell) {
  Scene scene = elastica(1.0);
  scene.point_loads[0].amplitude = "t*sqrt(1.7-t)";
  const Outcome outcome = follow(scene, in_steps(0.5, 0.1));
  EXPECT_TRUE(outcome.result.finished);
  EXPECT_FALSE(outcome.result.report.has_value());
  EXPECT_TRUE(outcome.result.failure.empty());
  EXPECT_TRUE(outcome.failures.empty());
}

/// A gap in a formula so narrow that the check of the input misses it: one attempt falls into it, the next do not.
TEST(FailureReport, AGapInAFormulaCostsOneAttempt) {
  Scene scene = elastica(1.0);
  scene.point_loads[0].amplitude = "t+0*sqrt((t-0.53)^2-1e-12)";
  const Outcome outcome = follow(scene, in_steps(0.53, 0.01));
  EXPECT_TRUE(outcome.result.finished) << outcome.result.failure;
  ASSERT_EQ(outcome.failures.size(), 1u);
  EXPECT_EQ(outcome.failures[0].step, 1);
  EXPECT_EQ(outcome.failures[0].load_factor, 0.53);
  EXPECT_EQ(outcome.failures[0].iterations, 0);
  expect_in(outcome.failures[0].cause, {"load at point \"tip\""});
}

TEST(FailureReport, OfLoadsBeyondDoublePrecision) {
  for (double force : {1e200, 1e300}) {
    const Outcome outcome = follow(elastica(force), in_steps(1.0, 0.1));
    const FailureReport& report = report_of(outcome, FailureCause::overflow);
    for (const FailedAttempt& attempt : report.attempts) {
      ASSERT_TRUE(attempt.not_finite.has_value()) << force << cause_text(attempt);
      EXPECT_LE(attempt.not_finite->iteration, 1) << force;
      EXPECT_EQ(attempt.not_finite->iteration, attempt.iterations) << force;
    }
    EXPECT_EQ(report.next.front().kind, AdviceKind::check_units);
    expect_in(outcome.result.failure, {"times EI/L^2"});
  }
}

/// Whatever number inside an element ceases to be one, the residual shows it, and the log names the element.
TEST(AttemptLog, FindsEveryInteriorUnknownThatIsNotANumber) {
  constexpr int kElement = 2;
  const auto list = Teuchos::rcp(new Teuchos::ParameterList("mixbeam"));
  const Teuchos::RCP<LOCA::GlobalData> global = LOCA::createGlobalData(list, Teuchos::null);
  for (int order : {1, 3}) {
    const Scene scene = cantilever(section(1e6, 1e6, 1.0, 1.0), 1.0, order, 4);
    const auto problem = Teuchos::rcp(new BeamProblem(scene, this_rank(), SolverParameters()));
    const ElementBlock& block = problem->model.structure().blocks.front();
    const int unknowns = block.interior.unknowns();
    for (int i = 0; i < unknowns; ++i)
      for (double value : {kNaN, kRigid, -kRigid}) {
        const std::string what = "order " + std::to_string(order) + ", unknown " + std::to_string(i);
        State state = problem->model.reference_state();
        state.in_plane = false;  // numbers that leave the plane are written to it
        state.views.interior(block.interior_offset + static_cast<size_t>(kElement) * unknowns + i) = value;
        BeamGroup group(global, problem, state, 0.0, {});
        group.computeF();
        EXPECT_FALSE(std::isfinite(group.getNormF())) << what;
        AttemptLog log;
        log.start_attempt();
        log.iterated(group, nullptr, 0);
        log.failed(group, 0);
        ASSERT_EQ(log.attempts().size(), 1u);
        const FailedAttempt& attempt = log.attempts().front();
        ASSERT_EQ(attempt.end, AttemptEnd::not_finite) << what << ": " << value;
        ASSERT_TRUE(attempt.not_finite->place.has_value()) << what;
        EXPECT_EQ(attempt.not_finite->place->member, "beam");
        EXPECT_EQ(attempt.not_finite->place->element, kElement) << what;
      }
  }
  LOCA::destroyGlobalData(global);
}

Scene mechanism() {
  Scene scene = elastica(0.0);
  scene.supports[0].displacement_fixed = {false, true, true};
  scene.point_loads = {dead_load("tip", {1, 0, 0})};
  return scene;
}

TEST(FailureReport, OfAMechanism) {
  const Outcome outcome = follow(mechanism(), in_steps(1.0, 0.3));
  const FailureReport& report = report_of(outcome, FailureCause::mechanism);
  EXPECT_EQ(report.last_load_factor, 0.0);
  EXPECT_EQ(report.next.front().kind, AdviceKind::add_support);
  ASSERT_FALSE(report.tangent.modes.empty());
  ASSERT_FALSE(report.tangent.modes.front().vertices.empty());
  for (const MovingVertex& vertex : report.tangent.modes.front().vertices) {
    EXPECT_FALSE(vertex.turns);
    EXPECT_NEAR(std::abs(vertex.direction[0]), 1.0, 1e-6);
    EXPECT_NEAR(vertex.share, 1.0, 1e-6);  // all of it slides
  }
  EXPECT_EQ(report.attempts.back().end, AttemptEnd::linear_solver);
  EXPECT_FALSE(report.attempts.back().linear_solver.empty());
}

/// Lee's frame: limit load 1.855672754 (shooting on the rod equations). The state beyond is far: too far for few
/// iterations.
TEST(FailureReport, OfALimitPoint) {
  constexpr double kLimit = 1.855672754;
  const Scene scene = structure(
      {{"foot", {0, 0, 0}}, {"corner", {0, 120, 0}}, {"loaded", {24, 120, 0}}, {"end", {120, 120, 0}}},
      {line("column", "foot", "corner", 4, 6), line("short", "corner", "loaded", 4, 2),
       line("long", "loaded", "end", 4, 5)},
      {hinged("foot"), hinged("end")}, {dead_load("loaded", {0, -2.0, 0})}, section(4320.0, kRigid, 1440.0, 1440.0));
  const Outcome outcome = follow(scene, in_steps(0.1, 1e-4, 6));
  ASSERT_TRUE(outcome.result.report.has_value());
  const FailureReport& report = *outcome.result.report;
  EXPECT_NEAR(report.last_load_factor * 2.0, kLimit, 2e-3);
  EXPECT_LT(report.last_load_factor * 2.0, kLimit);
  EXPECT_EQ(report.cause, FailureCause::critical_point) << outcome.result.failure;
  ASSERT_TRUE(report.tangent.known) << report.tangent.unknown_because;
  EXPECT_TRUE(report.tangent.nearly_singular);
  EXPECT_LE(report.tangent.negative, 1);  // so close to the fold Newton's method may end on either side of it
  EXPECT_EQ(report.next.front().kind, AdviceKind::prescribe_displacement);
  expect_in(report.next.front().text, {"\"Method\" = \"automatic\""});
  ASSERT_FALSE(report.tangent.modes.empty());
  for (const MovingVertex& vertex : report.tangent.modes.front().vertices)  // the frame snaps in its plane
    EXPECT_NEAR(std::abs(vertex.direction[2]), vertex.turns ? 1.0 : 0.0, 1e-6);
  expect_in(outcome.result.failure, {"critical point", "nearly singular", "prescribe the displacement"});
}

TEST(FailureReport, OfElementsThatTurnTooFar) {
  Scene scene = cantilever(section(1e6, 1e6, 1.0, 1.0), 1.0, 1, 1);
  scene.point_loads = {dead_load("tip", {}, {0, 0, 4.0 * kPi})};
  const Outcome outcome = follow(scene, in_steps(0.06, 1e-3));
  const FailureReport& report = report_of(outcome, FailureCause::end_angle);
  EXPECT_LT(report.last_load_factor, 0.5);  // one element turns by half of the moment against its ends
  ASSERT_FALSE(report.wide_angles.empty());
  EXPECT_EQ(report.wide_angles.front().member, "beam");
  EXPECT_EQ(report.wide_angles.front().elements, 1);
  EXPECT_GE(report.wide_angles.front().suggested_elements, 4);  // a quarter turn each at the end
  EXPECT_EQ(report.next.front().kind, AdviceKind::more_elements);
  scene.members[0].elements = report.wide_angles.front().suggested_elements;
  EXPECT_TRUE(follow(scene).result.finished);  // the advice is good
}

/// Three steps are permitted: of a tenth they are too few, of a thousandth they get nowhere.
TEST(FailureReport, OfStepsThatAreUsedUp) {
  for (const auto& [step, advice] : {std::pair{0.1, AdviceKind::more_steps}, {1e-3, AdviceKind::check_units}}) {
    const Outcome outcome = follow(elastica(10.0), in_three_steps(step));
    const FailureReport& report = report_of(outcome, FailureCause::steps_used_up);
    EXPECT_TRUE(report.attempts.empty());
    EXPECT_EQ(report.next.front().kind, advice);
    EXPECT_TRUE(advises(report, AdviceKind::more_steps));
  }
}

/// Beyond critical points under dead forces a report names the load factor and "jump"; nowhere else.
TEST(FailureReport, SuggestsJumpsWhereTheyAreAWay) {
  const auto next = [](const Scene& scene, FailureCause cause, int negative, const SolverParameters& parameters = {}) {
    FailureReport report;
    report.cause = cause;
    report.last_load_factor = 0.0516;
    report.tangent.known = true;
    report.tangent.negative = negative;
    report.next = advice_for(report, BeamProblem(scene, this_rank(), parameters), parameters);
    return report;
  };
  for (const FailureCause cause :
       {FailureCause::critical_point, FailureCause::path_lost, FailureCause::steps_used_up}) {
    const FailureReport lost = next(elastica(1.0), cause, 2);
    EXPECT_TRUE(advises(lost, AdviceKind::jump));
    expect_in(text_of(lost), {"near load factor 0.0516", "\"Snap\" = \"jump\""});
    EXPECT_FALSE(advises(lost, AdviceKind::check_units));
    EXPECT_FALSE(advises(next(elastica(1.0), cause, 0), AdviceKind::jump));  // a cantilever that has not buckled
    Scene scene = elastica(1.0);
    scene.point_loads[0].frame = LoadFrame::follower;
    scene.point_loads[0].member = "beam";
    EXPECT_FALSE(advises(next(scene, cause, 2), AdviceKind::jump));
    scene = elastica(1.0);
    scene.accuracy = 1e-6;
    EXPECT_FALSE(advises(next(scene, cause, 2), AdviceKind::jump));
    SolverParameters parameters;
    parameters.analysis.control = MonitoredComponent{"tip", 1, 1.0};
    EXPECT_FALSE(advises(next(elastica(1.0), cause, 2, parameters), AdviceKind::jump));
  }
}

TEST(FailureReport, SuggestsASupportForMotionsWithoutStiffness) {
  const auto next = [](int null) {
    FailureReport report;
    report.cause = FailureCause::critical_point;
    report.tangent.known = true;
    report.tangent.null = null;
    report.next = advice_for(report, BeamProblem(elastica(1.0), this_rank(), {}), {});
    return report;
  };
  EXPECT_TRUE(advises(next(1), AdviceKind::add_support));
  EXPECT_FALSE(advises(next(0), AdviceKind::add_support));
}

/// A column that is twice as strong as its Euler load pi^2 EI / (4 L^2), and its twin that stays below.
TEST(FailureReport, NamesTheLoadAtWhichTheStructureBuckles) {
  const auto text_under = [](double force) {
    Scene scene = elastica(0.0);
    scene.point_loads[0].force = {-force, 0.0, 0.0};
    SolverParameters parameters = in_steps(0.3, 1e-3);
    parameters.load_path.maximum_steps = 3;
    const Outcome outcome = follow(scene, parameters);
    return outcome.result.finished ? std::string() : text_of(*outcome.result.report);
  };
  expect_in(text_under(kPi * kPi / 2.0), {"more steps are needed", "stable up to a bifurcation at load factor 0.500"});
  const std::string twin = text_under(0.8 * kPi * kPi / 4.0);
  expect_in(twin, {"more steps are needed"});
  EXPECT_EQ(twin.find("stable up to"), std::string::npos);
}

TEST(FailureReport, APathWithoutDirectionIsNotTheFaultOfALoad) {
  FailedAttempt attempt;
  attempt.load_factor = kNaN;
  attempt.end = AttemptEnd::not_finite;
  attempt.not_finite.emplace();
  attempt.not_finite->source = NotFinite::Source::load_factor;
  FailureReport report;
  report.attempts = {attempt};
  report.failures = 1;
  expect_in(text_of(report), {"at an unknown load factor: ", "the direction of the path could not be computed"});
  EXPECT_EQ(text_of(report).find("nan"), std::string::npos);
}

/// A member that cannot stretch between two clamps, or with one that lets its end slide.
Outcome load_across(bool slides) {
  Scene scene = cantilever(section(kRigid, kRigid, 1.0, 1.0), 1.0, 2, 8);
  scene.supports.push_back(support("tip", {!slides, true, true}, {true, true, true}));
  scene.distributed_loads = {{"beam", {0, 0, -1.0}}};
  return follow(scene);
}

TEST(FailureReport, OfALoadAcrossAMemberThatCannotStretch) {
  const Outcome outcome = load_across(false);
  EXPECT_EQ(report_of(outcome, FailureCause::taut).next.front().kind, AdviceKind::finite_stiffness);
  expect_in(outcome.result.failure, {"no finite axial force", "\"EA\"", "\"Fixed Displacement\""});
  EXPECT_TRUE(load_across(true).result.finished);
}

TEST(FailureReport, OfTooFewIterations) {
  const Outcome outcome = follow(elastica(10.0), in_steps(1.0, 0.9, 4));
  ASSERT_TRUE(outcome.result.report.has_value());
  const FailureReport& report = *outcome.result.report;
  EXPECT_EQ(report.last_load_factor, 0.0);
  ASSERT_FALSE(report.attempts.empty());
  EXPECT_EQ(report.attempts.back().end, AttemptEnd::iterations_used_up);
  EXPECT_EQ(report.attempts.back().iterations, 4);
  EXPECT_TRUE(report.cause == FailureCause::slow || report.cause == FailureCause::wandering);
  EXPECT_TRUE(advises(report, AdviceKind::more_iterations));
  ASSERT_TRUE(report.attempts.back().peak.has_value());
  const ResidualPeak& peak = *report.attempts.back().peak;
  EXPECT_NEAR(peak.scaled, report.attempts.back().last_residual, 1e-15);
  EXPECT_FALSE(advises(report, AdviceKind::add_support));
  EXPECT_EQ(report.tangent.negative, 0);
  EXPECT_FALSE(report.tangent.nearly_singular);
  ASSERT_TRUE(report.tangent.condition.has_value());
  EXPECT_GE(*report.tangent.condition, 1.0);
  EXPECT_LT(*report.tangent.condition, 1e16);
}

/// Without the small print that follows from a run: the peak is where the vector has it.
TEST(EquationPlace, OfTheLargestRow) {
  BeamFixture fixture(fork(3, 3), 0.5);
  const Model& model = fixture.problem().model;
  MixedVector rows = fixture.random_vector(1.0, 5).values().clone(true);
  const int vertex = vertex_of(model.mesh(), "tine 2");
  rows.vertex()(6 * vertex + 4) = -7.0;
  ResidualScales scales;
  scales.moment = 3.0;
  const auto peak = largest_row(model, rows, scales);
  ASSERT_TRUE(peak.has_value());
  EXPECT_EQ(peak->place.point, "tine 2");
  EXPECT_EQ(peak->place.member, "right");
  EXPECT_NEAR(peak->place.along, 1.0, 1e-12);
  EXPECT_EQ(peak->place.kind, RowKind::vertex_rotation);
  EXPECT_EQ(peak->place.component, 1);
  EXPECT_EQ(peak->scaled, 7.0);
  EXPECT_EQ(peak->value, -21.0);
  EXPECT_FALSE(first_not_finite(model, rows, SearchOrder::elements_first).has_value());
}

}  // namespace
}  // namespace mixbeam::test::failure_report_test
