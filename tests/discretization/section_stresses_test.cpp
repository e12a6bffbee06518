// Stresses in sections without any formula of theirs: resultants, free boundaries, equilibrium and compatibility,
// energies. Formulas: stress_formulas_test.cpp; largest values: largest_stresses_test.cpp.
#include "discretization/scene/section_law.hpp"
#include "tests/discretization/stress_sections.hpp"

#include <gtest/gtest.h>

namespace mixbeam::section_stresses_test {
namespace {

using test::Integrals;
using test::NamedShape;

constexpr double kExact = 1e-10;  // of the largest number beside it: quadrature in the corners of rectangles
constexpr int kCases = 20;

std::mt19937_64 generator() { return std::mt19937_64(20); }

std::vector<NamedShape> all_shapes() {
  std::vector<NamedShape> all = test::solid_shapes(0.3);
  for (const NamedShape& shape : test::walled_shapes()) all.push_back(shape);
  return all;
}

std::array<double, 6> as_array(const SectionForces& f) {
  return {f.force[0], f.force[1], f.force[2], f.moment[0], f.moment[1], f.moment[2]};
}

Integrals resultants_of(const SectionShape& shape, const SectionForces& forces) {
  const SectionStresses stresses(shape);
  return test::resultants(shape, [&](double x2, double x3) { return stresses.at(forces, {x2, x3}); });
}

/// Largest error of the six resultants, each over what a stress of one everywhere would give.
double resultant_error(const SectionShape& shape, const SectionForces& forces, const SectionForces& expected) {
  const Integrals sums = resultants_of(shape, forces);
  const double area = section_geometry(shape).area;
  double worst = 0.0;
  for (std::size_t i = 0; i < 6; ++i) {
    const double lever = i < 3 ? 1.0 : std::max(shape.size2, test::height_of(shape));
    worst = std::max(worst, std::abs(sums[i] - as_array(expected)[i]) / (area * lever));
  }
  return worst;
}

TEST(SectionStresses, SolidShapesAndTubeHaveTheirResultants) {
  auto random = generator();
  for (const double nu : {0.3, 0.0, 0.5})
    for (const NamedShape& s : test::solid_shapes(nu))
      for (int i = 0; i < 2; ++i) {
        const SectionForces forces = test::random_forces(s.shape, random);
        EXPECT_LT(resultant_error(s.shape, forces, forces), kExact) << s.name << " " << nu;
        SectionForces other = forces;
        other.moment[0] += 1e-6 * section_geometry(s.shape).area * s.shape.size2;
        EXPECT_GT(resultant_error(s.shape, forces, other), kExact) << s.name;
      }
}

/// Thin walls: normal stresses exact; of a shear force the webs carry nearly all, of a torque the walls half of what
/// they carry as open ones (the other half comes from their ends).
TEST(SectionStresses, WallsHaveTheirResultantsButForStatedShares) {
  struct Shares {
    double force2, force3, torque;
  };
  const std::array<Shares, 4> shares = {Shares{1.0, 0.962, 0.5}, Shares{1.0, 0.875, 0.5}, Shares{0.993, 1.001, 0.995},
                                        Shares{1.003, 0.997, 1.0}};
  auto shape = shares.begin();
  for (const NamedShape& s : test::walled_shapes()) {
    SectionForces forces;
    const SectionGeometry g = section_geometry(s.shape);
    forces.force = {1.1 * g.area, 0.0, 0.0};
    forces.moment = {0.0, g.second_moment[0] / s.shape.size3, g.second_moment[1] / s.shape.size2};
    EXPECT_LT(resultant_error(s.shape, forces, forces), kExact) << s.name;
    const auto share = [&](std::size_t i) {
      SectionForces one;
      (i < 3 ? one.force[i] : one.moment[i - 3]) = 1.0;
      return resultants_of(s.shape, one)[i];
    };
    EXPECT_NEAR(share(1), shape->force2, 2e-3) << s.name;
    EXPECT_NEAR(share(2), shape->force3, 2e-3) << s.name;
    EXPECT_NEAR(share(3), shape->torque, 0.03) << s.name;
    ++shape;
  }
}

/// Shear stress across the boundary of a solid section at random points of it, over the largest one.
double traction(const SectionShape& s, const SectionStresses& stresses, const SectionForces& forces,
                std::mt19937_64& random) {
  std::uniform_real_distribution<double> number(-1.0, 1.0);
  const double a = 0.5 * s.size2, b = 0.5 * test::height_of(s);
  double worst = 0.0;
  const auto look = [&](double x2, double x3, double n2, double n3) {
    const auto [t12, t13] = stresses.at(forces, {x2, x3}).shear;
    worst = std::max(worst, std::abs(t12 * n2 + t13 * n3) / std::hypot(n2, n3));
  };
  for (int i = 0; i < 50; ++i) {
    const double u = number(random), c = std::cos(test::kPi * u), d = std::sin(test::kPi * u);
    if (s.kind == SectionShapeKind::rectangle) {
      look(a, u * b, 1.0, 0.0);
      look(u * a, -b, 0.0, -1.0);
      continue;
    }
    look(a * c, b * d, c / a, d / b);
    const double hole = s.kind == SectionShapeKind::tube ? a - s.wall : 0.0;
    if (hole > 0.0) look(hole * c, hole * d, c, d);
  }
  return worst / stresses.largest(forces).shear.value;
}

TEST(SectionStresses, ShearIsTangentialAtFreeBoundaries) {
  auto random = generator();
  for (const NamedShape& s : test::solid_shapes(0.3))
    for (int i = 0; i < kCases; ++i) {
      SectionForces forces = test::random_forces(s.shape, random);
      forces.force[2] = 1.0;
      EXPECT_LT(traction(s.shape, SectionStresses(s.shape), forces, random), 1e-11) << s.name;
      SectionShape other = s.shape;  // twin: the field of another section
      other.size2 *= 0.99;
      EXPECT_GT(traction(s.shape, SectionStresses(other), forces, random), 1e-6) << s.name;
    }
  for (const NamedShape& s : test::walled_shapes()) {  // faces of walls: no stress across them; tips of the I: no flow
    SectionForces forces;
    forces.force = {0.0, 1.0, 1.0};
    if (s.shape.kind != SectionShapeKind::i_section) continue;
    const auto tip = SectionStresses(s.shape).at(forces, {0.5 * s.shape.size2, 0.5 * s.shape.size3}).shear;
    EXPECT_NEAR(tip[0], 0.0, 1e-10);
    EXPECT_EQ(tip[1], 0.0);
  }
}

/// Derivatives by differences of order eight (order six for the second one) with step h.
struct Differences {
  double first = 0.0, second = 0.0;
};
Differences differences(const std::function<double(double)>& f, double h) {
  constexpr std::array<double, 4> first = {4.0 / 5.0, -1.0 / 5.0, 4.0 / 105.0, -1.0 / 280.0};
  constexpr std::array<double, 4> second = {8.0 / 5.0, -1.0 / 5.0, 8.0 / 315.0, -1.0 / 560.0};
  Differences d;
  d.second = -205.0 / 72.0 * f(0.0);
  for (int i = 1; i <= 4; ++i) {
    d.first += first[i - 1] * (f(i * h) - f(-i * h));
    d.second += second[i - 1] * (f(i * h) + f(-i * h));
  }
  return {d.first / h, d.second / (h * h)};
}

struct LocalErrors {
  double equilibrium = 0.0, compatibility = 0.0;
};

/// Equilibrium along the beam, d sigma / dx1 + d tau_12 / dx2 + d tau_13 / dx3 = 0 with M2' = Q3 and M3' = -Q2, and
/// Beltrami's equations; over the largest shear stress by the smaller size.
LocalErrors local_errors(const SectionShape& s, const SectionForces& f, double nu, double x2, double x3) {
  const SectionStresses stresses(s);
  SectionForces slope;
  slope.moment = {0.0, f.force[2], -f.force[1]};
  const double size = s.kind == SectionShapeKind::tube ? s.wall : std::min(s.size2, test::height_of(s)),
               h = size / 60.0;
  const auto along = [&](std::size_t component, bool axis2) {
    return differences(
        [&](double d) {
          return stresses.at(f, {x2 + (axis2 ? d : 0.0), x3 + (axis2 ? 0.0 : d)}).shear[component];
        },
        h);
  };
  const Differences t12_2 = along(0, true), t12_3 = along(0, false), t13_2 = along(1, true), t13_3 = along(1, false);
  const SectionGeometry g = section_geometry(s);
  LocalErrors e;
  e.equilibrium = std::abs(stresses.at(slope, {x2, x3}).normal + t12_2.first + t13_3.first);
  e.compatibility = std::max(std::abs(t12_2.second + t12_3.second + f.force[1] / ((1.0 + nu) * g.second_moment[1])),
                             std::abs(t13_2.second + t13_3.second + f.force[2] / ((1.0 + nu) * g.second_moment[0])));
  const double unit = stresses.largest(f).shear.value / size;
  return {e.equilibrium / unit, e.compatibility / (unit / size)};
}

TEST(SectionStresses, SolidShapesAndTubeAreInEquilibriumAndCompatible) {
  auto random = generator();
  std::uniform_real_distribution<double> number(-1.0, 1.0);
  for (const NamedShape& s : test::solid_shapes(0.3))
    for (int i = 0; i < kCases; ++i) {
      SectionForces forces = test::random_forces(s.shape, random);
      forces.force[2] = 1.0;
      const double angle = test::kPi * number(random), tube = s.shape.kind == SectionShapeKind::tube ? 1.0 : 0.0;
      const double r = tube > 0.0 ? 1.0 - s.shape.wall / s.shape.size2 : 0.6 * std::abs(number(random));
      const double x2 = 0.5 * s.shape.size2 * r * std::cos(angle),
                   x3 = 0.5 * test::height_of(s.shape) * r * std::sin(angle);
      const LocalErrors errors = local_errors(s.shape, forces, 0.3, x2, x3);
      EXPECT_LT(errors.equilibrium, 1e-10) << s.name << " at " << x2 << ", " << x3;
      EXPECT_LT(errors.compatibility, 1e-7) << s.name;  // second differences lose digits
      EXPECT_GT(local_errors(s.shape, forces, 0.29, x2, x3).compatibility, 1e-7) << s.name;
    }
}

/// Energy per length by the stresses over that of the section's stiffnesses, for one force or moment.
double energy_ratio(const SectionShape& shape, std::size_t component) {
  SectionForces one;
  (component < 3 ? one.force[component] : one.moment[component - 3]) = 1.0;
  const Integrals sums = resultants_of(shape, one);
  const double g = 0.5 / (1.0 + shape.poisson_ratio);
  const double by_stresses = sums[6] / shape.youngs_modulus + sums[7] / g;
  return by_stresses * diagonal(make_section("", shape))[component];
}

/// The largest and the smallest that make_section takes: 16 T / (pi d^3) of a torque.
TEST(SectionStresses, TinyAndHugeCirclesHaveTheirStresses) {
  constexpr double kRounding = 1e-12, kOfForce = 1e-8;  // 16 / 3 of the force's 1e-9, at most
  for (const double diameter : {1e-30, 1.0, 1e30}) {
    const SectionShape shape = test::stress_shape(SectionShapeKind::circle, 0.0, {diameter});
    SectionForces forces{};
    forces.moment[0] = std::pow(diameter, 3);
    forces.force[1] = 1e-9 * diameter * diameter;  // the largest one is then looked for
    EXPECT_NEAR(SectionStresses(shape).largest(forces).shear.value, 16.0 / M_PI, kOfForce) << diameter;
    forces.force[1] = 0.0;
    EXPECT_NEAR(SectionStresses(shape).largest(forces).shear.value, 16.0 / M_PI, kRounding * 16.0 / M_PI) << diameter;
  }
}

TEST(SectionStresses, EnergyIsThatOfTheSection) {
  for (const NamedShape& s : all_shapes())
    for (const std::size_t component : {0, 4, 5}) EXPECT_NEAR(energy_ratio(s.shape, component), 1.0, kExact) << s.name;
  for (const double nu : {0.0, 0.3})
    for (const NamedShape& s : test::solid_shapes(nu)) EXPECT_NEAR(energy_ratio(s.shape, 3), 1.0, kExact) << s.name;
  for (const NamedShape& s : test::solid_shapes(0.0))
    for (const std::size_t component : {1, 2}) EXPECT_NEAR(energy_ratio(s.shape, component), 1.0, kExact) << s.name;
}

TEST(SectionStresses, CowpersFactorIsNotTheEnergeticOne) {
  const double ratio = energy_ratio(test::solid_shapes(0.3)[0].shape, 2);
  EXPECT_NEAR(7.8 / 8.8 / ratio, 0.851, 1e-3);  // Cowper's for the circle is 0.886
}

}  // namespace
}  // namespace mixbeam::section_stresses_test
