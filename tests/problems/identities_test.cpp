// Exact statements about solutions: they hold for the discrete solution, too, so no mesh enters their tolerances.
#include "tests/support/solve.hpp"

namespace mixbeam::test::identities_test {
namespace {

// Both sides are solved to a scaled residual of 1e-11 at most; flexible members multiply it by a few.
constexpr double kSolved = 1e-10;
// C_gamma = c I and dead tip forces only: rotations do not depend on c, the centerline shifts by s F / c.
TEST(Identities, EqualForceStiffnessesShiftTheCenterline) {
  const double force = 600.0, bending = 1e7 / 12.0, arc_length = 100.0 * kPi / 4.0;
  for (int order : {1, 3}) {
    const auto arc = [&](double c) {
      return solved(arc_segment(section(c, c, bending, bending), force, 1.0, order, 8));
    };
    const Simulation rigid = arc(kRigid);
    for (double c : {1e4, 1e7}) {
      const Simulation soft = arc(c);
      EXPECT_TRUE(agrees(soft.rotation("tip"), rigid.rotation("tip"), kSolved)) << "order " << order << ", c " << c;
      Vector3 expected = rigid.displacement("tip");
      expected[2] += arc_length * force / c;
      EXPECT_TRUE(agrees_relatively(soft.displacement("tip"), expected, kSolved)) << "order " << order << ", c " << c;
    }
  }
}

}  // namespace
}  // namespace mixbeam::test::identities_test
