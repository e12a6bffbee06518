// Stresses in sections against the formulas of the books, written down a second time and in other ways: series term by
// term, and the other of two series.
#include "tests/discretization/stress_sections.hpp"

#include <gtest/gtest.h>

namespace mixbeam::stress_formulas_test {
namespace {

using Shear = std::array<double, 2>;
using test::kPi;

constexpr double kSame = 1e-10;  // of the largest shear stress in the section
constexpr double kNu = 0.3;
constexpr int kPoints = 200;

Shear swapped(const Shear& s) { return {s[1], s[0]}; }

SectionForces single(double torque, double force2, double force3) {
  return {{0.0, force2, force3}, {torque, 0.0, 0.0}};
}

/// Formula of tau for unit T, Q2 or Q3 at a point.
using Formula = std::function<Shear(double x2, double x3)>;

/// Largest difference at random points inside 0.97 of the size, over the largest shear stress.
double worst_difference(const SectionShape& shape, const SectionForces& forces, const Formula& formula) {
  const SectionStresses stresses(shape);
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> number(-0.97, 0.97);
  const double unit = stresses.largest(forces).shear.value;
  double worst = 0.0;
  for (int i = 0; i < kPoints;) {
    const double x2 = 0.5 * shape.size2 * number(random), x3 = 0.5 * test::height_of(shape) * number(random);
    if (!stresses.contains({x2, x3})) continue;
    ++i;
    const Shear a = stresses.at(forces, {x2, x3}).shear, b = formula(x2, x3);
    worst = std::max({worst, std::abs(a[0] - b[0]) / unit, std::abs(a[1] - b[1]) / unit});
  }
  return worst;
}

void expect_formula(const SectionShape& shape, const SectionForces& forces, const Formula& formula) {
  EXPECT_LT(worst_difference(shape, forces, formula), kSame);
  SectionForces twin = forces;
  twin.force[1] += 1e-6 * (forces.force[1] + forces.force[2]);
  twin.moment[0] *= 1.0 + 1e-6;
  EXPECT_GT(worst_difference(shape, twin, formula), kSame);
}

/// Under a unit torque, and a unit force along axis 3 and along axis 2, `across`: the formula of the section that lies
/// on its side.
void expect_formulas(const SectionShape& shape, const Formula& torque, const Formula& force3, const Formula& across) {
  expect_formula(shape, single(1, 0, 0), torque);
  expect_formula(shape, single(0, 0, 1), force3);
  expect_formula(shape, single(0, 1, 0), [&](double x2, double x3) { return swapped(across(x3, x2)); });
}

/// Timoshenko and Goodier, ch. 11.
Shear circle_force3(double a, double x2, double x3) {
  const double i = kPi * std::pow(a, 4) / 4.0;
  return {-(1.0 + 2.0 * kNu) / (4.0 * (1.0 + kNu) * i) * x2 * x3,
          (3.0 + 2.0 * kNu) / (8.0 * (1.0 + kNu) * i) *
              (a * a - x3 * x3 - (1.0 - 2.0 * kNu) / (3.0 + 2.0 * kNu) * x2 * x2)};
}

TEST(StressFormulas, Circle) {
  const double a = 1.3, j = kPi * std::pow(a, 4) / 2.0;
  const SectionShape shape = test::stress_shape(SectionShapeKind::circle, kNu, {2.0 * a});
  const auto force = [&](double x2, double x3) { return circle_force3(a, x2, x3); };
  expect_formulas(
      shape,
      [&](double x2, double x3) {
        return Shear{-x3 / j, x2 / j};
      },
      force, force);
  const LargestStress largest = SectionStresses(shape).largest(single(0, 0, 1)).shear;
  EXPECT_NEAR(largest.value, (3.0 + 2.0 * kNu) / (8.0 * (1.0 + kNu)) * a * a / (0.5 * j), 1e-14);
  EXPECT_NEAR(std::hypot(largest.point[0], largest.point[1]), 0.0, 1e-12);
}

/// Love's function, differentiated by hand as the page has it.
Shear tube_force3(double a, double b, double x2, double x3) {
  const double i = kPi * (std::pow(a, 4) - std::pow(b, 4)) / 4.0, k = 1.0 / (2.0 * (1.0 + kNu) * i);
  const double r2 = x2 * x2 + x3 * x3, lead = -(0.75 + 0.5 * kNu);
  const double c3 =
      lead * (a * a + b * b + a * a * b * b * (1.0 / r2 - 2.0 * x3 * x3 / (r2 * r2))) + 0.75 * (x3 * x3 - x2 * x2);
  const double c2 = lead * a * a * b * b * -2.0 * x2 * x3 / (r2 * r2) - 1.5 * x2 * x3;
  return {-k * (c2 + (2.0 + kNu) * x2 * x3), -k * (c3 + 0.5 * kNu * x3 * x3 + (1.0 - 0.5 * kNu) * x2 * x2)};
}

TEST(StressFormulas, Tube) {
  for (const double wall : {0.5, 0.05}) {
    const double a = 1.0, b = a - wall;
    const SectionShape shape = test::stress_shape(SectionShapeKind::tube, kNu, {2.0 * a, 0.0, wall});
    const double j = kPi * (std::pow(a, 4) - std::pow(b, 4)) / 2.0;
    const auto force = [&](double x2, double x3) { return tube_force3(a, b, x2, x3); };
    expect_formulas(
        shape,
        [&](double x2, double x3) {
          return Shear{-x3 / j, x2 / j};
        },
        force, force);
    const LargestStress largest = SectionStresses(shape).largest(single(0, 0, 1)).shear;
    EXPECT_NEAR(std::abs(largest.point[0]), b, 1e-6);
    EXPECT_NEAR(largest.value * kPi * (a * a - b * b), 2.0, 1.5 * wall);  // thin wall: 2 Q / A
  }
}

/// Half axes: a along the force, b across.
Shear ellipse_force3(double a, double b, double x2, double x3) {
  const double i = kPi * b * a * a * a / 4.0, d = (1.0 + kNu) * (3.0 * a * a + b * b) * i,
               lead = 2.0 * (1.0 + kNu) * a * a + b * b;
  return {-((1.0 + kNu) * a * a + kNu * b * b) / d * x2 * x3,
          lead / (2.0 * d) * (a * a - x3 * x3 - (1.0 - 2.0 * kNu) * a * a * x2 * x2 / lead)};
}

TEST(StressFormulas, Ellipse) {
  const double b = 0.7, a = 1.9;
  const SectionShape shape = test::stress_shape(SectionShapeKind::ellipse, kNu, {2.0 * b, 2.0 * a});
  const auto torque = [&](double x2, double x3) {
    return Shear{-2.0 * x3 / (kPi * b * a * a * a), 2.0 * x2 / (kPi * a * b * b * b)};
  };
  expect_formulas(
      shape, torque, [&](double x2, double x3) { return ellipse_force3(a, b, x2, x3); },
      [&](double x2, double x3) { return ellipse_force3(b, a, x2, x3); });
}

/// cosh(x) / cosh(y) and sinh(x) / cosh(y) for |x| <= y, without overflow.
double cosh_ratio(double x, double y) { return (std::exp(x - y) + std::exp(-x - y)) / (1.0 + std::exp(-2.0 * y)); }
double sinh_ratio(double x, double y) { return (std::exp(x - y) - std::exp(-x - y)) / (1.0 + std::exp(-2.0 * y)); }

/// Half sizes: a along the force, b across. Timoshenko and Goodier, ch. 11, term by term: within 0.97 of the height the
/// terms fall like exp(-0.03 m pi a / b).
Shear rectangle_force3(double a, double b, double x2, double x3) {
  const double i = 2.0 * b * std::pow(2.0 * a, 3) / 12.0, p = 2.0 * b * b * kNu / (kPi * kPi * (1.0 + kNu) * i);
  double t12 = 0.0, t13 = kPi * kPi / 12.0 * (3.0 * x2 * x2 / (b * b) - 1.0);  // the part of cos(m pi x2 / b) alone
  for (int m = 1; m < 3000; ++m) {
    const double q = m * kPi / b, sign = (m % 2 == 0 ? 1.0 : -1.0) / m / m;
    if (q * (a - std::abs(x3)) > 40.0) break;
    t13 -= sign * std::cos(q * x2) * cosh_ratio(q * x3, q * a);
    t12 += sign * std::sin(q * x2) * sinh_ratio(q * x3, q * a);
  }
  return {p * t12, 0.5 / i * (a * a - x3 * x3) + p * t13};
}

/// Prandtl's series across axis 2 of half size b, whatever side is the longer one.
Shear rectangle_torque(double b, double a, double x2, double x3) {
  const double j = rectangle_torsion_constant(2.0 * b, 2.0 * a);
  double t12 = 0.0, t13 = 2.0 * x2;
  for (int n = 1; n < 6000; n += 2) {
    const double q = 0.5 * n * kPi / b, size = 16.0 * b / (kPi * kPi) * ((n - 1) / 2 % 2 == 0 ? 1.0 : -1.0) / n / n;
    if (q * (a - std::abs(x3)) > 40.0) break;
    t12 -= size * std::cos(q * x2) * sinh_ratio(q * x3, q * a);
    t13 -= size * std::sin(q * x2) * cosh_ratio(q * x3, q * a);
  }
  return {t12 / j, t13 / j};
}

TEST(StressFormulas, Rectangle) {
  for (const double b : {0.1, 0.6, 1.0, 1.9, 2.1, 12.0}) {
    const double a = 1.0;
    const SectionShape shape = test::stress_shape(SectionShapeKind::rectangle, kNu, {2.0 * b, 2.0 * a});
    expect_formulas(
        shape, [&](double x2, double x3) { return rectangle_torque(b, a, x2, x3); },
        [&](double x2, double x3) { return rectangle_force3(a, b, x2, x3); },
        [&](double x2, double x3) { return rectangle_force3(b, a, x2, x3); });
  }
}

/// Timoshenko and Goodier, table of art. 109: T / (k2 (2a)^2 2b), and of ch. 11: 1.5 Q / A times a factor.
TEST(StressFormulas, RectangleHasPublishedDigits) {
  const auto factor = [](double ratio) {
    const SectionShape s = test::stress_shape(SectionShapeKind::rectangle, kNu, {1.0, ratio});
    return 1.0 / (SectionStresses(s).largest(single(1, 0, 0)).shear.value * ratio);
  };
  EXPECT_NEAR(factor(1.0), 0.208, 5e-4);
  EXPECT_NEAR(factor(1.5), 0.231, 5e-4);
  EXPECT_NEAR(factor(2.0), 0.246, 5e-4);
  EXPECT_NEAR(factor(10.0), 0.312, 1e-3);
  const SectionShape flat = test::stress_shape(SectionShapeKind::rectangle, 0.25, {4.0, 1.0});
  EXPECT_NEAR(SectionStresses(flat).largest(single(0, 0, 1)).shear.value / (1.5 / 4.0), 1.988, 0.02);
}

TEST(StressFormulas, ISection) {
  const double b = 0.1, h = 0.2, tf = 0.0085, tw = 0.0056, zf = 0.5 * (h - tf), hw = h - 2.0 * tf;
  const SectionShape shape = test::stress_shape(SectionShapeKind::i_section, kNu, {b, h, tf, tw});
  const double i2 = (b * h * h * h - (b - tw) * hw * hw * hw) / 12.0,
               i3 = (2.0 * tf * b * b * b + hw * tw * tw * tw) / 12.0;
  const double j = i_section_torsion_constant(b, h, tf, tw);
  expect_formula(shape, single(0, 0, 1), [&](double x2, double x3) {
    if (std::abs(x3) >= 0.5 * hw) return Shear{(x2 * x3 > 0.0 ? 1.0 : -1.0) * zf * (0.5 * b - std::abs(x2)) / i2, 0.0};
    return Shear{0.0, (b * tf * zf + tw * (0.25 * hw * hw - x3 * x3) / 2.0) / (i2 * tw)};
  });
  expect_formula(shape, single(0, 1, 0), [&](double x2, double x3) {
    return Shear{std::abs(x3) >= 0.5 * hw ? (0.25 * b * b - x2 * x2) / (2.0 * i3) : 0.0, 0.0};
  });
  expect_formula(shape, single(1, 0, 0), [&](double x2, double x3) {
    if (std::abs(x3) >= 0.5 * hw) return Shear{-2.0 * (x3 - std::copysign(zf, x3)) / j, 0.0};
    return Shear{0.0, 2.0 * x2 / j};
  });
}

TEST(StressFormulas, BoxHasBredtsFlowAndVSByIt) {
  const double b = 0.06, h = 0.1, t = 0.004, bm = b - t, hm = h - t;
  const SectionShape shape = test::stress_shape(SectionShapeKind::box, kNu, {b, h, t});
  const SectionStresses stresses(shape);
  const double am = bm * hm, bredt = 4.0 * am * am * t / (2.0 * (bm + hm)), open = 2.0 * (bm + hm) * t * t * t / 3.0;
  const double j = bredt + open;
  EXPECT_NEAR(section_geometry(shape).torsion_constant / j, 1.0, 1e-14);
  EXPECT_NEAR(stresses.at(single(1, 0, 0), {0.5 * bm, 0.01}).shear[1] * 2.0 * am * t, bredt / j, 1e-12);
  EXPECT_NEAR(stresses.at(single(1, 0, 0), {0.01, 0.5 * hm}).shear[0] * 2.0 * am * t, -bredt / j, 1e-12);
  const double face = stresses.at(single(1, 0, 0), {0.5 * b, 0.0}).shear[1];
  EXPECT_NEAR(face, bredt / j / (2.0 * am * t) + t / j, 1e-9 * face);
  const double i2 = (b * h * h * h - (b - 2.0 * t) * std::pow(h - 2.0 * t, 3)) / 12.0, reach = 0.5 * h - t;
  const double s_middle = b * t * 0.5 * hm + 2.0 * t * 0.5 * reach * reach;  // of all above the axis
  EXPECT_NEAR(stresses.at(single(0, 0, 1), {0.5 * bm, 0.0}).shear[1], s_middle / (i2 * 2.0 * t), 1e-9 / (i2 * t));
  EXPECT_NEAR(stresses.at(single(0, 0, 1), {0.01, 0.5 * hm}).shear[0], -0.01 * 0.5 * hm / i2, 1e-9 / i2);
}

}  // namespace
}  // namespace mixbeam::stress_formulas_test
