// Coupled (full 6 x 6) and tapered sections in whole problems: closed forms, a reference value, and identities.
#include "discretization/reading/blade_file.hpp"
#include "discretization/scene/section_law.hpp"
#include "discretization/scene/section_shape.hpp"
#include "kernels/math/vector_algebra.hpp"
#include "tests/support/blade_texts.hpp"
#include "tests/support/scene_file.hpp"
#include "tests/support/solve.hpp"

namespace mixbeam::test::general_sections_test {
namespace {

/// A section by its matrix.
Section coupled(const Matrix6& matrix) {
  return {"section", matrix[0][0], {matrix[1][1], matrix[2][2]}, matrix[3][3], {matrix[4][4], matrix[5][5]}, matrix};
}

Matrix6 diagonal_matrix(const Section& s) {
  Matrix6 m{};
  for (int i = 0; i < 6; ++i) m[i][i] = diagonal(s)[i];
  return m;
}

/// Composite cantilever: stiffness, length and load of the reference value below.
Section composite_section() {
  Matrix6 m{};
  m[0][0] = 1368.17e3;
  m[1][1] = 88.56e3;
  m[2][2] = 38.78e3;
  const double moments[3][3] = {
      {16.96e3, 17.61e3, -0.351e3}, {17.61e3, 59.12e3, -0.37e3}, {-0.351e3, -0.37e3, 141.47e3}};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) m[3 + i][3 + j] = moments[i][j];
  return coupled(m);
}
Scene composite_cantilever(int order, int elements) {
  Scene scene = cantilever(composite_section(), 10.0, order, elements);
  scene.name = "composite cantilever";
  scene.point_loads = {dead_load("tip", {0, 0, 150})};
  return scene;
}

/// Coupled across forces and moments too.
Matrix6 fully_coupled() {
  return {{{1e4, 4e2, 0, 2e2, -1e2, 3e2},
           {4e2, 5e3, 1e3, 0, 2e2, 1e2},
           {0, 1e3, 4e3, 1e2, 3e2, 0},
           {2e2, 0, 1e2, 100, 30, -10},
           {-1e2, 2e2, 3e2, 30, 150, 20},
           {3e2, 1e2, 0, -10, 20, 200}}};
}

// Shooting on the ordinary differential equations of the rod, Runge-Kutta 7(8), step doubling changes less than 1e-10.
TEST(CoupledSection, CompositeCantileverReachesItsReference) {
  constexpr double kRelative = 1e-8;
  const Simulation beam = solved(composite_cantilever(4, 16));
  EXPECT_TRUE(
      agrees_relatively(beam.displacement("tip"), {-0.0902726627566, -0.0647488486259, 1.2297364829237}, kRelative));
  EXPECT_EQ(beam.result().steps, 1);
  EXPECT_LE(beam.result().newton_iterations, 8);
  // the twin that must fail: without the smallest coupling
  Scene other = composite_cantilever(4, 16);
  (*other.sections[0].matrix)[4][5] = (*other.sections[0].matrix)[5][4] = 0.0;
  EXPECT_FALSE(agrees_relatively(solved(other).displacement("tip"),
                                 {-0.0902726627566, -0.0647488486259, 1.2297364829237}, kRelative));
}

// A straight beam with axial force only: N = F e1, M = 0, so gamma and kappa are constant columns of the compliance.
// With axial-torsional coupling it stays straight and its tip turns by S_41 F L, exactly and for any size.
TEST(CoupledSection, PulledBeamTwists) {
  Matrix6 m{};
  const double axial = 50.0, torsion = 2.0, coupling = 6.0;
  m[0][0] = axial;
  m[1][1] = m[2][2] = 20.0;
  m[3][3] = torsion;
  m[4][4] = m[5][5] = 4.0;
  m[0][3] = m[3][0] = coupling;
  const double determinant = axial * torsion - coupling * coupling, force = 9.0, length = 3.0;
  for (int order : {1, 2, 4}) {
    Scene scene = cantilever(coupled(m), length, order, 4);
    scene.point_loads = {dead_load("tip", {force, 0, 0})};
    const Simulation beam = solved(scene);
    const double stretch = torsion / determinant * force, twist = -coupling / determinant * force;
    EXPECT_TRUE(agrees(beam.displacement("tip"), {stretch * length, 0, 0}, 1e-12)) << order;
    EXPECT_TRUE(agrees(beam.rotation("tip"), {twist * length, 0, 0}, 1e-12)) << order;
    const StrainEnergy energy = beam.strain_energy();
    EXPECT_NEAR(energy.force, 0.5 * force * stretch * length, 1e-12) << order;
    EXPECT_NEAR(energy.moment, 0.0, 1e-12) << order;
    for (const MemberSamples& samples : beam.samples(3))
      for (size_t i = 0; i < samples.size(); ++i) {
        EXPECT_TRUE(agrees(samples.force_strain[i], {stretch, 0, 0}, 1e-12)) << order;
        EXPECT_TRUE(agrees(samples.moment_strain[i], {twist, 0, 0}, 1e-12)) << order;
      }
  }
}

// Small loads: the strain energy is half the work of the load, whatever the coupling.
TEST(CoupledSection, StrainEnergyIsHalfTheWorkOfASmallLoad) {
  Scene scene = cantilever(coupled(fully_coupled()), 3.0, 3, 4);
  const Vector3 force{1e-5, 2e-5, -1e-5}, moment{2e-5, 1e-5, 3e-5};
  scene.point_loads = {dead_load("tip", force, moment)};
  const Simulation beam = solved(scene);
  double work = 0.0;
  for (int i = 0; i < 3; ++i)
    work += 0.5 * (force[i] * beam.displacement("tip")[i] + moment[i] * beam.rotation("tip")[i]);
  const StrainEnergy energy = beam.strain_energy();
  EXPECT_NEAR((energy.force + energy.moment) / work, 1.0, 1e-6);  // rotations are of size 1e-6
  EXPECT_GT(std::abs(energy.moment / work - 1.0), 1e-4);          // the twin: one part is not the whole
}

// A diagonal matrix is the section of six numbers, in the same iterations.
TEST(CoupledSection, DiagonalMatrixIsThePlainSection) {
  for (int order : {1, 2, 5}) {
    const Scene plain = arc_segment(100, order, 6);
    Scene with_matrix = plain;
    with_matrix.sections[0].matrix = diagonal_matrix(plain.sections[0]);
    const Simulation a = solved(plain), b = solved(with_matrix);
    EXPECT_TRUE(agrees_relatively(b.displacement("tip"), a.displacement("tip"), 1e-11)) << order;
    EXPECT_TRUE(agrees_relatively(b.rotation("tip"), a.rotation("tip"), 1e-11)) << order;
    EXPECT_EQ(a.result().newton_iterations, b.result().newton_iterations) << order;
    const StrainEnergy of_a = a.strain_energy(), of_b = b.strain_energy();
    EXPECT_NEAR(of_b.moment / of_a.moment, 1.0, 1e-10) << order;
    EXPECT_NEAR(of_b.force / of_a.force, 1.0, 1e-7) << order;  // slenderness 100: N is 1e-4 of the energy's forces
  }
}

// Plain and general members side by side.
TEST(CoupledSection, OneMemberOfAFrame) {
  const Scene plain = slope_discontinuity(2, 5);
  Scene mixed = plain;
  mixed.sections.push_back(plain.sections[0]);
  mixed.sections[1].name = "matrix";
  mixed.sections[1].matrix = diagonal_matrix(plain.sections[0]);
  mixed.members[1].section = "matrix";
  EXPECT_TRUE(agrees_relatively(solved(mixed).displacement("tip"), solved(plain).displacement("tip"), 1e-11));
}

/// The solution of matrix x = b by elimination; the matrix is positive definite.
std::array<double, 6> solution(Matrix6 matrix, std::array<double, 6> b) {
  for (int i = 0; i < 6; ++i)
    for (int row = 0; row < 6; ++row) {
      if (row == i) continue;
      const double factor = matrix[row][i] / matrix[i][i];
      for (int j = i; j < 6; ++j) matrix[row][j] -= factor * matrix[i][j];
      b[row] -= factor * b[i];
    }
  for (int i = 0; i < 6; ++i) b[i] /= matrix[i][i];
  return b;
}

/// Displacement of the tip in axes 1, 2, 3 by linear theory: gamma + kappa x r over the length, under the force F and
/// the moment r x F at the distance r from the tip.
Vector3 tip_of_small_bending(const Matrix6& stiffness, double length, const Vector3& force) {
  Vector3 tip{};
  for (const double xi : {-1.0, 1.0}) {  // Gauss: a quadratic function
    const Vector3 to_tip = {0.5 * length * (1.0 + xi / std::sqrt(3.0)), 0, 0},
                  moment = vector_algebra::cross(to_tip, force);
    const auto strain = solution(stiffness, {force[0], force[1], force[2], moment[0], moment[1], moment[2]});
    const Vector3 bending = vector_algebra::cross({strain[3], strain[4], strain[5]}, to_tip);
    for (int i = 0; i < 3; ++i) tip[i] += 0.5 * length * (strain[i] + bending[i]);
  }
  return tip;
}

/// A blade of 10 m along (0, -sin, cos) of the azimuth, its axis 2 along x, under a force in its axes at the tip.
Vector3 tip_of_blade(const std::string& section, double azimuth, const Vector3& force) {
  const double s = std::sin(azimuth), c = std::cos(azimuth);
  const Vector3 axes[3] = {{0, -s, c}, {1, 0, 0}, {0, c, s}};
  const auto written = [](const Vector3& v) {
    std::ostringstream text;
    text << std::setprecision(17) << "[" << v[0] << ", " << v[1] << ", " << v[2] << "]";
    return text.str();
  };
  Vector3 global{};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) global[j] += force[i] * axes[i][j];
  const Vector3 u = solved(scene_of_text("Scene: {Sections: {s: {Matrix: " + section +
                                         "}}, Points: {root: [0, 0, 0], tip: " + written({0, -10 * s, 10 * c}) +
                                         "}, Members: {blade: {Start: root, End: tip, Section: s, Second Axis: " +
                                         "[1, 0, 0], Order: 3, Elements: 2}}, Supports: {root: {Point: root}}, " +
                                         "Point Loads: {push: {Point: tip, Force: " + written(global) + "}}}"))
                        .displacement("tip");
  Vector3 local{};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) local[i] += axes[i][j] * u[j];
  return local;
}

TEST(CoupledSection, FilesOfOtherProgramsBendAlikeInThreeAzimuths) {
  constexpr double kSecondOrder = 1e-7;  // rotations are 1e-8
  const Vector3 force = {0.03, -0.02, 0.05};
  const blade_texts::Known known = blade_texts::known_section();
  const Vector3 tip = tip_of_small_bending(known.stiffness, 10.0, force);
  for (const std::string& text :
       {blade_texts::vabs(known), blade_texts::becas(known), blade_texts::anba(known), blade_texts::beamdyn(known),
        blade_texts::windio(known), blade_texts::hawc2(true), blade_texts::hawc2(false)}) {
    Teuchos::ParameterList sections = sections_of_blade(text, "s.K");
    std::ostringstream matrix;
    matrix << std::setprecision(17);
    for (const double entry : sections.sublist(sections.name(sections.begin())).get<Teuchos::Array<double>>("Matrix"))
      matrix << (matrix.str().empty() ? "[" : ", ") << entry;
    for (const double azimuth : {0.0, 2.0943951, 4.1887902})
      EXPECT_TRUE(agrees_relatively(tip_of_blade(matrix.str() + "]", azimuth, force), tip, kSecondOrder)) << text;
  }
  // The twin: without the shift of the centre the tip is elsewhere.
  Matrix6 straight = known.stiffness;
  straight[0][4] = straight[4][0] = straight[0][5] = straight[5][0] = 0.0;
  EXPECT_FALSE(agrees_relatively(tip_of_small_bending(straight, 10.0, force), tip, kSecondOrder));
}

// Rigid in bending and torsion: what a very stiff section tends to, with and without a matrix.
TEST(RigidSection, BendingAndTorsion) {
  const auto tip = [](double torsion, double bending2, bool with_matrix) {
    Section s{"section", 1e3, {5e2, 5e2}, torsion, {bending2, 3.0}};
    if (with_matrix) s.matrix = diagonal_matrix(s);
    if (std::isinf(torsion) && with_matrix) (*s.matrix)[3][3] = (*s.matrix)[4][4] = 1.0;
    Scene scene = arc_segment(s, 0.0, 1.0, 3, 4);
    scene.point_loads = {dead_load("tip", {-1e-4, 3e-4, 2e-4})};
    return solved(scene).displacement("tip");
  };
  const Vector3 rigid = tip(kRigid, kRigid, false);
  EXPECT_TRUE(agrees_relatively(rigid, tip(1e10, 1e10, false), 1e-8));
  EXPECT_TRUE(agrees_relatively(tip(kRigid, kRigid, true), rigid, 1e-10));
  EXPECT_FALSE(agrees_relatively(rigid, tip(1e3, 1e3, false), 1e-4));
}

Scene tapered_cantilever(const Section& start, const Section& end, double length, int order, int elements,
                         const std::string& taper = "") {
  Scene scene = cantilever(start, length, order, elements);
  scene.sections.push_back(end);
  scene.sections[1].name = "end";
  scene.members[0].end_section = "end";
  scene.members[0].taper = taper;
  return scene;
}

/// Inextensible and shear-rigid, moment at the tip: theta(s) = M L / (b - a) ln(1 + (b - a) s / (a L)) for EI from a to
/// b, linear in s.
struct LinearBending {
  double start, end, length, moment;
  double angle(double s) const {
    return moment * length / (end - start) * std::log1p((end - start) / start * s / length);
  }
  /// Position of the tip: 40000 panels of the three-point Gauss rule, far below the tolerances of the tests.
  Vector3 tip() const {
    constexpr int kPanels = 40000;
    const double h = length / kPanels, offset = 0.5 * h * std::sqrt(0.6);
    double x = 0.0, y = 0.0;
    for (int p = 0; p < kPanels; ++p) {
      const double middle = (p + 0.5) * h;
      for (const auto& [s, w] :
           {std::pair<double, double>{middle - offset, 5.0}, {middle, 8.0}, {middle + offset, 5.0}}) {
        x += h / 18.0 * w * std::cos(angle(s));
        y += h / 18.0 * w * std::sin(angle(s));
      }
    }
    return {x, y, 0.0};
  }
  Scene scene(int order, int elements) const {
    Scene beam = tapered_cantilever(section(kRigid, kRigid, start, start), section(kRigid, kRigid, end, end), length,
                                    order, elements);
    beam.point_loads = {dead_load("tip", {}, {0, 0, moment})};
    return beam;
  }
};

// The angle is a sum of Gauss rules with k + 1 points over M / EI, so its error falls with h^(2k + 2); positions, and
// the deflection between them, with h^2k.
TEST(TaperedSection, MomentAtTheTipConvergesWithTheOrder) {
  constexpr double kPreasymptotic = 0.35;
  const LinearBending beam{4.0, 2.0, 2.0, 4.0};
  const double angle = beam.angle(beam.length);
  const Vector3 tip = beam.tip();
  for (int order : {1, 2, 3}) {
    double angle_error[2], tip_error[2];
    for (int level : {0, 1}) {
      const Simulation found = solved(beam.scene(order, 6 << level));
      angle_error[level] = std::abs(found.rotation("tip")[2] - angle);
      const Vector3 u = found.displacement("tip");
      tip_error[level] = distance({u[0] + beam.length, u[1], u[2]}, tip);
    }
    EXPECT_NEAR(std::log2(angle_error[0] / angle_error[1]), 2 * order + 2, kPreasymptotic) << order;
    EXPECT_NEAR(std::log2(tip_error[0] / tip_error[1]), 2 * order, kPreasymptotic) << order;
  }
  const Simulation fine = solved(beam.scene(4, 16));
  EXPECT_NEAR(fine.rotation("tip")[2], angle, 1e-12);
  const Vector3 u = fine.displacement("tip");
  EXPECT_TRUE(agrees({u[0] + beam.length, u[1], u[2]}, tip, 1e-11));
}

// Round cantilever of diameter d(x) with a small load at the tip: with r = d(clamp) / d(tip) the deflection is
// P L^3 / (3 E I(tip) r^3), from int xi^2 / (1 + c xi)^4 = 1 / (3 (1 + c)^3) over [0, 1].
TEST(TaperedSection, RoundCantilever) {
  const auto round = [](double diameter) {
    SectionShape shape;
    shape.size2 = diameter;
    shape.youngs_modulus = 200.0;
    shape.poisson_ratio = 0.3;
    Section s = make_section("section", shape);
    s.axial_stiffness = s.shear_stiffness[0] = s.shear_stiffness[1] = kRigid;
    return s;
  };
  const double at_clamp = 0.6, at_tip = 0.2, length = 5.0, ratio = at_clamp / at_tip;
  const double bending = round(at_tip).bending_stiffness[0], deflection = 1e-5 * length;
  const double load = deflection * 3.0 * bending * ratio * ratio * ratio / (length * length * length);
  Scene scene = tapered_cantilever(round(at_clamp), round(at_tip), length, 4, 8);
  scene.point_loads = {dead_load("tip", {0, load, 0})};
  EXPECT_NEAR(solved(scene).displacement("tip")[1] / deflection, 1.0, 1e-8);
  // the twin that must fail: stiffness itself interpolated
  for (Section& s : scene.sections) s.shape.reset();
  EXPECT_GT(std::abs(solved(scene).displacement("tip")[1] / deflection - 1.0), 0.1);
}

// Taper in a coupled section: axial force only, strains are the column of the compliance at x, and the tip moves by
// its integral. S = (1 / f(x)) S0 with f = 1 + x: int = ln 2.
TEST(TaperedSection, CoupledBarUnderAxialForce) {
  Matrix6 m{};
  for (int i = 0; i < 6; ++i) m[i][i] = i < 3 ? 50.0 : 4.0;
  m[0][3] = m[3][0] = 6.0;
  Matrix6 twice = m;
  for (auto& row : twice)
    for (double& x : row) x *= 2.0;
  const double determinant = 50.0 * 4.0 - 36.0, force = 5.0, length = 3.0;
  Scene scene = tapered_cantilever(coupled(m), coupled(twice), length, 4, 6);
  scene.point_loads = {dead_load("tip", {force, 0, 0})};
  const Simulation beam = solved(scene);
  const double log2 = std::log(2.0);
  EXPECT_TRUE(agrees(beam.displacement("tip"), {4.0 / determinant * force * length * log2, 0, 0}, 1e-11));
  EXPECT_TRUE(agrees(beam.rotation("tip"), {-6.0 / determinant * force * length * log2, 0, 0}, 1e-11));
  for (const MemberSamples& samples : beam.samples(4))
    for (size_t i = 0; i < samples.size(); ++i) {
      const double f = 1.0 + samples.arc_length[i] / length;
      EXPECT_TRUE(agrees(samples.force_strain[i], {4.0 / determinant * force / f, 0, 0}, 1e-11));
      EXPECT_TRUE(agrees(samples.moment_strain[i], {-6.0 / determinant * force / f, 0, 0}, 1e-11));
    }
}

}  // namespace
}  // namespace mixbeam::test::general_sections_test
