// Linear buckling against closed forms.
#include "nonlinear/linear_buckling.hpp"

#include "tests/nonlinear/buckling_scenes.hpp"
#include "tests/nonlinear/stability_fixture.hpp"

namespace mixbeam::test {
namespace {

/// The pencil of condensed tangents is of fourth order in the element length: 2e-6 with eight elements in a cantilever.
constexpr double kFactor = 5e-7;
/// Under moments it is less exact, 7e-3 with six elements.
constexpr double kLateralFactor = 5e-4;

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
    expect_factors(column(4, 48, ends.supports), {ends.critical});
  }
  const double euler = 0.25 * kPi * kPi;
  expect_factors(column(4, 48), {euler, 6 * euler, 9 * euler}, 1e-5);  // the second one in the other plane
}

TEST(LinearBuckling, DoubleFactors) {
  Scene scene = column(4, 48);
  scene.sections[0].bending_stiffness = {1.0, 1.0};
  const double euler = 0.25 * kPi * kPi;
  expect_factors(scene, {euler, euler, 9 * euler, 9 * euler}, 1e-5);
}

TEST(LinearBuckling, Joints) { expect_factors(jointed_column(2.0, 4, 16), {jointed_column_load(2.0)}); }

TEST(LinearBuckling, LoadsOfBothSigns) {
  const std::vector<double> found = factors(narrow_cantilever(2, 64), 2);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_NEAR(std::abs(found[0]), kNarrowCantilever, kLateralFactor * kNarrowCantilever);
  EXPECT_NEAR(found[0], -found[1], kLateralFactor * kNarrowCantilever);
  const std::vector<double> moment = factors(uniform_moment(2, 64), 1);
  ASSERT_EQ(moment.size(), 1u);
  EXPECT_NEAR(std::abs(moment[0]), kPi, kLateralFactor * kPi);
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
  EXPECT_GT(std::abs(factors(column(4, 24), 1)[0] - 0.25 * kPi * kPi * (1.0 + 1e-5)), 2.4 * kFactor);
}

TEST(MpiLinearBuckling, TheSameOnAnyNumberOfRanks) {
  const std::vector<double> found = factors(column(6, 5), 2, all_ranks());
  ASSERT_EQ(found.size(), 2u);
  EXPECT_NEAR(found[0], 0.25 * kPi * kPi, 1e-4);
}

}  // namespace
}  // namespace mixbeam::test
