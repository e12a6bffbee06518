// Columns under loads that follow them: loads and frequencies at which two frequencies meet, exact ones. Those with a
// body at the end and with damping are columns of the study apps/modes.
#include "nonlinear/run/simulation.hpp"
#include "tests/support/scenes.hpp"

#include <gtest/gtest.h>

namespace mixbeam::test::flutter_test {
namespace {

/// Twice the errors of order 3 on 8 elements that a prototype with dense eigenvalues has.
constexpr double kBeck = 1.2e-6;
constexpr double kBeckLoad = 20.0509536189737, kBeckOmega = 11.01555764;

Scene column(double thrust, LoadFrame frame = LoadFrame::follower) {
  constexpr double kRigid = std::numeric_limits<double>::infinity();
  Section rod = section(kRigid, kRigid, 1.0, 1.0);
  rod.mass = 1.0;
  Scene scene = cantilever(rod, 1.0, 3, 8);
  PointLoad load = follower_load("tip", scene.members[0].name, {-thrust, 0.0, 0.0});
  load.frame = frame;
  if (frame == LoadFrame::dead) load.member.clear();
  scene.point_loads = {load};
  return scene;
}

std::vector<CriticalPoint> critical_points(const Scene& scene, bool in_plane = true) {
  SolverParameters parameters;
  parameters.threads = 1;
  parameters.analysis.modes.number = 2;
  parameters.analysis.modes.in_plane = in_plane;
  Simulation simulation(scene, parameters, this_rank());
  std::vector<CriticalPoint> found;
  simulation.run([&](const StepReport& report, const State&) {
    found.insert(found.end(), report.critical_points.begin(), report.critical_points.end());
  });
  return found;
}

TEST(Flutter, BeckInOneStepOfAnySize) {
  for (const double thrust : {20.1, 24.0, 30.0}) {
    const std::vector<CriticalPoint> found = critical_points(column(thrust));
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(found[0].kind, CriticalKind::flutter);
    EXPECT_NEAR(found[0].load_factor * thrust, kBeckLoad, kBeck * kBeckLoad);
    EXPECT_NEAR(found[0].omega, kBeckOmega, kBeck * kBeckOmega);
  }
  EXPECT_TRUE(critical_points(column(20.0)).empty());  // the twin: below the load nothing meets
}

TEST(Flutter, RoundColumnsHaveAllFrequenciesTwice) {
  const std::vector<CriticalPoint> found = critical_points(column(30.0), false);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].modes, 4);
  EXPECT_NEAR(found[0].load_factor * 30.0, kBeckLoad, kBeck * kBeckLoad);
}

/// The load grows and falls again: frequencies meet and part.
TEST(Flutter, IsEnteredAndLeftUnderLoadsByAFormula) {
  Scene scene = column(30.0);
  scene.point_loads[0].amplitude = "sin(pi*t)";
  const std::vector<CriticalPoint> found = critical_points(scene);
  ASSERT_EQ(found.size(), 2u);
  for (const CriticalPoint& point : found) {
    EXPECT_NEAR(30.0 * std::sin(kPi * point.load_factor), kBeckLoad, kBeck * kBeckLoad);
    EXPECT_EQ(point.negative_before > 0, &point == &found[1]);
    EXPECT_EQ(point.negative_after > 0, &point == &found[0]);
  }
}

/// A round column that spins about its axis is the same column, of which an observer in the frame sees other
/// frequencies: omega -+ Omega.
TEST(Flutter, RoundColumnsThatSpinHaveTheSameLoad) {
  constexpr double kSpin = 2.0;  // at load factor one
  Scene scene = column(30.0);
  scene.rotating_frames = {{{0, 0, 0}, {kSpin, 0, 0}}};
  const std::vector<CriticalPoint> found = critical_points(scene, false);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].kind, CriticalKind::flutter);
  EXPECT_NEAR(found[0].load_factor * 30.0, kBeckLoad, kBeck * kBeckLoad);
  EXPECT_NEAR(std::abs(found[0].omega - kBeckOmega), found[0].load_factor * kSpin, kBeck * kBeckOmega);
}

/// A shaft with a heavy spot whose material is damped whirls beyond its critical speed omega (1 + external over
/// internal damping), of which the external one is none here; without damping Coriolis forces hold it.
TEST(Flutter, ShaftsWithInnerDampingWhirlBeyondTheirCriticalSpeed) {
  constexpr double kShear = 1e-7;  // of stiffnesses of 1e9
  for (const double damping : {1e-2, 0.0}) {
    Scene scene = column(0.0);
    scene.point_loads.clear();
    scene.sections[0].mass = 0.0;
    scene.sections[0].axial_stiffness = 1e9;
    scene.sections[0].shear_stiffness = {1e9, 1e9};
    scene.sections[0].stiffness_damping = damping;
    scene.point_masses.push_back({"tip", 1.0});
    scene.rotating_frames = {{{0, 0, 0}, {2.0 * std::sqrt(3.0), 0, 0}}};
    std::vector<CriticalPoint> found = critical_points(scene, false);
    const auto is_static = [](const CriticalPoint& point) { return point.kind != CriticalKind::flutter; };
    found.erase(std::remove_if(found.begin(), found.end(), is_static), found.end());
    ASSERT_EQ(found.size(), damping > 0.0 ? 1u : 0u);
    for (const CriticalPoint& point : found) EXPECT_NEAR(point.load_factor, 0.5, 0.5 * kShear);
  }
}

TEST(Flutter, DeadLoadsBuckleInPlaceOfIt) {
  const std::vector<CriticalPoint> found = critical_points(column(3.0, LoadFrame::dead));
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].kind, CriticalKind::bifurcation);  // at pi^2 / 4
}

}  // namespace
}  // namespace mixbeam::test::flutter_test
