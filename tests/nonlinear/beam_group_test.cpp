// The group that NOX and LOCA see: what it copies, what it restores, and what it solves.
#include "nonlinear/newton/beam_group.hpp"

#include "tests/nonlinear/beam_fixture.hpp"

#include <NOX_MultiVector.H>

namespace mixbeam::test {
namespace {

using NOX::Abstract::Group;

/// All kinds of loads, prescribed motion included; loads small enough for Newton's method without a limit.
Scene frame() {
  Scene scene = slope_discontinuity(3, 2);
  scene.members[1].order = 2;
  scene.sections[0].bending_stiffness = {20.0, 8.0};
  scene.point_loads = {dead_load("tip", {-1, 0, -1}, {0.5, 0.3, 0}),
                       follower_load("second corner", "leg 2", {1, 0, 2}, {0, 0.2, 0})};
  scene.distributed_loads = {{"leg 2", {0.5, 1.0, -1.5}, {0.3, 0, 0.2}, 1}};
  scene.supports[0].prescribed_displacement = {0.1, 0, -0.05};
  scene.supports[0].prescribed_rotation = {0.2, 0.3, -0.1};
  return scene;
}

class BeamGroupTest : public testing::Test, public BeamFixture {
 protected:
  BeamGroupTest() : BeamFixture(frame(), 1.0) {}
};

/// Whether the cap is felt in the first increment.
bool is_felt(const Scene& scene, double enough) {
  BeamProblem problem(scene, this_rank(), {});
  MixedVector rows = problem.model.create_vector(), increment = rows.clone(true);
  const EvaluationPoint point = mixed_residual(problem.model, problem.model.reference_state(), 1.0, rows);
  Linearization linearization(problem, point, cap_for(problem.model, point.scales), {});
  linearization.newton_increment(increment);
  return feels_cap(linearization, increment, enough);
}

/// Bending moves a rigid rod by F / 3 EI, shear by the compliance of the cap, 1e-5 of it; a rod that is pushed along
/// its axis between two clamps moves by that compliance alone.
TEST(CapCompliance, IsFeltWhereItIsMostOfTheMotion) {
  constexpr double kEnough = 1e-4, kMuch = 10.0;
  Scene bent = cantilever(section(kRigid, kRigid, 1.0, 1.0), 1.0, 2, 4);
  bent.point_loads = {dead_load("tip", {0, 0.1, 0})};
  EXPECT_FALSE(is_felt(bent, kEnough));
  EXPECT_TRUE(is_felt(bent, 0.0)) << "what is allowed counts";
  Scene pushed = cantilever(section(1e12, 1e12, 1.0, 1.0), 1.0, 2, 4);
  pushed.supports.push_back(clamp("tip"));
  pushed.distributed_loads = {{"beam", {0.1, 0, 0}}};
  EXPECT_TRUE(is_felt(pushed, kEnough));
  EXPECT_FALSE(is_felt(pushed, kMuch));
}

/// What the cap leaves out is measured without writing its rows; the same number, but for the rounding of products that
/// the compiler fuses in one place and not in the other.
TEST(CapCompliance, LargestRowIsThatOfAllRows) {
  constexpr double kFusedProducts = 1e-14;  // a few roundings of one product of four factors
  const Model model(cantilever(section(kRigid, kRigid, 1.0, 1.0), 1.0, 3, 5), this_rank(), {});
  const ResidualScales scales = scales_of(model, model.reference_state(), 1.0);
  const Cap cap = cap_for(model, scales);
  MixedVector increment = model.create_vector(), rows = model.create_vector();
  fill_at_random(increment, 1.0, 11);
  cap_compliance_rows(model, cap, scales, increment, rows);
  const double largest = rows.maximum_norm();
  EXPECT_GT(largest, 0.0);
  EXPECT_NEAR(largest_cap_compliance_row(model, cap, scales, increment) / largest, 1.0, kFusedProducts);
  fill_at_random(increment, 2.0, 12);
  EXPECT_GT(std::abs(largest_cap_compliance_row(model, cap, scales, increment) / largest - 1.0), 1e-3)
      << "another one is seen";
}

/// The residual where it was taken last is not taken again; anywhere else it is.
TEST_F(BeamGroupTest, ResidualIsTakenOncePlaceByPlace) {
  const Model& model = problem().model;
  const State state = model.reference_state(), same_numbers = model.reference_state();
  MixedVector rows = model.create_vector(), again = rows.clone(false), anew = rows.clone(false);
  const int before = problem().work.residuals;
  const auto taken = [&] { return problem().work.residuals - before; };
  take_residual(problem(), state, 1.0, rows);
  take_residual(problem(), State(state), 1.0, again);
  EXPECT_EQ(take_point(problem(), state, 1.0).end_angles.data(), take_point(problem(), state, 1.0).end_angles.data());
  EXPECT_EQ(taken(), 1);
  mixed_residual(model, state, 1.0, anew);
  EXPECT_TRUE(same_bits(again, rows));
  EXPECT_TRUE(same_bits(again, anew));
  again.writable_vertex(true)(0) += 1.0;
  take_residual(problem(), state, 1.0, anew);
  EXPECT_TRUE(same_bits(anew, rows)) << "one that was written to";
  take_residual(problem(), same_numbers, 1.0, again);
  EXPECT_EQ(taken(), 2);
  take_residual(problem(), same_numbers, 0.5, again);
  EXPECT_EQ(taken(), 3);
  EXPECT_FALSE(same_bits(again, rows));
  State in_space = same_numbers;
  in_space.in_plane = !in_space.in_plane;
  EXPECT_FALSE(problem().is_last_point(in_space, 0.5));
}

/// A sign that is turned takes no pass over the numbers, and is there when they are asked for.
TEST_F(BeamGroupTest, VectorsKeepTheirSigns) {
  const BeamVector a = random_vector(1.0, 3);
  BeamVector minus(problem().model.create_vector());
  minus.update(-1.0, a, 0.0);
  EXPECT_TRUE(same_bits(BeamVector(minus).scale(-1.0), a));
  EXPECT_EQ(minus.norm(NOX::Abstract::Vector::TwoNorm), a.norm(NOX::Abstract::Vector::TwoNorm));
  EXPECT_LT(BeamVector(minus, NOX::DeepCopy).innerProduct(a), 0.0);
  BeamVector sum(minus), twice(problem().model.create_vector());
  sum.update(2.0, a, 1.0);
  EXPECT_TRUE(same_bits(sum, a));
  twice.update(1.0, minus, 1.0, minus, 0.0);
  twice.update(2.0, a, 1.0);
  EXPECT_EQ(twice.norm(NOX::Abstract::Vector::MaxNorm), 0.0);
  static_cast<NOX::Abstract::Vector&>(twice) = minus;
  EXPECT_FALSE(same_bits(twice, a));
  EXPECT_TRUE(same_bits(twice.scale(-1.0), a));
}

TEST_F(BeamGroupTest, PresentCoordinateChangesNothing) {
  newton_step();
  group().computeF();
  const State before = group().state();
  const Teuchos::RCP<NOX::Abstract::Vector> x = group().getX().clone(NOX::DeepCopy);
  group().setX(*x);
  EXPECT_TRUE(same_bits(group().state(), before));
  EXPECT_TRUE(group().isF());
}

TEST_F(BeamGroupTest, MovesByTheDifferenceOfCoordinates) {
  newton_step();
  const Teuchos::RCP<Group> start = group().clone(NOX::DeepCopy);
  const BeamVector d = random_vector(0.1, 5);
  group().computeX(*start, d, 0.5);
  const State expected = group().state();
  const Teuchos::RCP<NOX::Abstract::Vector> y = group().getX().clone(NOX::DeepCopy);
  group().copy(*start);
  group().setX(*y);
  EXPECT_FALSE(group().isF());
  EXPECT_TRUE(same_bits(group().getX(), *y));
  constexpr double kCancelled = 1e-14;  // roundings of coordinates of size one
  for (size_t v = 0; v < expected.views.vertex_rotation.extent(0); ++v) {
    for (int i = 0; i < 4; ++i)
      EXPECT_NEAR(group().state().views.vertex_rotation(v, i), expected.views.vertex_rotation(v, i), kCancelled);
    for (int i = 0; i < 3; ++i)
      EXPECT_NEAR(group().state().views.vertex_displacement(v, i), expected.views.vertex_displacement(v, i),
                  kCancelled);
  }
}

TEST_F(BeamGroupTest, ComposesRotations) {
  // two half turns about different axes: not the turn about the sum
  BeamVector first = create_vector(), second = create_vector();
  first.init(0.0);
  second.init(0.0);
  const int vertex = vertex_of(problem().model.mesh(), "tip");
  first.values().vertex()(kVertexDofs * vertex + 3) = kPi;
  second.values().vertex()(kVertexDofs * vertex + 4) = 2.0 * kPi;
  group().computeX(*group().clone(NOX::DeepCopy), first, 1.0);
  group().computeX(*group().clone(NOX::DeepCopy), second, 0.5);
  const auto q = group().state().views.vertex_rotation;
  constexpr double kRounded = 1e-15;
  EXPECT_NEAR(std::abs(q(vertex, 3)), 1.0, kRounded);  // e2-half-turn after e1-half-turn is a half turn about e3
  EXPECT_NEAR(q(vertex, 0), 0.0, kRounded);
}

TEST_F(BeamGroupTest, CopiesCarryEverything) {
  newton_step();
  newton_step();
  compute();
  const Teuchos::RCP<Group> clone = group().clone(NOX::DeepCopy);
  const BeamGroup& other = BeamGroup::of(*clone);
  EXPECT_TRUE(same_bits(other.state(), group().state()));
  EXPECT_TRUE(other.isF());
  EXPECT_TRUE(other.isNewton());
  EXPECT_TRUE(same_bits(other.getF(), group().getF()));
  EXPECT_TRUE(same_bits(other.getNewton(), group().getNewton()));
  EXPECT_TRUE(same_bits(other.getX(), group().getX()));
  EXPECT_EQ(other.load_factor(), group().load_factor());
  EXPECT_EQ(other.equilibrium_norm(), group().equilibrium_norm());
  // the matrix stays with the group that assembled it
  EXPECT_TRUE(group().isJacobian());
  EXPECT_FALSE(other.isJacobian());
}

TEST_F(BeamGroupTest, ChangingACopyLeavesTheOriginal) {
  newton_step();
  compute();
  // the numbers themselves, not views of them
  const State before = group().state();
  State kept = allocate_state(problem().model.structure());
  Kokkos::deep_copy(kept.views.vertex_displacement, before.views.vertex_displacement);
  Kokkos::deep_copy(kept.views.vertex_rotation, before.views.vertex_rotation);
  Kokkos::deep_copy(kept.views.element_triad, before.views.element_triad);
  Kokkos::deep_copy(kept.views.interior, before.views.interior);
  const MixedVector f = BeamVector::of(group().getF()).clone(true),
                    newton = BeamVector::of(group().getNewton()).clone(true);
  BeamVector twice_f = create_vector();
  twice_f.update(2.0, group().getF(), 0.0);
  const BeamVector solved_before = answer_to(twice_f);
  const Teuchos::RCP<Group> clone = group().clone(NOX::DeepCopy);
  clone->computeX(group(), group().getNewton(), 1.0);
  clone->computeF();
  clone->computeJacobian();
  clone->setX(random_vector(0.2, 3));
  clone->computeF();
  EXPECT_TRUE(same_bits(group().state(), kept));
  EXPECT_TRUE(same_bits(BeamVector::of(group().getF()), f));
  EXPECT_TRUE(same_bits(BeamVector::of(group().getNewton()), newton));
  ASSERT_TRUE(group().isJacobian());  // each has a tangent of its own
  twice_f.update(2.0, group().getF(), 0.0);
  EXPECT_TRUE(same_bits(answer_to(twice_f), solved_before));
}

// Whoever holds a tangent holds it: others, with another state or cap, leave its answers as they are.
TEST_F(BeamGroupTest, KeepsItsTangent) {
  const Model& model = problem().model;
  const BeamVector rhs = random_vector(0.1, 5);
  newton_step(0.1);
  group().computeF();
  group().computeJacobian();
  const BeamVector before = answer_to(rhs);
  MixedVector residual = model.create_vector();
  const EvaluationPoint elsewhere = mixed_residual(model, model.reference_state(), 0.5, residual);
  Linearization other(problem(), elsewhere, cap_for(model, elsewhere.scales, 10.0), {});
  MixedVector solution = model.create_vector();
  other.solve(rhs.values(), solution);
  EXPECT_FALSE(same_bits(solution, BeamVector::of(before)));
  EXPECT_TRUE(group().isJacobian());
  EXPECT_TRUE(same_bits(answer_to(rhs), before));
}

/// The Newton increment is that of the residual, whatever was solved before.
TEST_F(BeamGroupTest, NewtonIncrementDoesNotDependOnTheOrderOfSolves) {
  const Model& model = problem().model;
  newton_step(0.1);
  MixedVector residual = model.create_vector(), first = residual.clone(true), again = residual.clone(true),
              between = residual.clone(true);
  const EvaluationPoint point = mixed_residual(model, group().state(), 1.0, residual);
  Linearization linearization(problem(), point, cap_for(model, point.scales), {});
  linearization.newton_increment(first);
  linearization.solve(random_vector(0.1, 7).values(), between);
  EXPECT_FALSE(same_bits(between, first));
  linearization.newton_increment(again);
  EXPECT_TRUE(same_bits(again, first));
}

/// Arrays of a tangent that is gone are those of the next one.
TEST_F(BeamGroupTest, TangentsUseTheSameArraysOneAfterTheOther) {
  const Model& model = problem().model;
  MixedVector residual = model.create_vector();
  const EvaluationPoint point = mixed_residual(model, model.reference_state(), 1.0, residual);
  const Cap cap = cap_for(model, point.scales);
  const double* first = Tangent(model, point, cap).elements().response.data();
  const Tangent second(model, point, cap);
  EXPECT_EQ(second.elements().response.data(), first);
  EXPECT_NE(Tangent(model, point, cap).elements().response.data(), first);
}

// What a step control does: try, reject, return, and take a shorter step.
TEST_F(BeamGroupTest, RejectedStepRestoresAll) {
  newton_step();
  compute();
  const Teuchos::RCP<Group> old = group().clone(NOX::DeepCopy);
  group().computeX(*old, old->getNewton(), 1.0);
  group().computeF();
  group().computeJacobian();
  static_cast<Group&>(group()) = *old;
  EXPECT_TRUE(same_bits(group().state(), BeamGroup::of(*old).state()));
  EXPECT_TRUE(same_bits(group().getF(), old->getF()));
  EXPECT_TRUE(same_bits(group().getNewton(), old->getNewton()));
  // recomputed from the state, residual and increment are the same: nothing hidden was left behind
  group().setParam(kLoadFactor, 0.5);
  group().setParam(kLoadFactor, 1.0);
  EXPECT_FALSE(group().isF());
  compute();
  EXPECT_TRUE(same_bits(group().getF(), old->getF()));
  EXPECT_TRUE(same_bits(group().getNewton(), old->getNewton()));
}

// Right-hand sides are scaled as the residual was: a copy that kept the scales of its former state would misread them.
TEST_F(BeamGroupTest, CopyKnowsTheScalesOfItsResidual) {
  const Teuchos::RCP<Group> unloaded = group().clone(NOX::DeepCopy);
  unloaded->computeF();
  newton_step();
  group().computeF();
  group().computeJacobian();
  const BeamVector rhs = random_vector(1.0, 6);
  const BeamVector expected = answer_to(rhs);
  BeamVector actual = create_vector();
  *unloaded = group();
  unloaded->computeJacobian();
  ASSERT_EQ(unloaded->applyJacobianInverse(no_parameters(), rhs, actual), Group::Ok);
  EXPECT_TRUE(same_bits(actual, expected));
}

TEST_F(BeamGroupTest, FractionOfAStepMovesTheInteriorToo) {
  newton_step();
  compute();
  const Teuchos::RCP<Group> old = group().clone(NOX::DeepCopy);
  group().computeX(*old, old->getNewton(), 0.25);
  const auto before = BeamGroup::of(*old).state().views.interior, after = group().state().views.interior;
  const auto newton = BeamVector::of(old->getNewton()).interior();
  for (const ElementBlock& block : problem().model.structure().blocks)
    for (int e = 0; e < block.count; ++e)
      for (int i = 0; i < block.interior.unknowns(); ++i) {
        const size_t place = block.interior_offset + e * block.interior.unknowns() + i;
        const double d = newton(block.increment_offset + e * block.interior.increments() + i);
        ASSERT_NEAR(after(place) - before(place), 0.25 * d, 1e-14 * (1.0 + std::abs(before(place))));
      }
}

TEST_F(BeamGroupTest, InverseOfTheResidualIsTheNewtonIncrement) {
  newton_step();
  group().computeF();
  group().computeJacobian();
  BeamVector result = answer_to(group().getF());
  result.scale(-1.0);
  EXPECT_TRUE(result.values().same_values(BeamVector::of(group().getNewton())));
  ASSERT_EQ(group().applyJacobian(group().getNewton(), result), Group::Ok);
  result.scale(-1.0);
  EXPECT_TRUE(result.values().same_values(BeamVector::of(group().getF())));
  EXPECT_EQ(group().applyJacobian(random_vector(1.0, 4), result), Group::NotDefined);
}

TEST_F(BeamGroupTest, GeneralPathAgreesWithTheFastOne) {
  newton_step();
  compute();
  BeamVector twice = create_vector();
  twice.update(2.0, group().getF(), 0.0);
  BeamVector result = answer_to(twice);
  result.update(2.0, group().getNewton(), 1.0);
  const double size = group().getNewton().norm(NOX::Abstract::Vector::MaxNorm);
  EXPECT_LE(result.norm(NOX::Abstract::Vector::MaxNorm), 1e-11 * size);  // the condition of the small frame
  // and the Newton increment is still that of F
  result = answer_to(group().getF());
  result.scale(-1.0);
  EXPECT_TRUE(result.values().same_values(BeamVector::of(group().getNewton())));
}

/// The tangent is there without a solve; the increment is solved for when it is asked for.
TEST_F(BeamGroupTest, TheJacobianHidesNoSolve) {
  newton_step();
  group().computeJacobian();
  EXPECT_TRUE(group().isJacobian());
  EXPECT_FALSE(group().isNewton());
  group().computeNewton(no_parameters());
  EXPECT_TRUE(group().isNewton());
}

TEST_F(BeamGroupTest, InverseNeedsTheJacobian) {
  group().computeF();
  BeamVector result = create_vector();
  EXPECT_EQ(group().applyJacobianInverse(no_parameters(), group().getF(), result), Group::BadDependency);
}

/// (F(x + e d) - F(x - e d)) / 2e. In equilibrium the scales of the rows may change without effect.
BeamVector difference_quotient(BeamFixture& fixture, const NOX::Abstract::Vector& d, double step) {
  const Teuchos::RCP<Group> high = fixture.group().clone(NOX::DeepCopy), low = fixture.group().clone(NOX::DeepCopy);
  high->computeX(fixture.group(), d, step);
  low->computeX(fixture.group(), d, -step);
  high->computeF();
  low->computeF();
  BeamVector quotient = fixture.create_vector();
  quotient.update(0.5 / step, high->getF(), -0.5 / step, low->getF(), 0.0);
  return quotient;
}

TEST_F(BeamGroupTest, InverseSolvesForAnyRightHandSideInEquilibrium) {
  converge();
  group().computeF();
  group().computeJacobian();
  for (unsigned seed : {1, 2, 3}) {
    const BeamVector rhs = random_vector(1.0, seed);
    const BeamVector d = answer_to(rhs);
    const double size = BeamVector::of(d).largest_vertex_spin();
    double errors[2];
    for (int i = 0; i < 2; ++i) {
      BeamVector error = difference_quotient(*this, d, (i == 0 ? 2e-3 : 1e-3) / size);
      error.update(-1.0, rhs, 1.0);
      errors[i] = error.norm(NOX::Abstract::Vector::MaxNorm);
    }
    EXPECT_LT(errors[1], 1e-2);
    EXPECT_LE(errors[1], 0.28 * errors[0]) << "second order: a quarter";
  }
}

TEST_F(BeamGroupTest, DerivativeWithRespectToTheLoadFactor) {
  group().setParam(kLoadFactor, 0.5);
  converge();
  group().computeF();
  const Teuchos::RCP<NOX::Abstract::MultiVector> dfdp = Teuchos::rcp(new NOX::MultiVector(group().getX(), 2));
  ASSERT_EQ(group().computeDfDpMulti({0}, *dfdp, false), Group::Ok);
  EXPECT_TRUE(same_bits((*dfdp)[0], group().getF()));
  constexpr double kStep = 1e-4;
  const Teuchos::RCP<Group> high = group().clone(NOX::DeepCopy), low = group().clone(NOX::DeepCopy);
  dynamic_cast<BeamGroup&>(*high).setParam(kLoadFactor, 0.5 + kStep);
  dynamic_cast<BeamGroup&>(*low).setParam(0, 0.5 - kStep);
  high->computeF();
  low->computeF();
  BeamVector error = create_vector();
  error.update(0.5 / kStep, high->getF(), -0.5 / kStep, low->getF(), 0.0);
  error.update(-1.0, (*dfdp)[1], 1.0);
  EXPECT_GT((*dfdp)[1].norm(NOX::Abstract::Vector::MaxNorm), 1e-3);
  // the load rows are linear; their scale depends on the load by a share of the step
  EXPECT_LE(error.norm(NOX::Abstract::Vector::MaxNorm), 10 * kStep * kStep + 1e-9);
}

// dx/dp from both of them: the path that LOCA's tangent predictor follows.
TEST_F(BeamGroupTest, TangentOfThePath) {
  group().setParam(kLoadFactor, 0.5);
  converge();
  group().computeF();
  group().computeJacobian();
  const Teuchos::RCP<NOX::Abstract::MultiVector> dfdp = Teuchos::rcp(new NOX::MultiVector(group().getX(), 2));
  group().computeDfDpMulti({0}, *dfdp, true);
  const BeamVector tangent = answer_to((*dfdp)[1]);
  const Teuchos::RCP<Group> start = group().clone(NOX::DeepCopy);
  // the residual after a step along the tangent is of second order
  double residual[2];
  for (int i = 0; i < 2; ++i) {
    const double step = i == 0 ? 2e-3 : 1e-3;
    group().copy(*start);
    group().setParam(kLoadFactor, 0.5 + step);
    group().computeX(*start, tangent, -step);
    group().computeF();
    residual[i] = group().getNormF();
  }
  EXPECT_LT(residual[1], 1e-3);
  EXPECT_LE(residual[1], 0.28 * residual[0]);
}

TEST_F(BeamGroupTest, NewParameterInvalidatesTheResidual) {
  group().computeF();
  group().setParam(kLoadFactor, 1.0);
  EXPECT_TRUE(group().isF());
  group().setParam(kLoadFactor, 0.9);
  EXPECT_FALSE(group().isF());
  EXPECT_EQ(group().getParam(0), 0.9);
  EXPECT_EQ(group().getParam(kLoadFactor), 0.9);
}

TEST(BeamGroup, SingularTangentGivesAnIncrementWithoutNumbers) {
  Scene scene = cantilever(section(10, 10, 1, 1), 1.0, 2, 2);
  scene.point_loads = {dead_load("tip", {1, 0, 0})};
  scene.supports[0].displacement_fixed = {false, true, true};  // slides along itself
  BeamFixture fixture(scene, 1.0);
  fixture.group().computeF();
  fixture.group().computeNewton(fixture.no_parameters());
  EXPECT_FALSE(std::isfinite(fixture.group().getNewton().norm(NOX::Abstract::Vector::MaxNorm)));
  EXPECT_FALSE(fixture.problem().last_failure.empty());
}

}  // namespace
}  // namespace mixbeam::test
