// From the section of a scene to its compliance: matrices, rigid components, tapers, and what is rejected.
#include "discretization/scene/section_law.hpp"

#include "discretization/mesh/structure.hpp"
#include "discretization/scene/section_shape.hpp"
#include "discretization/text/errors.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/text.hpp"

#include <stdexcept>

namespace mixbeam::test {
namespace {

constexpr double kRoundings = 1e-14;  // relative; the matrices below have condition numbers of about 10 when scaled

/// Coupled in pairs and across, far from singular.
Section coupled_section() {
  Section s = section(1e6, 4e5, 2e3, 3e3);
  s.matrix = Matrix6{{{1e6, 2e4, 0, 5e3, 0, -8e3},
                      {2e4, 4e5, 3e4, 0, 6e3, 0},
                      {0, 3e4, 4e5, -4e3, 0, 2e3},
                      {5e3, 0, -4e3, 2e3, 300, -100},
                      {0, 6e3, 0, 300, 3e3, 250},
                      {-8e3, 0, 2e3, -100, 250, 3e3}}};
  return s;
}

double root(const Matrix6& stiffness, int i) { return std::sqrt(stiffness[i][i]); }

/// Largest entry of C S - I over the given components, in units of the diagonal of C.
double error_of_inverse(const Matrix6& stiffness, const Matrix6& compliance, const std::vector<int>& components) {
  double largest = 0.0;
  for (int i : components)
    for (int j : components) {
      double sum = i == j ? -1.0 : 0.0;
      for (int k : components) sum += stiffness[i][k] * compliance[k][j];
      largest = std::max(largest, std::abs(sum) * root(stiffness, j) / root(stiffness, i));
    }
  return largest;
}

TEST(SectionCompliance, OfSixNumbersIsTheirInverse) {
  const Matrix6 s = section_compliance({"s", 2.0, {4.0, kRigid}, 8.0, {16.0, 32.0}});
  const double expected[6] = {0.5, 0.25, 0.0, 0.125, 0.0625, 0.03125};
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) EXPECT_EQ(s[i][j], i == j ? expected[i] : 0.0);
}

TEST(SectionCompliance, OfAMatrixIsItsInverse) {
  const Section s = coupled_section();
  const Matrix6 compliance = section_compliance(s);
  EXPECT_LE(error_of_inverse(*s.matrix, compliance, {0, 1, 2, 3, 4, 5}), kRoundings);
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) EXPECT_EQ(compliance[i][j], compliance[j][i]);
  // the twin that must fail
  Matrix6 other = *s.matrix;
  other[1][4] *= 1.0 + 1e-9;
  EXPECT_GT(error_of_inverse(other, compliance, {0, 1, 2, 3, 4, 5}), kRoundings);
}

/// Rigid components are those of the six numbers; what the matrix says there, and whether that makes sense, is ignored.
TEST(SectionCompliance, RigidComponentsLeaveTheInverseOfTheRest) {
  Section s = coupled_section();
  s.axial_stiffness = s.shear_stiffness[1] = kRigid;
  for (int i = 0; i < 6; ++i) (*s.matrix)[0][i] = -1.0;
  const Matrix6 compliance = section_compliance(s);
  EXPECT_LE(error_of_inverse(*s.matrix, compliance, {1, 3, 4, 5}), kRoundings);
  for (int i = 0; i < 6; ++i)
    for (int rigid : {0, 2}) EXPECT_TRUE(compliance[rigid][i] == 0.0 && compliance[i][rigid] == 0.0) << rigid << i;
}

TEST(SectionCompliance, RejectsWhatNoBodyHas) {
  const auto error = [](const Section& s) { return error_of<std::invalid_argument>([&] { section_compliance(s); }); };
  Section s = coupled_section();
  (*s.matrix)[3][1] = 1.0;
  expect_in(error(s), {"section \"section\"", "not symmetric", "GA2", "GIt"});
  s = coupled_section();
  (*s.matrix)[4][5] = (*s.matrix)[5][4] = 3000.001;
  expect_in(error(s), {"not positive definite"});
  (*s.matrix)[4][5] = (*s.matrix)[5][4] = 1500.0;
  EXPECT_EQ(error(s), "no error");
  for (const double value : {0.0, -1.0, kRigid, std::nan("")}) {
    s = coupled_section();
    (*s.matrix)[4][4] = value;
    expect_in(error(s), {"EI2"});
  }
  s = coupled_section();
  (*s.matrix)[0][5] = (*s.matrix)[5][0] = std::nan("");
  EXPECT_NE(error(s), "");
  for (const double value : {0.0, -1.0, std::nan("")}) expect_in(error(section(1, 1, value, 1)), {"GIt", "positive"});
}

/// The tests for symmetry and definiteness see no units.
TEST(SectionCompliance, InAnyUnits) {
  for (const double length : {1e-6, 1e6}) {
    Section s = coupled_section();
    Matrix6& c = *s.matrix;
    for (int i = 0; i < 6; ++i)
      for (int j = 0; j < 6; ++j) c[i][j] *= (i < 3 ? 1.0 : length) * (j < 3 ? 1.0 : length);
    EXPECT_LE(error_of_inverse(c, section_compliance(s), {0, 1, 2, 3, 4, 5}), kRoundings);
    const double coupled = std::sqrt(c[4][4] * c[5][5]);
    for (int i = 0; i < 4; ++i) c[i][4] = c[4][i] = c[i][5] = c[5][i] = 0.0;
    c[4][5] = c[5][4] = 0.999 * coupled;
    EXPECT_NO_THROW(section_compliance(s)) << length;
    c[4][5] = c[5][4] = 1.001 * coupled;
    EXPECT_THROW(section_compliance(s), std::invalid_argument) << length;
  }
}

Section round(const std::string& name, double diameter, double youngs_modulus) {
  SectionShape shape;
  shape.size2 = diameter;
  shape.youngs_modulus = youngs_modulus;
  shape.poisson_ratio = 0.25;
  return make_section(name, shape);
}

Scene tapered(const Section& start, const Section& end, const std::string& taper = "") {
  Scene scene = cantilever(start, 2.0, 2, 3);
  scene.sections[0].name = "section";
  scene.sections.push_back(end);
  scene.sections[1].name = "end";
  scene.members[0].end_section = "end";
  scene.members[0].taper = taper;
  return scene;
}

SectionLaw law_of(const Scene& scene) { return SectionLaw(scene, scene.members[0]); }

TEST(SectionLaw, ShapesOfOneKindInterpolateTheirDimensions) {
  const SectionLaw law = law_of(tapered(round("a", 0.4, 200.0), round("b", 0.2, 300.0)));
  for (const double x : {0.0, 0.25, 0.5, 1.0}) {
    const double d = 0.4 - 0.2 * x, e = 200.0 + 100.0 * x;
    const Matrix6 s = law.compliance(x);
    EXPECT_NEAR(s[0][0] * e * kPi * d * d / 4.0, 1.0, kRoundings);
    EXPECT_NEAR(s[4][4] * e * kPi * d * d * d * d / 64.0, 1.0, kRoundings);
    EXPECT_NEAR(s[3][3] * e / 2.5 * kPi * d * d * d * d / 32.0, 1.0, kRoundings);
  }
}

TEST(SectionLaw, BothWaysInterpolateTheDamping) {
  Section a = round("a", 0.4, 200.0), b = round("b", 0.2, 300.0);
  a.stiffness_damping = 0.01;
  a.mass_damping = 2.0;
  b.mass_damping = 4.0;
  for (int i = 0; i < 2; ++i) {
    const Section part = law_of(tapered(a, b)).section(0.25);
    EXPECT_NEAR(part.mass_damping, 2.5, kRoundings);
    EXPECT_NEAR(part.stiffness_damping, 0.0075, kRoundings);
    a.shape.reset();
  }
}

TEST(SectionLaw, OtherSectionsInterpolateTheirStiffness) {
  const Section a = coupled_section(), b = section(2e6, 1e5, 4e3, 5e3);
  const Section half = law_of(tapered(a, b)).section(0.5);
  EXPECT_EQ((*half.matrix)[0][0], 1.5e6);
  EXPECT_EQ((*half.matrix)[0][5], -4e3);
  EXPECT_EQ((*half.matrix)[5][5], 4e3);
}

TEST(SectionLaw, WeightIsAFormula) {
  const SectionLaw law = law_of(tapered(section(1, 1, 1, 1), section(5, 5, 5, 5), "x^2 * (3 - 2*x)"));
  EXPECT_NEAR(law.compliance(0.25)[4][4], 1.0 / (1.0 + 4.0 * 0.0625 * 2.5), kRoundings);
  EXPECT_EQ(law.compliance(0.0)[0][0], 1.0);
  EXPECT_EQ(law.compliance(1.0)[0][0], 0.2);
}

TEST(SectionLaw, RigidInBothStaysRigid) {
  Section a = round("a", 0.4, 200.0), b = round("b", 0.2, 200.0);
  a.axial_stiffness = b.axial_stiffness = a.shear_stiffness[0] = b.shear_stiffness[0] = kRigid;
  const Matrix6 s = law_of(tapered(a, b)).compliance(0.5);
  EXPECT_EQ(s[0][0], 0.0);
  EXPECT_EQ(s[1][1], 0.0);
  EXPECT_GT(s[2][2], 0.0);
}

TEST(SectionLaw, RejectsImpossibleTapers) {
  const auto error = [](const Scene& scene, double x) {
    return error_of<std::invalid_argument>([&] { law_of(scene).compliance(x); });
  };
  Section rigid = section(1, 1, 1, 1);
  rigid.axial_stiffness = kRigid;
  expect_in(error(tapered(section(1, 1, 1, 1), rigid), 0.5), {"\"section\" to \"end\"", "EA", "both or none"});
  Section corrected = round("b", 0.2, 200.0);
  corrected.shape->shear_correction[1] = 0.8;
  expect_in(error(tapered(round("a", 0.4, 200.0), corrected), 0.5), {"shear correction 3"});
  expect_in(error(tapered(section(1, 1, 1, 1), section(2, 2, 2, 2), "1/(x - 0.5)"), 0.5), {"not a finite number"});
  expect_in(error(tapered(section(2, 2, 2, 2), section(1, 1, 1, 1), "3*x"), 0.75), {"x = 0.75", "EA"});
  expect_in(error(tapered(section(1, 1, 1, 1), section(2, 2, 2, 2), "s"), 0.5), {"s"});
  EXPECT_EQ(error(tapered(section(2, 2, 2, 2), section(1, 1, 1, 1), "1.5*x"), 1.0), "no error");
}

/// What the user reads names the member.
TEST(SectionLaw, ErrorsOfAStructureAreInputErrors) {
  const auto error = [](const Scene& scene) {
    return error_of<InputError>([&] { build_structure(scene, build_mesh(scene), 0, 1); });
  };
  Scene scene = tapered(section(2, 2, 2, 2), section(1, 1, 1, 1));
  Member& beam = scene.members[0];
  EXPECT_EQ(error(scene), "no error");
  beam.taper = "4*x";
  expect_in(error(scene), {"member \"beam\"", "of the taper", "EA"});
  beam.taper = "x +";
  expect_in(error(scene), {"member \"beam\""});
  beam.taper = "", beam.end_section = "and";
  expect_in(error(scene), {"member \"beam\"", "no section named \"and\"", "\"end\""});
  beam.end_section = "end", beam.force_integration = ForceIntegration::full;
  expect_in(error(scene), {"member \"beam\"", "\"both reduced\""});
  beam.end_section = "";
  EXPECT_EQ(error(scene), "no error");
  scene.sections[0].matrix = Matrix6{};
  expect_in(error(scene), {"member \"beam\"", "\"both reduced\""});
  beam.force_integration = ForceIntegration::both_reduced;
  expect_in(error(scene), {"member \"beam\"", "section \"section\"", "EA"});
}

TEST(SectionLaw, PlainMembersCarryNone) {
  Scene scene = fork(2, 4);
  scene.sections.push_back(coupled_section());
  scene.sections.back().name = "coupled";
  scene.members[1].section = "coupled";
  const Structure structure = build_structure(scene, build_mesh(scene), 0, 1);
  ASSERT_EQ(structure.blocks.size(), 2u);
  const ElementBlock &plain = structure.blocks[0], &general = structure.blocks[1];
  EXPECT_EQ(std::tuple(plain.general_section, plain.compliance.size(), plain.count), std::tuple(false, 0u, 8));
  EXPECT_EQ(std::tuple(general.general_section, general.count), std::tuple(true, 4));
  EXPECT_EQ(structure.member_laws[0], nullptr);
  EXPECT_NE(structure.member_laws[1], nullptr);
}

}  // namespace
}  // namespace mixbeam::test
