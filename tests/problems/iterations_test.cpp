// How many Newton iterations the problems of the paper may take, and that stiffness ratios and rigid limits do not
// change it. The bounds are part of what the program promises; those of frame, fork and helical rod are checked by
// their studies.
#include "tests/support/solve.hpp"

namespace mixbeam::test {
namespace {

constexpr double kSlendernesses[] = {1e1, 1e2, 1e3, 1e4, 1e6, 1e8, 1e10, 1e12};

// Vertices of these two are exact, up to the scaled residual (1e-11 by default).
constexpr double kExact = 1e-11;

// Both sides of the comparison of slender with rigid sections are solved to a scaled residual of 1e-11 at most.
constexpr double kRigidLimit = 1e-10;

TEST(Iterations, RollupTakesThreeAtAnySlenderness) {
  for (double slenderness : kSlendernesses)
    for (int order : {1, 2, 4}) {
      SCOPED_TRACE("slenderness " + std::to_string(slenderness) + ", order " + std::to_string(order));
      for (const Simulation& rod : solved_in_plane_and_in_space(rollup(slenderness, order, 8))) {
        EXPECT_LE(rod.result().newton_iterations, 3);
        EXPECT_EQ(rod.result().steps, 1);
        EXPECT_TRUE(agrees(rod.position("tip"), {0, 0, 0}, kExact));
      }
    }
}

// The clamp turns first: turning and bending at once is another problem, whose solution is exact, too.
TEST(Iterations, HelixTakesThree) {
  for (int order : {1, 2, 3}) {
    const Simulation rod = solved(helix_experiment(order, order == 1 ? 5 : 3, 2));
    ASSERT_EQ(rod.result().iterations_of_stage.size(), 2u);
    EXPECT_LE(rod.result().iterations_of_stage[0], 3) << "turning, order " << order;
    EXPECT_LE(rod.result().iterations_of_stage[1], 3) << "bending, order " << order;
    EXPECT_EQ(rod.result().steps, 2) << "order " << order;
    EXPECT_TRUE(agrees(rod.position("tip"), {0, -kHelixRadius, kHelixHeight}, kExact * helix_length())) << order;
  }
}

TEST(Iterations, ArcTakesAtMostElevenAtAnySlendernessAndRigid) {
  for (int order = 1; order <= 4; ++order) {
    for (double slenderness : kSlendernesses) {
      const Simulation arc = solved(arc_segment(slenderness, order, 8));
      EXPECT_LE(arc.result().newton_iterations, 11) << "slenderness " << slenderness << ", order " << order;
      EXPECT_EQ(arc.result().steps, 1) << "slenderness " << slenderness << ", order " << order;
    }
    const Section rigid = section(kRigid, kRigid, 1e7 / 12.0, 1e7 / 12.0);
    const Simulation arc = solved(arc_segment(rigid, 600.0, 1.0, order, 8));
    EXPECT_LE(arc.result().newton_iterations, 11) << "rigid, order " << order;
    EXPECT_EQ(arc.result().steps, 1) << "rigid, order " << order;
  }
}

// Axially rigid only, shear-rigid only, in one direction only.
TEST(Iterations, EachComponentMayBeRigid) {
  for (int component = 0; component < 3; ++component) {
    Section rigid = arc_section(1e4);
    const Vector3 slender = solved(arc_segment(rigid, arc_force(1e4), 1.0, 2, 8)).displacement("tip");
    (component == 0 ? rigid.axial_stiffness : rigid.shear_stiffness[component - 1]) = kRigid;
    const Simulation arc = solved(arc_segment(rigid, arc_force(1e4), 1.0, 2, 8));
    EXPECT_LE(arc.result().newton_iterations, 11) << component;
    EXPECT_TRUE(agrees_relatively(arc.displacement("tip"), slender, 1.2e-8 + kRigidLimit)) << component;
  }
}

}  // namespace
}  // namespace mixbeam::test
