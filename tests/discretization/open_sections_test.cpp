// T, L and U: stiffnesses and stresses against closed forms, written from other axes than those of the program.
#include "scene_text.hpp"
#include "stress_sections.hpp"

#include "discretization/scene/section_law.hpp"

namespace mixbeam::open_sections_test {
namespace {

using Kind = SectionShapeKind;
using test::stress_shape;

constexpr double kRounding = 1e-13;  // relative; some dozens of operations
constexpr double kB = 2.0, kH = 3.0, kT = 0.3, kW = 0.2;

SectionShape tee() { return stress_shape(Kind::t_section, 0.3, {kB, kH, kT, kW}); }
SectionShape angle() { return stress_shape(Kind::l_section, 0.3, {kB, kH, kT}); }
SectionShape channel() { return stress_shape(Kind::u_section, 0.3, {kB, kH, kT, kW}); }

void expect_close(double value, double expected, double relative = kRounding) {
  EXPECT_NEAR(value, expected, relative * std::abs(expected));
}

TEST(OpenSections, TeeHasTheClosedForms) {
  const SectionGeometry g = section_geometry(tee());
  const double area = kB * kT + kW * (kH - kT);
  const double from_top = (kB * kT * kT + kW * (kH * kH - kT * kT)) / 2.0 / area;
  const double about_top = (kB * kT * kT * kT + kW * (kH * kH * kH - kT * kT * kT)) / 3.0;
  expect_close(g.area, area);
  expect_close(g.second_moment[0], about_top - area * from_top * from_top);
  expect_close(g.second_moment[1], (kT * kB * kB * kB + (kH - kT) * kW * kW * kW) / 12.0);
  EXPECT_EQ(g.product_moment, 0.0);
  expect_close(g.torsion_constant, rectangle_torsion_constant(kB, kT) + rectangle_torsion_constant(kW, kH - kT));
  expect_close(g.shear_factor[0] * area, 13.0 / 15.3 * kB * kT);  // Cowper's rectangle, 10 (1 + nu) / (12 + 11 nu)
  expect_close(g.shear_factor[1] * area, 13.0 / 15.3 * kW * (kH - kT));
}

TEST(OpenSections, ChannelHasTheClosedForms) {
  const SectionGeometry g = section_geometry(channel());
  const double area = 2.0 * kB * kT + kW * (kH - 2.0 * kT);
  const double from_back = (2.0 * kT * kB * kB + (kH - 2.0 * kT) * kW * kW) / 2.0 / area;
  const double about_back = (2.0 * kT * kB * kB * kB + (kH - 2.0 * kT) * kW * kW * kW) / 3.0;
  expect_close(g.area, area);
  expect_close(g.second_moment[0], (kB * kH * kH * kH - (kB - kW) * std::pow(kH - 2.0 * kT, 3)) / 12.0);
  expect_close(g.second_moment[1], about_back - area * from_back * from_back);
  EXPECT_EQ(g.product_moment, 0.0);
  expect_close(g.shear_factor[0] * area, 13.0 / 15.3 * 2.0 * kB * kT);
}

TEST(OpenSections, AngleHasTheClosedForms) {
  const SectionGeometry g = section_geometry(angle());
  const double area = kT * (kB + kH - kT);
  const double x = kT * (kB * kB + (kH - kT) * kT) / 2.0 / area, y = kT * (kH * kH + (kB - kT) * kT) / 2.0 / area;
  const double about_foot = (kB * kT * kT * kT + kT * (kH * kH * kH - kT * kT * kT)) / 3.0;
  const double about_back = (kT * kB * kB * kB + (kH - kT) * kT * kT * kT) / 3.0;
  const double product = kT * kT * (kB * kB + kH * kH - kT * kT) / 4.0;  // about the corner
  expect_close(g.area, area);
  expect_close(g.second_moment[0], about_foot - area * y * y);
  expect_close(g.second_moment[1], about_back - area * x * x);
  expect_close(g.product_moment, product - area * x * y);
  EXPECT_LT(g.product_moment, 0.0);
}

/// Equal legs: the principal axes lie at 45 degrees, where bending couples no longer.
TEST(OpenSections, EqualAnglesHaveDiagonalPrincipalAxes) {
  const Section s = make_section("l", stress_shape(Kind::l_section, 0.3, {1.0, 1.0, 0.1}));
  const Matrix6 c = section_compliance(s);
  EXPECT_NEAR(c[4][4], c[5][5], kRounding * c[4][4]);
  // M2 = 1, M3 = -1 bends about the axis (1, -1): kappa is parallel to it
  EXPECT_NEAR(c[4][4] - c[4][5], c[5][5] - c[5][4], kRounding * c[4][4]);
  EXPECT_GT(std::abs(c[4][5]), 0.1 * c[4][4]);
}

const SectionForces kBent = {{0.3, 0.0, 0.0}, {0.0, 0.7, -0.4}};

test::Integrals resultants_of(const SectionShape& shape, const SectionStresses& stresses, const SectionForces& f) {
  return test::resultants(shape, [&](double x2, double x3) { return stresses.at(f, {x2, x3}); });
}

/// What bends the section by strains that are linear over it makes the stresses of these strains, and the other way.
TEST(OpenSections, StressesAreThoseOfTheStrains) {
  for (const SectionShape& shape : {tee(), angle(), channel()}) {
    const Section section = make_section("s", shape);
    const Matrix6 c = section_compliance(section);
    const SectionForces& f = kBent;
    const auto strain = [&](std::size_t i) {
      return c[i][0] * f.force[0] + c[i][4] * f.moment[1] + c[i][5] * f.moment[2];
    };
    const SectionStresses stresses(shape);
    for (const WallRectangle& wall : section_rectangles(shape))
      for (const double x2 : {wall.from[0], wall.to[0]})
        for (const double x3 : {wall.from[1], wall.to[1]})
          EXPECT_NEAR(stresses.at(f, {x2, x3}).normal, strain(0) + strain(4) * x3 - strain(5) * x2, 1e-12);
  }
}

TEST(OpenSections, NormalStressesHaveTheirResultants) {
  for (SectionShape shape : {tee(), angle(), channel()}) {
    const auto sums = resultants_of(shape, SectionStresses(shape), kBent);
    EXPECT_NEAR(sums[0], 0.3, 1e-12);
    EXPECT_NEAR(sums[4], 0.7, 1e-12);
    EXPECT_NEAR(sums[5], -0.4, 1e-12);
    SectionShape other = shape;  // the twin: the field of another section
    other.mirrored = !shape.mirrored;
    const auto wrong = resultants_of(shape, SectionStresses(other), kBent);
    // others have the same moments upside down
    EXPECT_EQ(std::abs(wrong[4] - 0.7) > 1e-3, shape.kind == Kind::l_section);
  }
}

/// As walls get thin, what flows along them carries the shear forces.
TEST(OpenSections, ThinWallsCarryTheShearForces) {
  constexpr double kThin = 1e-3;  // thickness over width, and what corners may miss of the forces
  for (const Kind kind : {Kind::t_section, Kind::l_section, Kind::u_section}) {
    const SectionShape shape = stress_shape(kind, 0.3, {1.0, 1.5, kThin, 0.7 * kThin});
    const auto sums = resultants_of(shape, SectionStresses(shape), {{0.0, 0.6, -0.8}, {}});
    EXPECT_NEAR(sums[1], 0.6, 3.0 * kThin) << static_cast<int>(kind);
    EXPECT_NEAR(sums[2], -0.8, 3.0 * kThin) << static_cast<int>(kind);
  }
}

TEST(OpenSections, ShearStressesOfWebs) {
  const SectionForces f = {{0.0, 0.0, 1.7}, {}};
  {  // T: largest at the centroid, V S / (I w) of what lies below
    const SectionGeometry g = section_geometry(tee());
    const double below = -section_rectangles(tee())[1].from[1];
    const PointStress s = SectionStresses(tee()).at(f, {0.0, 0.0});
    expect_close(s.shear[1], 1.7 * 0.5 * below * below / g.second_moment[0]);
    EXPECT_EQ(s.shear[0], 0.0);
    expect_close(SectionStresses(tee()).largest(f).shear.value, s.shear[1]);
  }
  {  // U: in the middle of the web, of flange and half of the web; flange at the web
    const SectionGeometry g = section_geometry(channel());
    const auto walls = section_rectangles(channel());
    const double inner = 0.5 * kH - kT, arm = 0.5 * (kH - kT);
    const SectionStresses stresses(channel());
    const PointStress s = stresses.at(f, {walls[2].middle(0), 0.0});
    expect_close(s.shear[1], 1.7 * (kB * kT * arm + 0.5 * kW * inner * inner) / (g.second_moment[0] * kW));
    const PointStress flange = stresses.at(f, {walls[0].to[0] - 0.5 * kB, walls[0].middle(1)});
    expect_close(flange.shear[0], 1.7 * 0.5 * kB * arm / g.second_moment[0]);
  }
  {  // torsion: T t / J on the faces of the thickest wall
    const SectionForces torque = {{}, {0.9, 0.0, 0.0}};
    for (const SectionShape& shape : {tee(), angle(), channel()})
      expect_close(SectionStresses(shape).largest(torque).shear.value,
                   0.9 * kT / section_geometry(shape).torsion_constant);
  }
}

TEST(OpenSections, RefusesWhatIsNoSection) {
  const auto refused = [](const SectionShape& shape) { EXPECT_THROW(make_section("s", shape), std::invalid_argument); };
  for (const auto& [kind, wall, web] : {std::tuple(Kind::t_section, 1.6, 0.2),
                                        {Kind::t_section, 0.3, 1.1},
                                        {Kind::l_section, 1.1, 0.0},
                                        {Kind::u_section, 1.1, 0.2},
                                        {Kind::u_section, 0.3, 0.0}})
    refused(stress_shape(kind, 0.3, {2.0, 3.0, wall, web}));
}

TEST(OpenSections, TapersInterpolateDimensions) {
  Scene scene;
  SectionShape small = angle();
  small.size3 = 1.0;
  scene.sections = {make_section("a", angle()), make_section("b", small)};
  Member member;
  member.name = "m";
  member.section = "a";
  member.end_section = "b";
  const Section middle = SectionLaw(scene, member).section(0.5);
  EXPECT_EQ(middle.shape->size3, 2.0);
  ASSERT_TRUE(middle.matrix.has_value());
  expect_close((*middle.matrix)[4][5], -section_geometry(*middle.shape).product_moment);
}

TEST(OpenSections, ScenesHaveThem) {
  const auto read = [](const std::string& inside) {
    return scene_from(changed(kBowScene, "EA: 1e4, GA2: 5e3, GA3: 5000, GIt: 2, EI2: 2, EI3: 2.5", inside))
        .sections.at(0);
  };
  const std::string material = ", Material: {E: 1, nu: 0.3}";
  EXPECT_TRUE(read("Shape: L, Width: 2, Height: 3, Wall: 0.3" + material).matrix.has_value());
  EXPECT_EQ(read("Shape: T, Width: 2, Height: 3, Flange: 0.3, Web: 0.2" + material).shape->web, 0.2);
  EXPECT_EQ(read("Shape: U, Width: 2, Height: 3, Flange: 0.3, Web: 0.2" + material).shape->wall, 0.3);
  const auto refused = [&](const std::string& inside, const std::vector<std::string>& parts) {
    expect_in(message_of([&] { read(inside + material); }), parts);
  };
  refused("Shape: L, Width: 2, Height: 3, Web: 0.3", {"steel / Wall", "needed for \"Shape\" = \"L\""});
  refused("Shape: U, Width: 2, Height: 3, Flange: 2, Web: 0.2", {"the flange thickness is 2", "at most 1"});
}

}  // namespace
}  // namespace mixbeam::open_sections_test
