// The comparison of the other tests must be able to fail: twins of their checks with wrong answers.
#include "tests/support/solve.hpp"

namespace mixbeam::test {
namespace {

constexpr double kTolerance = 1e-8;  // that of the reference values

TEST(Comparison, TellsARightAnswerFromAWrongOne) {
  const Vector3 value = {1.0, -2.0, 3.0};
  EXPECT_TRUE(agrees(value, value, 0.0));
  for (int i = 0; i < 3; ++i) {
    Vector3 wrong = value;
    wrong[i] += 2.0 * kTolerance;
    EXPECT_FALSE(agrees(wrong, value, kTolerance));
    wrong[i] = -value[i];
    EXPECT_FALSE(agrees(wrong, value, kTolerance));
  }
}

TEST(Comparison, NotANumberNeverAgrees) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (int i = 0; i < 3; ++i) {
    Vector3 value = {1.0, -2.0, 3.0}, broken = value;
    broken[i] = nan;
    EXPECT_FALSE(agrees(broken, value, kTolerance));
    EXPECT_FALSE(agrees(value, broken, kTolerance));
    EXPECT_FALSE(agrees_relatively(broken, broken, kTolerance));
  }
}

// The twin of comparisons with references: a load that is wrong in its seventh digit is caught through the whole program.
TEST(Comparison, ASlightlyWrongLoadIsCaught) {
  const Section shear_rigid = section(1e7, kRigid, 1e7 / 12.0, 1e7 / 12.0);
  const Vector3 right = solved(arc_segment(shear_rigid, 600.0, -1.0, 4, 8)).displacement("tip");
  const Vector3 wrong = solved(arc_segment(shear_rigid, 600.0 * (1.0 + 1e-7), -1.0, 4, 8)).displacement("tip");
  EXPECT_FALSE(agrees_relatively(wrong, right, kTolerance));
}

}  // namespace
}  // namespace mixbeam::test
