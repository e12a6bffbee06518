// Pure bending to a double circle: what is exact, and how fast the rest converges. (Humer, Steinbrecher, Pechstein,
// roll-up.)
#include "kernels/math/gauss.hpp"
#include "tests/support/solve.hpp"

namespace mixbeam::test::rollup_test {
namespace {

constexpr double kExact = 1e-12;
// For exact positions: with the default of 1e-11 a mesh may stop one iteration before round-off, 5e-12 off. The
// round-off of the stiffest rod is 1.2e-12.
constexpr double kTightResidual = 3e-13, kTightResidualOfStiff = 3e-12, kStiff = 1e4;
constexpr double kCurvature = 4.0 * kPi;  // of the rod of unit length

Vec3<double> on_circle(double s) {
  return {{std::sin(kCurvature * s) / kCurvature, (1.0 - std::cos(kCurvature * s)) / kCurvature, 0.0}};
}

/// The chord of an element is its tangent integrated with `points` Gauss points; over that of the circle.
double chord_ratio(int points, double half_angle) {
  std::vector<double> xi(points), weight(points);
  gauss_rule(points, xi.data(), weight.data());
  double chord = 0.0;
  for (int q = 0; q < points; ++q) chord += 0.5 * weight[q] * std::cos(xi[q] * half_angle);
  return chord * half_angle / std::sin(half_angle);
}

/// `ratio`: of the circle's radius to that of the closed form.
void expect_on_circle(const Simulation& rod, double ratio) {
  const int elements = rod.model().mesh().vertices() - 1;
  for (int v = 0; v <= elements; ++v) {
    const double s = static_cast<double>(v) / elements;
    const Vec3<double> expected = ratio * on_circle(s);
    const auto motion = vertex_motion(rod.model(), rod.state(), v);
    EXPECT_TRUE(agrees({s + motion[0], motion[1], motion[2]}, {expected[0], expected[1], 0.0}, kExact))
        << "vertex " << v << " of " << elements;
    EXPECT_NEAR(std::remainder(motion[5] - kCurvature * s, 2.0 * kPi), 0.0, kExact)
        << "vertex " << v << " of " << elements;
  }
  EXPECT_TRUE(agrees(rod.position("tip"), {0, 0, 0}, kExact));
}

// Rotations of the vertices are exact at every order. Their positions lie on a circle whose radius is that of the Gauss
// rule: the error is of order 2k, and vanishes after whole turns.
TEST(Rollup, VerticesLieOnACircle) {
  SolverParameters tight;
  for (double slenderness : {10.0, 1e3, 1e6}) {
    tight.newton.residual_tolerance = slenderness < kStiff ? kTightResidual : kTightResidualOfStiff;
    for (int order = 1; order <= 8; ++order)
      for (int elements : {8, 12}) {
        SCOPED_TRACE("slenderness " + std::to_string(slenderness) + ", order " + std::to_string(order));
        for (const Simulation& rod : solved_in_plane_and_in_space(rollup(slenderness, order, elements), tight))
          expect_on_circle(rod, chord_ratio(order, 0.5 * kCurvature / elements));
      }
  }
}

double position_error(double slenderness, int order, int elements,
                      ForceIntegration rule = ForceIntegration::both_reduced) {
  Scene scene = rollup(slenderness, order, elements);
  scene.members[0].force_integration = rule;
  const auto error = [](const PointSample& p, int) { return p.position - on_circle(p.arc_length); };
  return solved(scene).l2_norm(order + 4, error);
}

// Errors at 32 elements measured with another program, all of whose derivatives come from automatic differentiation.
TEST(Rollup, ErrorBetweenVertices) {
  constexpr double kPrintedDigits = 0.01;  // three
  const double of_other_program[] = {8.59e-4, 2.77e-5, 6.28e-7, 1.19e-8, 1.90e-10, 2.63e-12};
  for (double slenderness : {10.0, 1e3})
    for (int order = 1; order <= 6; ++order) {
      const double expected = of_other_program[order - 1];
      EXPECT_NEAR(position_error(slenderness, order, 32), expected, kPrintedDigits * expected)
          << "slenderness " << slenderness << ", order " << order;
    }
}

// The paper: reducing the axial part cures even orders, the shear part order three; order one never locks.
TEST(Rollup, LockingFollowsThePattern) {
  constexpr int kCoarse = 16;
  constexpr double kSlender = 1e3, kLocked = 100.0, kCured = 10.0;
  const auto growth = [&](int order, ForceIntegration rule) {
    return position_error(kSlender, order, kCoarse, rule) / position_error(kSlender, order, kCoarse);
  };
  for (ForceIntegration rule :
       {ForceIntegration::full, ForceIntegration::axial_reduced, ForceIntegration::shear_reduced})
    EXPECT_LT(growth(1, rule), kCured) << static_cast<int>(rule);
  for (int order : {2, 4}) {
    EXPECT_LT(growth(order, ForceIntegration::axial_reduced), kCured) << order;
    EXPECT_GT(growth(order, ForceIntegration::shear_reduced), kLocked) << order;
    EXPECT_GT(growth(order, ForceIntegration::full), kLocked) << order;
  }
  EXPECT_GT(growth(3, ForceIntegration::axial_reduced), kLocked);
  EXPECT_LT(growth(3, ForceIntegration::shear_reduced), kCured);
}

}  // namespace
}  // namespace mixbeam::test::rollup_test
