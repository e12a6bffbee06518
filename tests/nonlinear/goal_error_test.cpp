// Shares of members in the error of a quantity.
#include "tests/support/constrained_scenes.hpp"
#include "tests/support/solve.hpp"

namespace mixbeam::test {
namespace {

/// The squares that one Newton step leaves, over the error.
constexpr double kOfSum = 2e-3;
/// A member by itself without error: what one order more leaves, and what the members that meet share evenly.
constexpr double kOfShare = 0.2;
constexpr int kExactOrder = 8;

/// Two members of different meshes that turn differently.
Scene bent_frame() {
  Scene scene = angle_frame(3);
  scene.point_loads = {dead_load("tip", {3, 5, 0}, {0, 0, 2})};
  return scene;
}

double sideways(const Simulation& frame) { return frame.displacement("tip")[0]; }

std::vector<double> shares_of(const Simulation& frame, const ErrorEstimate& estimate) {
  const Model& richer = estimate.richer->model;
  State there = estimate.richer_state;
  there.in_plane = false;
  StateDerivative quantity(richer, there);
  quantity.add_displacement(richer.structure().partition.place(vertex_of(richer.mesh(), "tip")), {{1, 0, 0}});
  return shares_of_members(frame.model(), frame.state(), frame.load_factor(), estimate, quantity);
}

TEST(GoalError, SharesAddUpToTheChange) {
  const Simulation frame = solved(bent_frame());
  const ErrorEstimate estimate = frame.estimate_error();
  ASSERT_TRUE(estimate.exists()) << estimate.not_estimated;
  const std::vector<double> shares = shares_of(frame, estimate);
  const double change = estimate.vertex_displacement[vertex_of(frame.model().mesh(), "tip")][0];
  EXPECT_NEAR(shares[0] + shares[1], change, kOfSum * std::abs(change));
}

TEST(GoalError, AreWhatAnExactMemberTakesAway) {
  const Scene scene = bent_frame();
  const Simulation frame = solved(scene);
  const std::vector<double> shares = shares_of(frame, frame.estimate_error());
  for (size_t m = 0; m < 2; ++m) {
    Scene better = scene;
    better.members[m].order = kExactOrder;
    const double gain = sideways(solved(better)) - sideways(frame);
    EXPECT_NEAR(shares[m], gain, kOfShare * std::abs(gain)) << m;
    EXPECT_GT(std::abs(shares[1 - m] - gain), kOfShare * std::abs(gain)) << m;  // that of the other
  }
}

}  // namespace
}  // namespace mixbeam::test
