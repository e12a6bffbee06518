// Values from outside the paper. Where no other source is named they were computed with an independent method: shooting
// on the ordinary differential equations of the rod with Runge-Kutta 7(8), no finite elements, step doubling changes
// less than 1e-10. All meshes: 64 elements of order 4 or fewer.
#include "tests/support/solve.hpp"

namespace mixbeam::test::reference_values_test {
namespace {

constexpr double kRelative = 1e-8;  // a hundred times the stated accuracy of the references

TEST(ReferenceValues, ElasticaUnderDeadTipForce) {
  // F L^2 / EI: v / L, u / L, tip angle; inextensible and shear-rigid, from elliptic integrals
  struct Row {
    double alpha, v, u, angle;
  };
  const std::vector<Row> rows = {{1, 0.30172077379981, 0.0564332362834, 0.46135194971188},
                                 {10, 0.8106090248803, 0.5549955977538, 1.4302855388039},
                                 {100, 0.94142135086201, 0.8585786445629, 1.57064588466}};
  for (const Row& row : rows) {
    for (const Simulation& beam : solved_in_plane_and_in_space(elastica(row.alpha, 4, 32))) {
      EXPECT_TRUE(agrees_relatively(beam.displacement("tip"), {-row.u, row.v, 0}, kRelative)) << row.alpha;
      EXPECT_TRUE(agrees_relatively(beam.rotation("tip"), {0, 0, row.angle}, kRelative)) << row.alpha;
    }
  }
}

// For a given force the tip is the start of an initial value problem, so there is one equilibrium only.
TEST(ReferenceValues, ElasticaUnderFollowerTipForce) {
  struct Row {
    double alpha;
    Vector3 displacement;
    double angle;
  };
  const std::vector<Row> rows = {{1, {-0.064354330519, 0.320641994675, 0}, 0.495884642423},
                                 {10, {-1.092123181189, 0.546983264594, 0}, 2.992714816235},
                                 {30, {-0.523858762869, -0.201690840109, 0}, 1.690857711106}};
  for (const Row& row : rows) {
    Scene scene = cantilever(section(kRigid, kRigid, 1.0, 1.0), 1.0, 4, 32);
    scene.point_loads = {follower_load("tip", "beam", {0, row.alpha, 0})};
    for (const Simulation& beam : solved_in_plane_and_in_space(scene)) {
      EXPECT_TRUE(agrees_relatively(beam.displacement("tip"), row.displacement, kRelative)) << row.alpha;
      EXPECT_TRUE(agrees_relatively(beam.rotation("tip"), {0, 0, row.angle}, kRelative)) << row.alpha;
    }
  }
}

TEST(ReferenceValues, FollowerForceThatTurnsTheTipByHalfATurn) {
  constexpr double kAlpha = 13.7503716;  // 4 K(1/sqrt 2)^2
  constexpr double kDigits = 1e-8;       // angle: the printed digits of alpha times the slope of the angle, below 0.2
  Scene scene = cantilever(section(kRigid, kRigid, 1.0, 1.0), 1.0, 4, 32);
  scene.point_loads = {follower_load("tip", "beam", {0, kAlpha, 0})};
  EXPECT_NEAR(std::abs(solved(scene).rotation("tip")[2]), kPi, kDigits);
}

constexpr double kArcAxial = 1e7, kArcShear = 5e6, kArcBending = 1e7 / 12.0;

TEST(ReferenceValues, Arcs) {
  struct Row {
    Section section;
    double force;
    Vector3 displacement;
  };
  const auto of = [](double axial, double shear) { return section(axial, shear, kArcBending, kArcBending); };
  for (const Row& row : {Row{of(kArcAxial, kArcShear), 600.0, {-23.560239545026, 13.604521347307, 53.474858791825}},
                         {of(kArcAxial, kArcShear), 3000.0, {-47.686369893902, 25.056445964830, 68.539089493083}},
                         {of(kArcAxial, kRigid), 600.0, {-23.558527901019, 13.603966104681, 53.471762953030}},
                         {of(kRigid, kRigid), 600.0, {-23.559383718350, 13.604243719187, 53.468598442323}},
                         {arc_section(10), arc_force(10), {-23.645012476468, 13.632073912208, 54.095027011161}},
                         {arc_section(1e4), arc_force(1e4), {-23.559383803932, 13.604243746950, 53.468599068354}}})
    EXPECT_TRUE(agrees_relatively(solved(arc_segment(row.section, row.force, -1.0, 4, 16)).displacement("tip"),
                                  row.displacement, kRelative))
        << row.section.axial_stiffness << ", force " << row.force;
}

}  // namespace
}  // namespace mixbeam::test::reference_values_test
