// Linear buckling against closed forms.
#include "nonlinear/stability/linear_buckling.hpp"

#include "tests/nonlinear/buckling_scenes.hpp"
#include "tests/nonlinear/stability_fixture.hpp"

namespace mixbeam::test {
namespace {

/// What is asked of factors: rounding in tangents with a cap of 1e7.
constexpr double kFactor = 1e-8;

std::vector<double> factors(const Scene& scene, int count, const Communicator& comm = this_rank()) {
  BeamProblem problem(scene, comm, {});
  std::vector<double> result;
  for (const EigenMode& mode : linear_buckling(problem, count)) result.push_back(mode.eigenvalue);
  return result;
}

void expect_factors(const Scene& scene, const std::vector<double>& expected, double tolerance = kFactor) {
  const std::vector<double> found = factors(scene, static_cast<int>(expected.size()));
  ASSERT_EQ(found.size(), expected.size());
  for (size_t k = 0; k < expected.size(); ++k)
    EXPECT_NEAR(found[k], expected[k], tolerance * std::abs(expected[k])) << scene.name << ", factor " << k;
}

TEST(LinearBuckling, EulersColumns) {
  for (const ColumnEnds& ends : euler_columns()) {
    SCOPED_TRACE(ends.name);
    expect_factors(column(6, 8, ends.supports), {ends.critical});
  }
  const double euler = 0.25 * kPi * kPi;
  expect_factors(column(6, 8), {euler, 6 * euler, 9 * euler});  // the second one in the other plane
}

TEST(LinearBuckling, DoubleFactors) {
  Scene scene = column(6, 8);
  scene.sections[0].bending_stiffness = {1.0, 1.0};
  const double euler = 0.25 * kPi * kPi;
  expect_factors(scene, {euler, euler, 9 * euler, 9 * euler});
}

TEST(LinearBuckling, Joints) { expect_factors(jointed_column(2.0, 6, 4), {jointed_column_load(2.0)}); }

TEST(LinearBuckling, LoadsOfBothSigns) {
  const std::vector<double> found = factors(narrow_cantilever(6, 6), 2);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_NEAR(std::abs(found[0]), kNarrowCantilever, kFactor * kNarrowCantilever);
  EXPECT_NEAR(found[0], -found[1], kFactor * kNarrowCantilever);
  const std::vector<double> moment = factors(uniform_moment(6, 6), 1);
  ASSERT_EQ(moment.size(), 1u);
  EXPECT_NEAR(std::abs(moment[0]), kPi, kFactor * kPi);
}

/// The rotations of the response must not enter: with EI2 = 100 EI3 they made factors of 0.79 and 1.51. P L^2 = 2
/// j_{-1/4,n} sqrt(EI GIt) of the lateral buckling of a cantilever under a tip force, j
/// = 2.0062996717894, 5.1230627427, where the force bends about the stiff axis.
TEST(LinearBuckling, RotationsBeforeBucklingDoNotEnter) {
  for (int elements : {4, 16}) {
    Scene scene = narrow_cantilever(6, elements);
    scene.sections[0].bending_stiffness = {2.0, 200.0};
    BeamProblem problem(scene, this_rank(), {});
    const std::vector<EigenMode> modes = linear_buckling(problem, 4);
    ASSERT_EQ(modes.size(), 4u);
    for (int k = 0; k < 4; ++k) {
      EXPECT_NEAR(std::abs(modes[k].eigenvalue), k < 2 ? kNarrowCantilever : 10.2461254, k < 2 ? 1e-7 : 1e-5);
      EXPECT_TRUE(modes[k].converged) << "not confirmed by the inertia";
      EXPECT_LT(modes[k].error, 1e-5);
    }
  }
}

/// The load is shared by two rigid halves according to their (infinite) stiffness: the cap must not shift it. Half the
/// load compresses one half and pulls the other, so both signs of the load buckle alike.
TEST(LinearBuckling, ForcesSharedByStiffness) {
  for (double axial : {1e4, 1e10}) {
    Scene scene = jointed_column(1.0, 4, 4);
    scene.joints.clear();
    scene.sections[0].axial_stiffness = axial;
    scene.supports = {clamp("clamp"), clamp("tip")};
    scene.point_loads = {dead_load("middle", {1, 0, 0})};
    const std::vector<double> found = factors(scene, 2);
    ASSERT_EQ(found.size(), 2u);
    EXPECT_NEAR(found[0], -found[1], 1e-6 * std::abs(found[0]));
    EXPECT_GT(std::abs(found[0]), 2.0 * 4.0 * kPi * kPi);  // half of it, in half of the column
  }
}

TEST(LinearBuckling, NoStressNoBuckling) {
  Scene scene = column(2, 2);
  scene.point_loads.clear();
  EXPECT_TRUE(factors(scene, 2).empty());
}

// The twin that must fail.
TEST(LinearBuckling, AWrongFactorWouldBeSeen) {
  EXPECT_GT(std::abs(factors(column(6, 8), 1)[0] - 0.25 * kPi * kPi * (1.0 + 1e-7)), 2.4 * kFactor);
}

TEST(MpiLinearBuckling, TheSameOnAnyNumberOfRanks) {
  const std::vector<double> found = factors(column(6, 5), 2, all_ranks());
  ASSERT_EQ(found.size(), 2u);
  EXPECT_NEAR(found[0], 0.25 * kPi * kPi, 1e-4);
}

}  // namespace
}  // namespace mixbeam::test
