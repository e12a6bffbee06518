// The tangent of supports and joints is the derivative of their equations.
#include "tests/nonlinear/beam_fixture.hpp"
#include "tests/support/constrained_scenes.hpp"

namespace mixbeam::test {
namespace {

/// Largest entry of (F(x + e d) - F(x - e d)) / (2 e) - expected.
double derivative_error(BeamFixture& fixture, const NOX::Abstract::Vector& direction,
                        const NOX::Abstract::Vector& expected, double step) {
  BeamVector difference = fixture.create_vector();
  const Teuchos::RCP<NOX::Abstract::Group> here = fixture.group().clone(NOX::DeepCopy);
  double sign = 1.0;
  for (double s : {step, -step}) {
    const Teuchos::RCP<NOX::Abstract::Group> there = here->clone(NOX::DeepCopy);
    there->computeX(*here, direction, s);
    there->computeF();
    difference.update(0.5 * sign / step, there->getF(), 1.0);
    sign = -sign;
  }
  difference.update(-1.0, expected, 1.0);
  return difference.norm(NOX::Abstract::Vector::MaxNorm);
}

/// In equilibrium J s = b must hold for what the tangent makes of any b: there the matrix of second variations is the
/// derivative, and the scales of the rows do not matter. Right-hand sides reach into constraint rows, too.
void expect_tangent_is_derivative(const Scene& scene) {
  BeamFixture fixture(scene, 1.0);
  fixture.converge();
  fixture.group().computeF();
  fixture.group().computeJacobian();
  for (unsigned seed : {1u, 2u, 3u}) {
    BeamVector rhs = fixture.create_vector();
    fill_at_random(rhs.values(), 1.0, seed);
    const auto interior = rhs.values().writable_interior(false);
    for (size_t i = 0; i < interior.extent(0); ++i) interior(i) = 0.0;
    BeamVector solution = fixture.create_vector();
    ASSERT_EQ(fixture.group().applyJacobianInverse(fixture.no_parameters(), rhs, solution), NOX::Abstract::Group::Ok);
    const double size = 0.05 / solution.values().largest_vertex_spin();
    solution.scale(size);
    rhs.scale(size);
    constexpr double kStep = 2e-2, kQuadratic = 0.27, kRoundoff = 1e-9;
    const double coarse = derivative_error(fixture, solution, rhs, kStep);
    const double fine = derivative_error(fixture, solution, rhs, 0.5 * kStep);
    EXPECT_LT(fine, 1e-3 * rhs.norm(NOX::Abstract::Vector::MaxNorm));
    EXPECT_LE(fine, std::max(kQuadratic * coarse, kRoundoff)) << "coarse " << coarse << ", seed " << seed;
  }
}

TEST(ConstraintTangent, OfAPortalWithJointsAndSupportsOfAllKinds) {
  for (int order : {1, 3}) expect_tangent_is_derivative(portal_of_joints(order, 2));
}

TEST(ConstraintTangent, OfEachJointAlone) {
  const Scene all = portal_of_joints(2, 2);
  for (size_t j = 0; j < all.joints.size(); ++j) {
    Scene scene = all;
    scene.joints = {all.joints[j]};
    SCOPED_TRACE(all.joints[j].name);
    expect_tangent_is_derivative(scene);
  }
}

TEST(ConstraintTangent, OfSupportsWithOneOrTwoFixedRotations) {
  for (const std::array<bool, 3>& fixed : {std::array<bool, 3>{true, false, false}, {false, true, true}, {}}) {
    Scene scene = portal_of_joints(2, 2);
    scene.joints.clear();
    scene.supports[1].rotation_fixed = fixed;
    expect_tangent_is_derivative(scene);
    scene.supports[1].rotation_stiffness = {};
    expect_tangent_is_derivative(scene);
  }
}

/// Entries of the whole matrix of the tangent at the state of `fixture`, gathered after a residual at `between`.
std::vector<double> matrix_gathered_after(BeamFixture& fixture, const State& between) {
  const Model& model = fixture.problem().model;
  MixedVector residual = model.create_vector();
  const EvaluationPoint point = mixed_residual(model, fixture.group().state(), 1.0, residual);
  const Tangent tangent(model, point, cap_for(model, point.scales), {true});
  mixed_residual(model, between, 1.0, residual);
  const VertexMatrix matrix = whole_matrix(model);
  tangent.gather(matrix);
  const auto values = matrix.matrix()->getLocalMatrixHost().values;
  return std::vector<double>(values.data(), values.data() + values.extent(0));
}

// The matrix is gathered when it is asked for, maybe after residuals of other states: it keeps the forces of its own.
TEST(ConstraintTangent, KeepsTheForcesOfItsOwnState) {
  BeamFixture fixture(portal_of_joints(2, 2), 1.0);
  fixture.converge();
  const std::vector<double> own = matrix_gathered_after(fixture, fixture.group().state());
  const State other = fixture.problem().model.reference_state();
  EXPECT_EQ(own, matrix_gathered_after(fixture, other));
  BeamFixture at_rest(portal_of_joints(2, 2), 1.0);  // the twin that must fail: at another state it is another matrix
  EXPECT_NE(own, matrix_gathered_after(at_rest, at_rest.group().state()));
}

// The twin that must fail: with a stiffer spring the tangent is another one.
TEST(ConstraintTangent, AWrongTangentWouldBeSeen) {
  Scene scene = portal_of_joints(2, 2);
  BeamFixture fixture(scene, 1.0);
  fixture.converge();
  fixture.group().computeF();
  fixture.group().computeJacobian();
  BeamVector rhs = fixture.random_vector(1.0, 1), solution = fixture.create_vector();
  const auto interior = rhs.values().writable_interior(false);
  for (size_t i = 0; i < interior.extent(0); ++i) interior(i) = 0.0;
  fixture.group().applyJacobianInverse(fixture.no_parameters(), rhs, solution);
  const double size = 0.05 / solution.values().largest_vertex_spin();
  solution.scale(size);
  rhs.scale(1.01 * size);
  EXPECT_GT(derivative_error(fixture, solution, rhs, 1e-3), 5e-3 * rhs.norm(NOX::Abstract::Vector::MaxNorm));
}

/// d F / d(load factor) in equilibrium, formulas as amplitudes included.
TEST(ConstraintTangent, LoadDerivative) {
  Scene scene = portal_of_joints(2, 2);
  scene.supports[0].prescribed_displacement = {0.02, -0.03, 0.01};
  scene.supports[0].prescribed_rotation = {0.1, 0.2, -0.1};
  scene.supports[0].amplitude = "sin(t)^2";
  scene.point_loads[1].amplitude = "t^3 - t";
  BeamFixture fixture(scene, 0.7);
  fixture.converge();
  Teuchos::RCP<NOX::Abstract::MultiVector> derivative = fixture.group().getX().createMultiVector(2);
  fixture.group().computeDfDpMulti({0}, *derivative, false);
  constexpr double kStep = 1e-4;
  BeamVector difference = fixture.create_vector();
  for (double sign : {1.0, -1.0}) {
    const auto there = Teuchos::rcp_dynamic_cast<BeamGroup>(fixture.group().clone(NOX::DeepCopy), true);
    there->setParam(kLoadFactor, 0.7 + sign * kStep);
    there->computeF();
    difference.update(0.5 * sign / kStep, there->getF(), 1.0);
  }
  const double size = difference.norm(NOX::Abstract::Vector::MaxNorm);
  difference.update(-1.0, (*derivative)[1], 1.0);
  EXPECT_GT(size, 0.1);
  EXPECT_LT(difference.norm(NOX::Abstract::Vector::MaxNorm), 1e-6 * size);
}

}  // namespace
}  // namespace mixbeam::test
