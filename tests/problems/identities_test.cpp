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

// Which tine is loaded first does not matter in the end, and half a turn about e1 maps one path onto the other.
TEST(Identities, ReversedPathOfTheFork) {
  Simulation first(fork(3, 3, true), {}, this_rank()), second(fork(3, 3, false), {}, this_rank());
  std::vector<std::array<double, 6>> after_first_stage;
  const auto run = [&](Simulation& simulation, const std::string& loaded) {
    const int vertex = vertex_of(simulation.model().mesh(), loaded);
    simulation.run([&](const StepReport& report, const State& state) {
      if (report.load_factor == 1.0) after_first_stage.push_back(vertex_motion(simulation.model(), state, vertex));
    });
    EXPECT_TRUE(simulation.result().finished) << simulation.result().failure;
  };
  run(first, "tine 1");
  run(second, "tine 2");
  ASSERT_EQ(after_first_stage.size(), 2u);
  const auto& one = after_first_stage[0];
  const auto& two = after_first_stage[1];
  EXPECT_TRUE(agrees({two[0], two[1], two[2]}, {one[0], -one[1], -one[2]}, kSolved));
  EXPECT_TRUE(agrees({two[3], two[4], two[5]}, {one[3], -one[4], -one[5]}, kSolved));
  for (const char* point : {"branch", "tine 1", "tine 2"}) {
    EXPECT_TRUE(agrees(second.displacement(point), first.displacement(point), kSolved)) << point;
    EXPECT_TRUE(agrees(second.rotation(point), first.rotation(point), kSolved)) << point;
  }
  const Vector3 u = first.displacement("tine 1");
  EXPECT_TRUE(agrees(first.displacement("tine 2"), {u[0], -u[1], -u[2]}, kSolved));
}

}  // namespace
}  // namespace mixbeam::test::identities_test
