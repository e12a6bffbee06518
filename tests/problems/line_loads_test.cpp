// Cantilevers under loads per length: closed forms and equilibrium.
#include "kernels/math/constants.hpp"
#include "kernels/math/gauss.hpp"
#include "kernels/math/rotation.hpp"
#include "tests/support/solve.hpp"

namespace mixbeam::test::line_loads_test {
namespace {

constexpr double kLength = 2.0, kBending = 3.0, kTorsion = 5.0, kShear = 7.0, kAxial = 11.0;

// Loads of this size deflect by about their own size. Deflections deviate from linear theory by the square of it, what
// follows from the deflection (the tip moves back, too) by its first power.
constexpr double kSmallLoad = 1e-6;
constexpr double kLinear = 1e-9;

// Solved to a scaled residual of 1e-11 at most.
constexpr double kSolved = 1e-10;

Section flexible() { return section(kAxial, kShear, kTorsion, kBending); }

Scene line_loaded(const Vector3& force, const Vector3& couple, int order = 2) {
  Scene scene = cantilever(flexible(), kLength, order, 4);
  scene.distributed_loads = {{"beam", force, couple, 1}};
  return scene;
}

TEST(LineLoads, SmallTransverseForceFollowsTimoshenko) {
  const double q = kSmallLoad, L = kLength;
  const double deflection = q * L * L * L * L / (8.0 * kBending) + q * L * L / (2.0 * kShear);
  const double rotation = q * L * L * L / (6.0 * kBending);
  for (int order : {2, 3, 4}) {
    const Simulation in_plane = solved(line_loaded({0, q, 0}, {}, order));
    EXPECT_NEAR(in_plane.displacement("tip")[1], deflection, kLinear * deflection) << order;
    EXPECT_TRUE(agrees_relatively(in_plane.rotation("tip"), {0, 0, rotation}, kLinear)) << order;
    const Simulation out_of_plane = solved(line_loaded({0, 0, q}, {}, order));
    EXPECT_NEAR(out_of_plane.displacement("tip")[2], deflection, kLinear * deflection) << order;
    EXPECT_TRUE(agrees_relatively(out_of_plane.rotation("tip"), {0, -rotation, 0}, kLinear)) << order;
  }
}

TEST(LineLoads, AxialForceAndTorque) {
  // both linear at any size: u = q L^2 / 2 EA, angle = c L^2 / 2 GIt
  const Simulation beam = solved(line_loaded({0.3, 0, 0}, {0.8, 0, 0}));
  EXPECT_TRUE(agrees(beam.displacement("tip"), {0.3 * kLength * kLength / (2.0 * kAxial), 0, 0}, kSolved));
  EXPECT_TRUE(agrees(beam.rotation("tip"), {0.8 * kLength * kLength / (2.0 * kTorsion), 0, 0}, kSolved));
}

// A dead couple about e3 bends in the plane with the moment c (L - s) whatever the shape: the angle is c (L s - s^2 /
// 2) / EI, the centerline its integral.
TEST(LineLoads, LargeCoupleGivesAClothoid) {
  constexpr double kCouple = 4.5;  // tip angle 3
  Scene scene = line_loaded({}, {0, 0, kCouple}, 4);
  scene.members[0].elements = 32;
  const Simulation beam = solved(scene);
  const Vector3 tip =
      point_of_curve(kLength, [](double s) { return kCouple * (kLength * s - 0.5 * s * s) / kBending; });
  EXPECT_TRUE(agrees(beam.position("tip"), tip, kSolved));
  EXPECT_TRUE(agrees(beam.rotation("tip"), {0, 0, kCouple * kLength * kLength / (2.0 * kBending)}, kSolved));
}

// The spatial force at the Gauss points carries what acts beyond them, for large deformation, too.
TEST(LineLoads, ForcesAreInEquilibriumAtGaussPoints) {
  const Vector3 q = {-1.0, 2.0, 3.0}, tip = {0.5, -1.0, 2.0};
  for (int order : {1, 2, 4}) {
    Scene scene = line_loaded(q, {0.5, 0, 0.5}, order);
    scene.point_loads = {dead_load("tip", tip)};
    const Simulation beam = solved(scene);
    std::vector<double> xi(order), weight(order);
    gauss_rule(order, xi.data(), weight.data());
    const Model& model = beam.model();
    for (int e = 0; e < 4; ++e)
      for (double x : xi) {
        const PointSample p = sample_element(model.structure(), model.mesh(), beam.state(), e, x);
        const Vec3<double> n = rotation_matrix(p.triad) * p.force;
        const double beyond = kLength - p.arc_length;
        EXPECT_TRUE(agrees({n[0], n[1], n[2]}, {tip[0] + beyond * q[0], tip[1] + beyond * q[1], tip[2] + beyond * q[2]},
                           kSolved * 10))
            << "order " << order << ", element " << e;
      }
  }
}

// Beyond a place the load that a formula gives must be carried there, for large deformation, too: the last vertex
// before the tip sees the rest of a load that grows with the square of s.
TEST(LineLoads, FormulasOfPositionCarryTheirIntegral) {
  Scene scene = line_loaded({0, 0, 0}, {}, 3);
  scene.distributed_loads[0].force_formula = {"", "1.5 * s^2", "-2 * x"};
  const Simulation beam = solved(scene);
  const Vector3 reaction = beam.reactions()[0].force, total = {0, 1.5 * kLength * kLength * kLength / 3.0, -kLength};
  EXPECT_TRUE(agrees(reaction, {0, -total[1], -total[2]}, kSolved));
  EXPECT_LE(beam.balance().force_error, kSolved);
  EXPECT_LE(beam.balance().moment_error, kSolved);
}

TEST(LineLoads, ConstantFormulaIsTheConstant) {
  Scene formula = line_loaded({}, {}, 2);
  formula.distributed_loads[0].force_formula = {"0.3", "sqrt(4)", "-1 + 0 * s"};
  formula.distributed_loads[0].couple_formula = {"", "", "0.5"};
  const Vector3 expected = solved(line_loaded({0.3, 2, -1}, {0, 0, 0.5}, 2)).position("tip");
  EXPECT_TRUE(agrees(solved(formula).position("tip"), expected, kSolved));
}

// Euler and Bernoulli with Timoshenko's shear under q0 (1 - x): tip q0 L^4 / 30 EI + q0 L^2 / 6 GA (tables of beams).
TEST(LineLoads, SmallTriangularForceFollowsTimoshenko) {
  const double q = kSmallLoad, L = kLength;
  Scene scene = line_loaded({}, {}, 4);
  scene.distributed_loads[0].force_formula[1] = "1e-6 * (1 - x)";
  const double deflection = q * L * L * L * L / (30.0 * kBending) + q * L * L / (6.0 * kShear);
  EXPECT_NEAR(solved(scene).displacement("tip")[1], deflection, kLinear * deflection);
}

/// Point loads spread over less than the distance of Gauss points: F at a, with the variance of where it acts. In
/// linear theory the tip moves by F (a^2 (3 L - a) + 3 variance (L - a)) / 6 EI + F a / GA. Sums over Gauss points
/// alone are zero or twice as much.
TEST(LineLoads, NarrowFormulasCarryTheirIntegral) {
  constexpr double kNarrow = 1e-7;  // formulas are resolved to 1e-9
  const double L = kLength, a = 0.503 * L, w = 1e-4 * L;
  struct Case {
    std::string formula;
    double force, variance;
  };
  const std::vector<Case> cases = {{"exp(-((x - 0.503) / 1e-4)^2)", w * std::sqrt(kPi), w * w / 2.0},
                                   {"abs(x - 0.503) < 0.5e-4 ? 1 : 0", w, w * w / 12.0},
                                   {"max(0, 1 - abs(s - 1.006) / 1e-4)", w / 2.0, w * w / 24.0}};
  for (const Case& narrow : cases) {
    const double F = kSmallLoad * narrow.force;
    const double deflection =
        F * (a * a * (3.0 * L - a) + 3.0 * narrow.variance * (L - a)) / (6.0 * kBending) + F * a / kShear;
    for (const int order : {3, 5}) {
      Scene scene = line_loaded({}, {}, order);
      scene.distributed_loads[0].force_formula[1] = "1e-6 * (" + narrow.formula + ")";
      EXPECT_NEAR(solved(scene).displacement("tip")[1], deflection, kNarrow * deflection) << narrow.formula;
    }
  }
}

TEST(LineLoads, FormulaThatIsNotFiniteIsAnError) {
  Scene scene = line_loaded({}, {}, 2);
  scene.distributed_loads[0].force_formula[0] = "1 / (x - x)";
  EXPECT_THROW(solved(scene), std::invalid_argument);
}

// An amplitude of one's own: at t = 1 a third of the load acts.
TEST(LineLoads, AmplitudeScalesTheLoad) {
  Scene scene = line_loaded({0.3, 0, 0}, {}, 2);
  scene.distributed_loads[0].amplitude = "t^2 / 3";
  EXPECT_TRUE(agrees(solved(scene).displacement("tip"), {0.1 * kLength * kLength / (2.0 * kAxial), 0, 0}, kSolved));
}

}  // namespace
}  // namespace mixbeam::test::line_loads_test
