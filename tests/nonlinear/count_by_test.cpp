// Negative eigenvalues by the factors that Newton's method has, against LAPACK and against the count that makes its
// own.
#include "nonlinear/path/step_judge.hpp"
#include "tests/nonlinear/stability_fixture.hpp"
#include "tests/support/buckling_scenes.hpp"

namespace mixbeam::test {
namespace count_by_test {

/// A cubic lattice whose columns carry `load` each.
Scene compressed_lattice(double load, int elements, int side = 5) {
  Scene scene = lattice(side, 1, elements);
  for (PointLoad& push : scene.point_loads) push.force = {0, 0, -load};
  return scene;
}

struct Counted {
  explicit Counted(Scene scene, const SolverParameters& parameters = {})
      : fixture(std::move(scene), this_rank(), parameters) {}

  /// By the factors of the usual tangent.
  std::optional<StabilityResult> by_factors(const State& state, double load_factor) {
    BeamProblem& problem = fixture.problem();
    MixedVector residual = problem.model.create_vector();
    const EvaluationPoint point = mixed_residual(problem.model, state, load_factor, residual);
    Linearization here(problem, point, cap_for(problem.model, point.scales), {false, true});
    return fixture.stability().ask({here.tangent().point().state, 0.0, &here}, How::factors);
  }
  /// At the equilibrium for a load factor.
  std::optional<StabilityResult> by_factors(double load_factor) {
    return by_factors(fixture.equilibrium(load_factor), load_factor);
  }
  /// What the undeformed structure answers a load factor of one with.
  MixedVector linear_answer() {
    BeamProblem& problem = fixture.problem();
    MixedVector residual = problem.model.create_vector(), answer = residual.clone(false);
    const EvaluationPoint point = mixed_residual(problem.model, problem.model.reference_state(), 1.0, residual);
    Linearization(problem, point, cap_for(problem.model, point.scales), {}).newton_increment(answer);
    return answer;
  }

  StabilityFixture fixture;
};

TEST(CountBy, AgreesWithLapack) {
  Counted counted(compressed_lattice(1.0, 1));
  int largest = 0;
  for (double load : {0.0, 1.0, 4.0, 8.0, 12.0}) {
    const std::optional<StabilityResult> result = counted.by_factors(load);
    ASSERT_TRUE(result) << load;
    const Tangent tangent = counted.fixture.tangent(load);
    IndependentUnknowns unknowns(counted.fixture.problem().model);
    const long expected = negative_by_lapack(unknowns.reduce(tangent)) + tangent.interior_count().negative;
    EXPECT_EQ(result->negative, expected) << load;
    EXPECT_EQ(result->sign, expected % 2 == 0 ? 1 : -1) << load;
    largest = std::max(largest, result->negative);
  }
  EXPECT_GT(largest, 10);
}

/// With chains between junctions, and buckled ones among them.
TEST(CountBy, AgreesWithTheCountOfItsOwn) {
  Counted counted(compressed_lattice(1.0, 3));
  int largest = 0;
  for (double load : {0.0, 0.5, 5.0, 20.0, 60.0}) {
    const std::optional<StabilityResult> result = counted.by_factors(load);
    ASSERT_TRUE(result) << load;
    const StabilityResult own = counted.fixture.count(load);
    EXPECT_EQ(result->negative, own.negative) << load;
    EXPECT_EQ(result->inside, own.inside) << load;
    EXPECT_EQ(result->end_angle, own.end_angle) << load;
    EXPECT_EQ(result->verdict(), own.verdict()) << load;
    largest = std::max(largest, result->negative);
  }
  EXPECT_GT(largest, 100);
}

/// Next to a critical load no sign of a pivot is to be relied on.
TEST(CountBy, SaysNothingNextToACriticalLoad) {
  Counted counted(compressed_lattice(1.0, 1));
  const Model& model = counted.fixture.problem().model;
  const MixedVector answer = counted.linear_answer();
  const auto state = [&](double load) { return model.apply(model.reference_state(), answer, load); };
  const auto negative = [&](double load) {
    return counted.fixture.stability().ask({state(load), load}, How::inertia)->negative;
  };
  double below = 1.0, above = 12.0;
  ASSERT_EQ(negative(below), 0);
  ASSERT_GT(negative(above), 0);
  constexpr double kNear = 1e-8;
  while (above - below > kNear * above) {
    const double middle = 0.5 * (below + above);
    (negative(middle) == 0 ? below : above) = middle;
  }
  EXPECT_FALSE(counted.by_factors(state(below), below));
  for (double load : {0.9 * below, 1.001 * above}) {
    const std::optional<StabilityResult> beside = counted.by_factors(state(load), load);
    ASSERT_TRUE(beside) << load;
    EXPECT_EQ(beside->negative, negative(load));
  }
}

/// A stiffness of forces that the tangent cuts off: members are as good as inextensible.
constexpr double kCutOff = 1e10;

/// Where it is iterated, what conjugate gradients meet.
TEST(CountBy, SignByIteration) {
  for (double axial : {400.0, kCutOff}) {
    Scene scene = compressed_lattice(1.0, 1);
    scene.sections[0].axial_stiffness = axial;
    StabilityFixture direct(scene);
    SolverParameters parameters;
    parameters.linear.method = kIterative;
    BeamProblem problem(scene, this_rank(), parameters);
    ASSERT_TRUE(problem.iterates());
    for (double load : {1.0, 12.0}) {
      const State state = direct.equilibrium(load);
      const std::optional<StabilityResult> sign = Stability(problem).ask({state, load}, How::iteration);
      ASSERT_TRUE(sign) << load;
      EXPECT_EQ(sign->verdict(), load < 2.0 ? Verdict::stable : Verdict::unstable);
      EXPECT_EQ(sign->verdict(), direct.count(load).verdict()) << load;
    }
  }
}

/// The compliance of a cap makes no tangent stiffer: zero below a cap is a count, more is none.
TEST(CountBy, CappedTangentsTellThatNothingIsNegative) {
  Scene rigid = compressed_lattice(1.0, 1);
  rigid.sections[0].axial_stiffness = kRigid;
  Counted counted(rigid);
  for (double load : {0.0, 0.5, 1.0}) {
    const std::optional<StabilityResult> result = counted.by_factors(load);
    ASSERT_TRUE(result) << load;
    const StabilityResult own = counted.fixture.count(load);
    EXPECT_EQ(result->verdict(), Verdict::stable) << load;
    EXPECT_EQ(own.verdict(), Verdict::stable) << load;
    EXPECT_EQ(result->cap_ratio, own.cap_ratio) << load;
  }
  ASSERT_GT(counted.fixture.count(12.0).negative, 0);
  EXPECT_FALSE(counted.by_factors(12.0));
}

/// Newton's cap cuts off both stiffnesses, that of counts the second one alone.
TEST(CountBy, StationsThatAreNotCountedHaveTheCapOfCounts) {
  for (double axial : {1e6, kCutOff}) {
    Scene scene = column(2, 6);
    scene.sections[0].axial_stiffness = axial;
    StabilityFixture fixture(scene);
    const double load = 0.9 * euler_columns()[0].critical;
    const State state = fixture.equilibrium(load);
    const auto cap_ratio = [&](Stability* counts) {
      return StepJudge(Teuchos::rcpFromRef(fixture.problem()), SolverParameters(), counts, load)
          .station(state, load, nullptr)
          .cap_ratio;
    };
    EXPECT_GT(fixture.tangent(load).cap().least_ratio, 0.0);
    for (Stability* counts : {static_cast<Stability*>(nullptr), &fixture.stability()})
      EXPECT_EQ(cap_ratio(counts) > 0.0, axial == kCutOff);
  }
}

/// KLU2 does not tell signs; the few rows that a chain leaves are factorised once more for them. With a cap zero alone
/// is a count.
TEST(CountBy, ChainsAgreeWithTheCountOfTheirOwn) {
  SolverParameters in_space;
  in_space.planar = false;
  Counted counted(column(2, 6), in_space);
  for (double share : {0.0, 0.5, 0.99, 1.01, 3.0}) {  // of Euler's load
    const double load = share * euler_columns()[0].critical;
    const StabilityResult own = counted.fixture.count(load);
    const std::optional<StabilityResult> result = counted.by_factors(load);
    EXPECT_EQ(own.negative > 0, share > 1.0) << share;
    EXPECT_EQ(result.has_value(), share < 1.0) << share;
    EXPECT_EQ(result.value_or(own).negative, own.negative) << share;
  }
}

/// Lattices of some size are iterated with, and give the count of factors where that meets an eigenvalue below zero.
TEST(CountBy, IterationLeavesUnstableLatticesToFactors) {
  const Scene scene = compressed_lattice(1.0, 1, 14);
  SolverParameters chains;
  chains.linear.method = kChains;
  Counted iterated(scene), factorised(scene, chains);
  ASSERT_TRUE(iterated.fixture.problem().tries_iteration());
  EXPECT_FALSE(iterated.fixture.problem().iterates());
  ASSERT_FALSE(factorised.fixture.problem().tries_iteration());
  const MixedVector answer = factorised.linear_answer();
  const auto counted = [&](Counted& by, double load) {
    const Model& model = by.fixture.problem().model;
    return by.fixture.stability().ask({model.apply(model.reference_state(), answer, load), load}, How::inertia);
  };
  for (double load : {0.1, 20.0}) {
    EXPECT_EQ(counted(iterated, load)->negative, counted(factorised, load)->negative) << load;
    EXPECT_EQ(counted(factorised, load)->negative > 0, load > 1.0);
  }
}

/// Without stresses nothing is below zero; whether something is zero the unloaded structure tells: a rod that may turn
/// about its axis is a mechanism.
TEST(CountBy, UnloadedStructuresAreCounted) {
  const Support loose = support("clamp", kHeld, {false, true, true});
  EXPECT_EQ(StabilityFixture(column(2, 6)).count(0.0).verdict(), Verdict::stable);
  EXPECT_EQ(StabilityFixture(column(2, 6, {loose})).count(0.0).verdict(), Verdict::neutral);
}

/// Where factors do not tell, chains of the same tangent do, as in the count that takes its own; but where a cap cuts
/// off some stiffness.
TEST(CountBy, ChainsOfTheTangentWhereItsFactorsDoNotTell) {
  const Scene plain = compressed_lattice(1.0, 1), small = lattice(3, 1, 2);  // the latter by KLU2
  ASSERT_TRUE(Counted(plain).by_factors(0.5));
  Scene follower = plain;
  for (PointLoad& load : follower.point_loads) {
    load.frame = LoadFrame::follower;
    for (const Member& member : follower.members)
      if (member.end_point == load.point) load.member = member.name;
  }
  for (const Scene& scene : {follower, small}) {
    Counted counted(scene);
    const State state = counted.fixture.equilibrium(0.5);
    const std::optional<StabilityResult> found = counted.by_factors(state, 0.5);
    const StabilityResult own = *counted.fixture.stability().ask({state, 0.5}, How::inertia);
    ASSERT_TRUE(found);
    EXPECT_EQ(found->negative, own.negative);
    EXPECT_EQ(found->sign, own.sign);
    EXPECT_EQ(found->symmetric, own.symmetric);
  }
  Scene rigid = small;
  for (Section& section : rigid.sections) section.axial_stiffness = HUGE_VAL;
  EXPECT_FALSE(Counted(rigid).by_factors(0.5));
}

}  // namespace count_by_test
}  // namespace mixbeam::test
