// The ends of the range of numbers: rigid beside soft, short beside long, many elements, angles of nothing and of pi.
// Wherever a limit exists the answer must approach it at the rate of theory, in as many iterations.
#include "tests/support/solve.hpp"

namespace mixbeam::test {
namespace {

// One of them because the first increment of a rigid structure is its prediction, which is no iteration.
constexpr int kIterationsApart = 3;

// Two solutions to a scaled residual of 1e-11, compared.
constexpr double kRoundOff = 1e-10;

int iterations(const Simulation& simulation) { return simulation.result().newton_iterations; }

void expect_one_step_with(int expected, const Simulation& simulation, const std::string& what) {
  EXPECT_EQ(simulation.result().steps, 1) << what;
  EXPECT_NEAR(iterations(simulation), expected, kIterationsApart) << what;
}

Scene elastica(const Section& strip, int order, int elements) {
  Scene scene = cantilever(strip, 1.0, order, elements);
  scene.point_loads = {dead_load("tip", {0, -10.0, 0})};
  return scene;
}

Scene l_frame(const Section& rod) {
  Scene scene = slope_discontinuity(2, 8);
  scene.sections = {rod};
  return scene;
}

/// A bar of two sections between two walls, pushed where they meet.
constexpr double kPush = 1.0;
Simulation pushed_bar(double left_stiffness, double right_stiffness) {
  Scene scene = structure({{"wall", {0, 0, 0}}, {"middle", {0.5, 0, 0}}, {"other wall", {1, 0, 0}}},
                          {line("left", "wall", "middle", 2, 4), line("right", "middle", "other wall", 2, 4)},
                          {clamp("wall"), clamp("other wall")}, {dead_load("middle", {-kPush, 0, 0})},
                          section(left_stiffness, 0.5 * left_stiffness, 1.0, 1.0));
  scene.sections.push_back(section(right_stiffness, 0.5 * right_stiffness, 1.0, 1.0));
  scene.sections[1].name = scene.members[1].section = "other";
  return solved(scene);
}

// Closed form: springs EA/l side by side. Their ratio, not the cap of the tangent, must decide who carries what.
TEST(Extremes, RedundantBarsShareByStiffness) {
  constexpr double kShare = 1e-7;  // of a strain of 1e-12, whose rounding errors against one are 1e-4 of it
  for (double axial : {1e4, 1e6, 1e8, 1e10})
    for (double ratio : {1.0, 4.0, 100.0}) {
      const Simulation bar = pushed_bar(axial, ratio * axial);
      const double expected = -0.5 * kPush / (axial * (1.0 + ratio));
      EXPECT_LE(iterations(bar), 3) << axial << ", ratio " << ratio;
      EXPECT_EQ(bar.result().steps, 1) << axial << ", ratio " << ratio;
      EXPECT_NEAR(bar.displacement("middle")[0] / expected, 1.0, kShare) << axial << ", ratio " << ratio;
      if (ratio == 1.0) continue;
      const double shared_equally = -0.5 * kPush / (2.0 * axial);  // what a tangent with a cap would have
      EXPECT_GT(std::abs(bar.displacement("middle")[0] / shared_equally - 1.0), 0.1) << axial << ", ratio " << ratio;
    }
}

// Where the strains drown in their rounding errors the answer cannot be had, and the run says so.
TEST(Extremes, ForcesSharedByRoundingErrorsAreReported) {
  EXPECT_FALSE(pushed_bar(1e6, 4e6).uncertain_force().has_value());
  EXPECT_FALSE(pushed_bar(1e9, 4e9).uncertain_force().has_value());
  for (double axial : {1e13, 1e15}) {
    const std::optional<UncertainForce> force = pushed_bar(axial, 4.0 * axial).uncertain_force();
    ASSERT_TRUE(force.has_value()) << axial;
    EXPECT_FALSE(force->rigid) << axial;
    EXPECT_TRUE(force->member == "left" || force->member == "right") << force->member;
    EXPECT_GT(force->change, 1e-5) << axial;
    EXPECT_NE(text_of(*force).find("redundant"), std::string::npos);
  }
  const std::optional<UncertainForce> rigid = pushed_bar(kRigid, kRigid).uncertain_force();
  ASSERT_TRUE(rigid.has_value());
  EXPECT_TRUE(rigid->rigid);
}

// The same stiffness where equilibrium determines the forces: rounding errors of strains move nothing. With a spring at
// the free end the structure is redundant by one, but what decides is still how the strip bends.
TEST(Extremes, ForcesThatEquilibriumDeterminesAreCertain) {
  for (double stiffness : {1e13, 1e25, kRigid}) {
    Scene held = elastica(section(stiffness, stiffness, 1.0, 1.0), 2, 16);
    held.supports.push_back(Support());
    held.supports.back().point = "tip";
    held.supports.back().displacement_stiffness = {0.0, 0.5, 0.0};
    EXPECT_FALSE(solved(held).uncertain_force().has_value());
    EXPECT_FALSE(solved(elastica(section(stiffness, stiffness, 1.0, 1.0), 2, 16)).uncertain_force().has_value());
    EXPECT_FALSE(solved(l_frame(section(stiffness, stiffness, 1.0, 1.0))).uncertain_force().has_value());
  }
}

/// `stiffer` of GIt, EI2, EI3 multiplied.
Section stiffened(Section s, const std::array<bool, 3>& stiffer, double factor) {
  if (stiffer[0]) s.torsional_stiffness *= factor;
  for (int i = 0; i < 2; ++i)
    if (stiffer[i + 1]) s.bending_stiffness[i] *= factor;
  return s;
}

// Each difference to the rigid component is that at a factor of 1000, less by the ratio of the factors.
TEST(Extremes, NearlyRigidBendingAndTorsionTendToTheRigidOnes) {
  const Section arc_rod = section(1e6 / 12.0 * 1e3, 5e5 / 12.0 * 1e3, 1e7 / 12.0, 1e7 / 12.0);
  const Section frame_rod = section(1e7, 5e6, 100.0 / 12.0, 100.0 / 12.0);
  for (bool frame : {false, true})
    for (const std::array<bool, 3>& stiffer :
         std::vector<std::array<bool, 3>>{{true, false, false}, {false, true, false}, {false, true, true}}) {
      const auto make = [&](double factor) {
        return frame ? l_frame(stiffened(frame_rod, stiffer, factor))
                     : arc_segment(stiffened(arc_rod, stiffer, factor), 600.0, 1.0, 2, 8);
      };
      const Simulation rigid = solved(make(kRigid));
      const Vector3 limit = rigid.displacement("tip");
      const double at_thousand = distance(solved(make(1e3)).displacement("tip"), limit);
      for (double factor : {1e6, 1e9, 1e12}) {
        const Simulation stiff = solved(make(factor));
        const std::string what = std::string(frame ? "frame" : "arc") + ", factor " + std::to_string(factor);
        expect_one_step_with(iterations(rigid), stiff, what);
        constexpr double kRate = 0.01;
        EXPECT_NEAR(distance(stiff.displacement("tip"), limit), at_thousand * 1e3 / factor,
                    kRate * at_thousand * 1e3 / factor + kRoundOff * largest_component(limit))
            << what;
      }
    }
}

/// Two flexible members with one between them that is `factor` times as stiff in everything, alone or as one side of a
/// triangle of such members.
Simulation with_stiff_part(double factor, bool triangle) {
  Scene scene = structure({{"clamp", {0, 0, 0}}, {"a", {1, 0, 0}}, {"b", {2, 0, 0}}, {"tip", {3, 0, 0}}},
                          {line("1", "clamp", "a", 2, 4), line("3", "b", "tip", 2, 4), line("2", "a", "b", 2, 4)},
                          {clamp("clamp")}, {dead_load("tip", {0, -0.5, 0.3})}, section(1e6, 5e5, 1.0, 1.0));
  if (triangle) {
    scene.points.push_back({"c", {1.5, 0.5, 0}});
    scene.members.push_back(line("4", "a", "c", 2, 4));
    scene.members.push_back(line("5", "c", "b", 2, 4));
  }
  scene.sections.push_back(section(1e6 * factor, 5e5 * factor, factor, factor));
  scene.sections[1].name = "stiff";
  for (size_t i = 2; i < scene.members.size(); ++i) scene.members[i].section = "stiff";
  return solved(scene);
}

TEST(Extremes, RigidMembersBetweenFlexibleOnes) {
  for (bool triangle : {false, true}) {
    const Simulation rigid = with_stiff_part(kRigid, triangle);
    const Vector3 limit = rigid.displacement("tip");
    const double at_thousand = distance(with_stiff_part(1e3, triangle).displacement("tip"), limit);
    EXPECT_GT(at_thousand, 1e-5);
    for (double factor : {1e6, 1e9, 1e12}) {
      const Simulation stiff = with_stiff_part(factor, triangle);
      const std::string what = std::string(triangle ? "triangle" : "chain") + ", factor " + std::to_string(factor);
      expect_one_step_with(iterations(rigid), stiff, what);
      constexpr double kRate = 0.01;
      EXPECT_NEAR(distance(stiff.displacement("tip"), limit), at_thousand * 1e3 / factor,
                  kRate * at_thousand * 1e3 / factor + kRoundOff)
          << what;
    }
  }
  EXPECT_GT(
      distance(with_stiff_part(1.0, false).displacement("tip"), with_stiff_part(kRigid, false).displacement("tip")),
      0.1);  // what is compared does depend on the stiff part
}

// Nothing moves, and the clamp carries the load.
TEST(Extremes, RigidAltogether) {
  const Section rigid = section(kRigid, kRigid, kRigid, kRigid);
  const Simulation beam = solved(elastica(rigid, 2, 4));
  EXPECT_TRUE(agrees(beam.displacement("tip"), {0, 0, 0}, kRoundOff));
  const Reaction reaction = beam.reactions().front();
  EXPECT_TRUE(agrees(reaction.force, {0, 10.0, 0}, 10.0 * kRoundOff));
  EXPECT_TRUE(agrees(reaction.moment, {0, 0, 10.0}, 10.0 * kRoundOff));
  EXPECT_FALSE(agrees(reaction.moment, {0, 0, 10.0001}, 10.0 * kRoundOff));
}

/// The elastica with two elements of a length far below the others at one of its ends.
Scene graded_elastica(double ratio, bool at_clamp) {
  Scene scene = elastica(section(kRigid, kRigid, 1.0, 1.0), 4, 16);
  const double h = 2.0 / (16.0 * ratio);
  scene.points = {{"clamp", {0, 0, 0}}, {"joint", {at_clamp ? h : 1.0 - h, 0, 0}}, {"tip", {1, 0, 0}}};
  scene.members = {line("one", "clamp", "joint", 4, at_clamp ? 2 : 16),
                   line("two", "joint", "tip", 4, at_clamp ? 16 : 2)};
  return scene;
}

// Elliptic integrals, F L^2/EI = 10.
TEST(Extremes, ElementsOfVeryDifferentLength) {
  constexpr double kPrinted = 2e-12;
  const Vector3 expected = {kElasticaTip[0], -kElasticaTip[1], 0.0};
  const int equal = iterations(solved(graded_elastica(1.0, true)));
  for (double ratio : {1e2, 1e4, 1e6, 1e8})
    for (bool at_clamp : {true, false}) {
      const std::string what = "ratio " + std::to_string(ratio);
      for (const Simulation& strip : solved_in_plane_and_in_space(graded_elastica(ratio, at_clamp))) {
        expect_one_step_with(equal, strip, what);
        const Vector3 tip = strip.displacement("tip");
        EXPECT_TRUE(agrees(tip, expected, kRoundOff)) << what;
        EXPECT_FALSE(agrees(tip, {expected[0] + 2.0 * kRoundOff + kPrinted, expected[1], 0.0}, kRoundOff)) << what;
      }
    }
}

// The tip returns to the clamp whatever the number of elements.
TEST(Extremes, DoubleRollUpWithManyElements) {
  for (int elements : {3, 1000, 10000}) {
    const Simulation rod = solved(rollup(1e3, 1, elements));
    EXPECT_EQ(rod.result().steps, 1) << elements;
    EXPECT_LE(iterations(rod), 8) << elements;
    EXPECT_TRUE(agrees(rod.position("tip"), {0, 0, 0}, kRoundOff)) << elements;
  }
  Scene short_of_it = rollup(1e3, 1, 1000);
  short_of_it.point_loads[0].moment[2] *= 1.0 - 1e-9;
  EXPECT_FALSE(agrees(solved(short_of_it).position("tip"), {0, 0, 0}, kRoundOff));
}

// Pure bending is exact at every angle: an element turns by half of its share against each of its ends. A rod that
// turns by as much has passed critical points, which are not looked for: their iterations would be counted here.
TEST(Extremes, RelativeRotationsUpToPi) {
  SolverParameters without_stability;
  without_stability.analysis.stability = false;
  // A dead moment has no potential in space, where pairs of complex eigenvalues become real below zero: no reason to
  // look for critical points, but where a whole turn makes the tangent nearly symmetric again.
  const auto most_iterations = [](double short_of_pi) { return short_of_pi < 1e-3 ? 30 : 4; };
  for (double short_of_pi : {1e-1, 1e-3, 1e-6})
    for (int elements : {1, 2})
      for (int order : {1, 2}) {
        Scene scene = cantilever(rollup_section(1e3), 1.0, order, elements);
        const double angle = 2.0 * kPi * (1.0 - short_of_pi) * elements;
        scene.point_loads = {dead_load("tip", {}, {0, 0, angle})};
        SCOPED_TRACE(std::to_string(short_of_pi) + " short of pi");
        for (const Simulation& rod : solved_in_plane_and_in_space(scene, without_stability)) {
          EXPECT_LE(iterations(rod), most_iterations(short_of_pi));
          EXPECT_NEAR(std::remainder(rod.rotation("tip")[2] - angle, 2.0 * kPi), 0.0, kRoundOff);
          EXPECT_GT(std::abs(std::remainder(rod.rotation("tip")[2] - angle * (1.0 + 1e-8), 2.0 * kPi)), kRoundOff);
        }
      }
}

/// Elements that grow by one factor from the clamp to the tip; 1: a uniform mesh.
Scene tiny_tip_force(double force, double growth, const Section& rod) {
  constexpr int kElements = 24;
  Scene scene = cantilever(rod, 1.0, 4, kElements);
  if (growth != 1.0) {
    std::vector<double>& stations = scene.members[0].stations;
    for (int i = 0; i <= kElements; ++i)
      stations.push_back((std::pow(growth, i) - 1.0) / (std::pow(growth, kElements) - 1.0));
  }
  scene.point_loads = {dead_load("tip", {0, force, 0})};
  return scene;
}

// Linear theory: F L^3/3EI + F L/GA and F L^2/2EI, where the square of the load is less than rounding. The residual
// allows for rounding errors of strains that are as large as these strains themselves.
TEST(Extremes, TinyForcesGiveLinearTheory) {
  constexpr double kShare = 1e-8, kSmallestStiffness = 1e3;
  for (double force : {1e-12, 1e-10, 1e-8})
    for (double growth : {1.0, 1.1, 1.4})
      for (double stiffness : {kRigid, 1e9, kSmallestStiffness}) {
        const Simulation rod = solved(tiny_tip_force(force, growth, section(stiffness, stiffness, 1.0, 1.0)));
        const std::string what = "force " + std::to_string(std::log10(force)) + ", growth " + std::to_string(growth) +
                                 ", stiffness " + std::to_string(stiffness);
        EXPECT_NEAR(rod.displacement("tip")[1] / force, 1.0 / 3.0 + 1.0 / stiffness, kShare / 3.0) << what;
        EXPECT_NEAR(rod.rotation("tip")[2] / force, 0.5, kShare / 2.0) << what;
        EXPECT_LE(iterations(rod), 3) << what;
        const double without_shear = 1.0 / 3.0;  // the twin: shear flexibility is seen, as that of the cap was
        if (stiffness == kSmallestStiffness) {
          EXPECT_GT(std::abs(rod.displacement("tip")[1] / force - without_shear), kShare / 3.0) << what;
        }
      }
}

// A tangent with a cap that no one looks at ends with its first increment (predictions, which lack the cap, apart).
TEST(Extremes, TinyForcesNeedALookAtTheCap) {
  SolverParameters residual_only;
  residual_only.load_path.method = LoadPathMethod::fixed;
  residual_only.status_tests = Teuchos::rcp(new Teuchos::ParameterList("Status Tests"));
  Teuchos::ParameterList& tests = *residual_only.status_tests;
  tests.set("Test Type", "NormF").set("Norm Type", "Max Norm").set("Scale Type", "Unscaled").set("Tolerance", 1e-11);
  const Simulation rod = solved(tiny_tip_force(1e-12, 1.4, section(kRigid, kRigid, 1.0, 1.0)), residual_only);
  EXPECT_GT(std::abs(rod.displacement("tip")[1] / 1e-12 - 1.0 / 3.0), 1e-6);
}

TEST(Extremes, TinyAngles) {
  for (double angle : {0.0, 1e-300, 1e-100, 1e-16, 1e-8, 1e-4}) {
    Scene scene = cantilever(rollup_section(1e3), 1.0, 2, 8);
    scene.point_loads = {dead_load("tip", {}, {0, 0, angle})};
    const Simulation rod = solved(scene);
    const double deflection = angle == 0.0 ? 0.0 : (1.0 - std::cos(angle)) / angle;  // of the circle
    const double exact = angle < 1e-6 ? 0.5 * angle : deflection;                    // the cosine loses its digits
    EXPECT_NEAR(rod.rotation("tip")[2], angle, kRoundOff * angle) << angle;
    EXPECT_NEAR(rod.displacement("tip")[1], exact, 1e-7 * exact) << angle;
    if (angle == 0.0) continue;
    EXPECT_GT(std::abs(rod.rotation("tip")[2] - angle * (1.0 + 1e-9)), kRoundOff * angle) << angle;
  }
}

}  // namespace
}  // namespace mixbeam::test
