// Strains without stress: what a free member does, and what a held one feels.
#include "kernels/math/gauss.hpp"
#include "tests/support/solve.hpp"

namespace mixbeam::test::eigenstrains_test {
namespace {

constexpr double kLength = 2.0, kBending = 3.0, kTorsion = 5.0, kShear = 700.0, kAxial = 1100.0;

// A free member goes to its shape without stress by increments that are exact up to rounding.
constexpr double kRounding = 1e-12;
// Solved to a scaled residual of 1e-11 at most.
constexpr double kSolved = 1e-10;

Scene with_eigenstrain(int order, int elements, const Vector3& strain, const Vector3& curvature) {
  Scene scene = cantilever(section(kAxial, kShear, kTorsion, kBending), kLength, order, elements);
  scene.eigenstrains = {{"beam", strain, curvature}};
  return scene;
}

/// Largest |component| of N and of M at the middle of any element.
double largest_stress(const Simulation& beam) {
  const Model& model = beam.model();
  double largest = 0.0;
  for (int e = 0; e < static_cast<int>(model.mesh().elements.size()); ++e) {
    const PointSample p = sample_element(model.structure(), model.mesh(), beam.state(), e, 0.0);
    for (int i = 0; i < 3; ++i) largest = std::max({largest, std::abs(p.force[i]), std::abs(p.moment[i])});
  }
  return largest;
}

TEST(Eigenstrains, FreeMemberElongatesWithoutStress) {
  constexpr double kStrain = 0.3;
  for (int order : {1, 2, 4}) {
    const Simulation beam = solved(with_eigenstrain(order, 3, {kStrain, 0, 0}, {}));
    EXPECT_TRUE(agrees(beam.displacement("tip"), {kStrain * kLength, 0, 0}, kRounding)) << order;
    EXPECT_LE(largest_stress(beam), kRounding * kAxial) << order;
  }
}

TEST(Eigenstrains, ShearWithoutStress) {
  const Simulation beam = solved(with_eigenstrain(2, 3, {0, 0.1, -0.2}, {}));
  EXPECT_TRUE(agrees(beam.displacement("tip"), {0, 0.1 * kLength, -0.2 * kLength}, kRounding));
  EXPECT_TRUE(agrees(beam.rotation("tip"), {0, 0, 0}, kRounding));
}

// Between two walls: N = -EA eps, nothing moves.
TEST(Eigenstrains, HeldMemberIsCompressed) {
  for (double strain : {1e-6, 1e-3, 0.1})
    for (int order : {1, 2, 4}) {
      Scene scene = with_eigenstrain(order, 4, {strain, 0, 0}, {});
      scene.sections[0].bending_stiffness = {kAxial, kAxial};  // below its buckling load
      scene.supports.push_back(clamp("tip"));
      const Simulation beam = solved(scene);
      for (int e = 0; e < 4; ++e) {
        const PointSample p = sample_element(beam.model().structure(), beam.model().mesh(), beam.state(), e, 0.3);
        EXPECT_NEAR(p.force[0], -kAxial * strain, kSolved * kAxial * strain) << order << ", element " << e;
      }
    }
}

// Growth that varies along a held member: N is constant, -EA times its mean, here of 0.1 (s/L)^2.
TEST(Eigenstrains, HeldMemberTakesTheMeanStrain) {
  Scene scene = with_eigenstrain(3, 4, {}, {});
  scene.eigenstrains[0].strain_formula[0] = "0.1 * x^2";
  scene.supports.push_back(clamp("tip"));
  scene.sections[0].bending_stiffness = {kAxial, kAxial};
  const Simulation beam = solved(scene);
  const PointSample p = sample_element(beam.model().structure(), beam.model().mesh(), beam.state(), 1, 0.0);
  EXPECT_NEAR(p.force[0], -kAxial * 0.1 / 3.0, kSolved * kAxial);
}

/// The tip of a member from the origin along e1 whose triads are exp(s curvature): sum of its tangents at the Gauss
/// points of the force strain, which is all that the element knows of the centerline.
Vector3 tip_of_constant_curvature(const Vector3& curvature, int order, int elements) {
  std::vector<double> xi(order), weight(order);
  gauss_rule(order, xi.data(), weight.data());
  const double h = kLength / elements;
  Vector3 tip{};
  for (int e = 0; e < elements; ++e)
    for (int q = 0; q < order; ++q) {
      const double s = h * (e + 0.5 * (1.0 + xi[q]));
      const Vec3<double> turn = s * Vec3<double>{{curvature[0], curvature[1], curvature[2]}};
      const Vec3<double> tangent = exp_matrix(turn) * Vec3<double>{{1, 0, 0}};
      for (int i = 0; i < 3; ++i) tip[i] += 0.5 * h * weight[q] * tangent[i];
    }
  return tip;
}

// A straight member rolls up to its eigencurvature, to arcs, to more than a circle, and to a helix, and feels nothing.
TEST(Eigenstrains, FreeMemberRollsUpWithoutStress) {
  constexpr int kElements = 8;
  for (const Vector3& curvature :
       {Vector3{0, 0, 2.0 * kPi / kLength}, Vector3{0, 1.0, 0}, Vector3{0, 0, -7.0}, Vector3{1.5, 0.5, 2.0}})
    for (int order : {2, 3, 4}) {
      const Simulation beam = solved(with_eigenstrain(order, kElements, {}, curvature));
      EXPECT_LE(largest_stress(beam), 1e-10 * kAxial) << order;
      EXPECT_TRUE(
          agrees(beam.position("tip"), tip_of_constant_curvature(curvature, order, kElements), kRounding * kLength))
          << order;
    }
}

// A whole turn closes at any order: by symmetry, the polygon of the elements does.
TEST(Eigenstrains, FreeMemberBecomesARing) {
  for (int order : {1, 2, 3, 4, 8}) {
    const Simulation beam = solved(with_eigenstrain(order, 8, {}, {0, 0, 2.0 * kPi / kLength}));
    EXPECT_TRUE(agrees(beam.position("tip"), {0, 0, 0}, kRounding * kLength)) << order;
  }
}

// The same shape in any thickness: nothing resists, so nothing can lock.
TEST(Eigenstrains, RollUpOfThinMembers) {
  for (double slenderness : {10.0, 1000.0, 1e5}) {
    Scene scene = rollup(slenderness, 3, 8);
    scene.point_loads.clear();
    scene.eigenstrains = {{"beam", {}, {0, 0, 2.0 * kPi}}};
    const Simulation beam = solved(scene);
    EXPECT_TRUE(agrees(beam.position("tip"), {0, 0, 0}, 10.0 * kRounding)) << slenderness;
  }
}

// Eigencurvature of the undeformed shape's opposite: an arc becomes straight.
TEST(Eigenstrains, ArcStraightens) {
  Scene scene = arc_segment(section(kAxial, kShear, kTorsion, kBending), 0.0, 1.0, 4, 8);
  scene.point_loads.clear();
  scene.eigenstrains = {{"arc", {}, {0, 0, -1.0 / 100.0}}};
  const Simulation beam = solved(scene);
  EXPECT_TRUE(agrees_relatively(beam.position("tip"), {100.0 * kPi / 4.0, 0, 0}, kRounding));
}

// A clamped-clamped member that wants to bend stays straight: M = -EI kappa.
TEST(Eigenstrains, HeldMemberFeelsTheMoment) {
  Scene scene = with_eigenstrain(2, 4, {}, {0.1, 0.2, -0.3});
  scene.supports.push_back(clamp("tip"));
  const Simulation beam = solved(scene);
  const PointSample p = sample_element(beam.model().structure(), beam.model().mesh(), beam.state(), 2, 0.0);
  EXPECT_TRUE(
      agrees({p.moment[0], p.moment[1], p.moment[2]}, {-0.1 * kTorsion, -0.2 * kBending, 0.3 * kBending}, kSolved));
  EXPECT_TRUE(agrees(beam.displacement("tip"), {0, 0, 0}, kSolved));
}

// Linear curvature kappa = c s: the angle is c s^2 / 2, the centerline its integral (a clothoid).
TEST(Eigenstrains, VaryingCurvatureGivesAClothoid) {
  constexpr double kRate = 1.5;
  Scene scene = with_eigenstrain(4, 16, {}, {});
  scene.eigenstrains[0].curvature_formula[2] = "1.5 * s";
  const Simulation beam = solved(scene);
  const Vector3 tip = point_of_curve(kLength, [](double s) { return 0.5 * kRate * s * s; });
  EXPECT_TRUE(agrees(beam.rotation("tip"), {0, 0, 0.5 * kRate * kLength * kLength}, kSolved));
  EXPECT_TRUE(agrees(beam.position("tip"), tip, kSolved));
}

}  // namespace
}  // namespace mixbeam::test::eigenstrains_test
