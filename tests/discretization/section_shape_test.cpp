#include "discretization/scene/section_shape.hpp"

#include "tests/support/numbers.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <stdexcept>
#include <vector>

namespace mixbeam::section_shape_test {
namespace {

using test::kPi;
constexpr double kRounding = 1e-14;  // relative; a dozen operations

void expect_close(double value, double expected, double relative = kRounding) {
  EXPECT_NEAR(value, expected, relative * std::abs(expected));
}

/// Young's modulus 1 and no lateral contraction: bending stiffness = second moment, GIt = half the torsion constant.
SectionShape shape_of(SectionShapeKind kind, double size2, double size3 = 0.0, double wall = 0.0, double web = 0.0) {
  SectionShape shape;
  shape.kind = kind;
  shape.size2 = size2;
  shape.size3 = size3;
  shape.wall = wall;
  shape.web = web;
  shape.youngs_modulus = 1.0;
  return shape;
}

double torsion_constant(const SectionShape& shape) { return 2.0 * make_section("s", shape).torsional_stiffness; }

double shear_factor(const SectionShape& shape, int i) {
  const Section s = make_section("s", shape);
  const double g = 0.5 / (1.0 + shape.poisson_ratio);
  return s.shear_stiffness[static_cast<std::size_t>(i)] / (g * s.axial_stiffness);
}

TEST(SectionShape, CircleHasTheClosedForms) {
  SectionShape shape = shape_of(SectionShapeKind::circle, 0.2);
  shape.youngs_modulus = 210e9;
  shape.poisson_ratio = 0.3;
  const Section s = make_section("bar", shape);
  EXPECT_EQ(s.name, "bar");
  expect_close(s.axial_stiffness, 210e9 * kPi * 0.01);
  expect_close(s.bending_stiffness[0], 210e9 * kPi * 1e-4 / 4.0);
  expect_close(s.bending_stiffness[1], s.bending_stiffness[0]);
  const double g = 210e9 / 2.6;
  expect_close(s.torsional_stiffness, g * kPi * 1e-4 / 2.0);
  expect_close(s.shear_stiffness[0], 7.8 / 8.8 * g * kPi * 0.01);  // Cowper 1966: 6 (1 + nu) / (7 + 6 nu)
  ASSERT_TRUE(s.shape.has_value());
  EXPECT_EQ(s.shape->size2, 0.2);
}

TEST(SectionShape, AxesFollowTheConventionOfTheScene) {
  // width 2 along axis 2, height 3 along axis 3: bending about axis 2 works with the height
  const Section r = make_section("r", shape_of(SectionShapeKind::rectangle, 2.0, 3.0));
  expect_close(r.bending_stiffness[0], 2.0 * 27.0 / 12.0);
  expect_close(r.bending_stiffness[1], 3.0 * 8.0 / 12.0);
  const Section e = make_section("e", shape_of(SectionShapeKind::ellipse, 2.0, 4.0));
  expect_close(e.bending_stiffness[0], kPi * 1.0 * 8.0 / 4.0);
  expect_close(e.bending_stiffness[1], kPi * 2.0 * 1.0 / 4.0);
  expect_close(torsion_constant(shape_of(SectionShapeKind::ellipse, 2.0, 4.0)), kPi * 8.0 / 5.0);
}

TEST(SectionShape, RectangleTorsionHasPublishedDigits) {
  // the series in arithmetic of 30 digits, with all its terms
  expect_close(rectangle_torsion_constant(1.0, 1.0), 0.140577014955153715588);
  expect_close(rectangle_torsion_constant(2.0, 1.0) / 2.0, 0.228681677119570765026);
  // Timoshenko and Goodier, Theory of Elasticity, section 109, table 7: k1 with three to four digits
  EXPECT_NEAR(rectangle_torsion_constant(2.0, 1.0) / 2.0, 0.229, 5e-4);
  EXPECT_NEAR(rectangle_torsion_constant(1.0, 3.0) / 3.0, 0.263, 5e-4);
  EXPECT_NEAR(rectangle_torsion_constant(10.0, 1.0) / 10.0, 0.312, 5e-4);
  // a b^3 / 3 (1 - 0.6302 b / a) of a thin one, where the constant is 192 / pi^5 * 31/32 zeta(5)
  expect_close(rectangle_torsion_constant(1e4, 1.0), 1e4 / 3.0 * (1.0 - 0.630248876283866932 / 1e4));
}

/// Saint-Venant's series with the two sides exchanged: another sum with the same value, all of whose terms count.
double torsion_constant_by_the_other_series(double a, double b) {
  constexpr int kLastTerm = 4001;  // the rest is below 1 / (8 * 4001^4) = 5e-16
  double sum = 0.0;
  for (int n = kLastTerm; n > 0; n -= 2) sum += std::tanh(n * kPi * b / (2.0 * a)) / std::pow(n, 5);
  return b * a * a * a * (1.0 / 3.0 - 64.0 / std::pow(kPi, 5) * (a / b) * sum);
}

TEST(SectionShape, RectangleTorsionAgreesWithTheOtherSeries) {
  for (const double ratio : {1.0, 1.1, 1.5, 2.0, 3.0, 5.0}) {
    SCOPED_TRACE(ratio);
    const double other = torsion_constant_by_the_other_series(ratio, 1.0);
    // the other series cancels digits: its two parts exceed the difference ratio^2-fold
    expect_close(rectangle_torsion_constant(ratio, 1.0), other, 2e-14 * ratio * ratio);
    EXPECT_EQ(rectangle_torsion_constant(1.0, ratio), rectangle_torsion_constant(ratio, 1.0));
  }
}

TEST(SectionShape, TubeIsBetweenCircleAndThinRing) {
  SectionShape solid = shape_of(SectionShapeKind::tube, 2.0, 0.0, 1.0);
  solid.poisson_ratio = 0.25;
  SectionShape circle = shape_of(SectionShapeKind::circle, 2.0);
  circle.poisson_ratio = 0.25;
  const Section a = make_section("a", solid), b = make_section("b", circle);
  expect_close(a.axial_stiffness, b.axial_stiffness);
  expect_close(a.torsional_stiffness, b.torsional_stiffness);
  expect_close(a.shear_stiffness[1], b.shear_stiffness[1]);

  const double t = 1e-9, r = 1.0 - 0.5 * t;  // mean radius
  const Section ring = make_section("ring", shape_of(SectionShapeKind::tube, 2.0, 0.0, t));
  expect_close(ring.axial_stiffness, 2.0 * kPi * r * t);
  expect_close(ring.bending_stiffness[0], kPi * r * r * r * t);                             // next term: (t / 2 r)^2
  expect_close(shear_factor(shape_of(SectionShapeKind::tube, 2.0, 0.0, t), 0), 0.5, 1e-8);  // 2 (1+nu) / (4+3 nu)
}

TEST(SectionShape, ShearFactorsAreThoseOfCowper) {
  SectionShape rectangle = shape_of(SectionShapeKind::rectangle, 1.0, 7.0);
  expect_close(shear_factor(rectangle, 0), 5.0 / 6.0);
  rectangle.poisson_ratio = 0.5;
  expect_close(shear_factor(rectangle, 1), 15.0 / 17.5);
  SectionShape ellipse = shape_of(SectionShapeKind::ellipse, 3.0, 3.0);
  ellipse.poisson_ratio = 0.3;
  expect_close(shear_factor(ellipse, 0), 7.8 / 8.8);  // the circle
  // no contraction: 0.9 for a thin ellipse loaded along its long axis (the elementary theory), 0.75 across it
  EXPECT_NEAR(shear_factor(shape_of(SectionShapeKind::ellipse, 1.0, 1e-4), 0), 0.9, 1e-7);
  EXPECT_NEAR(shear_factor(shape_of(SectionShapeKind::ellipse, 1.0, 1e-4), 1), 0.75, 1e-7);
}

TEST(SectionShape, OverridesOfShear) {
  SectionShape shape = shape_of(SectionShapeKind::rectangle, 1.0, 2.0);
  shape.shear_correction = {std::nullopt, 1.0};
  expect_close(shear_factor(shape, 0), 5.0 / 6.0);
  expect_close(shear_factor(shape, 1), 1.0);
  shape.shear_modulus = 7.0;
  expect_close(make_section("s", shape).shear_stiffness[1], 14.0);
}

/// The elementary factor of an I loaded along its web, I^2 / (A integral of (Q / t)^2 dA), by integration over the
/// height: what Cowper's factor is for no contraction, when the shear in the flanges across the web is left out.
double web_factor_by_integration(double b, double h, double tf, double tw) {
  constexpr int kSlices = 4000;
  const double top = 0.5 * h, inner = top - tf;
  const double moment = (b * h * h * h - (b - tw) * std::pow(h - 2.0 * tf, 3)) / 12.0;
  const double area = 2.0 * b * tf + (h - 2.0 * tf) * tw;
  const auto q_web = [&](double z) { return b * tf * (top + inner) / 2.0 + tw * (inner * inner - z * z) / 2.0; };
  double integral = 0.0;
  for (int i = 0; i < kSlices; ++i) {
    const double z = inner * (i + 0.5) / kSlices;
    integral += 2.0 * std::pow(q_web(z), 2) / tw * inner / kSlices;
  }
  return moment * moment / (area * integral);
}

TEST(SectionShape, ISectionHasTheStiffnessesOfItsRectangles) {
  const double b = 0.1, h = 0.3, tf = 0.005, tw = 0.004;
  const SectionShape shape = shape_of(SectionShapeKind::i_section, b, h, tf, tw);
  const Section s = make_section("i", shape);
  expect_close(s.axial_stiffness, 2 * b * tf + (h - 2 * tf) * tw);
  expect_close(s.bending_stiffness[0], (b * h * h * h - (b - tw) * std::pow(h - 2 * tf, 3)) / 12.0);
  expect_close(s.bending_stiffness[1], (2 * tf * b * b * b + (h - 2 * tf) * tw * tw * tw) / 12.0);
  // Flange shear, which Cowper includes, takes (n^2 m)-fold more; thin walls and narrow flanges: a few per cent
  EXPECT_NEAR(shear_factor(shape, 1), web_factor_by_integration(b, h, tf, tw), 0.05 * shear_factor(shape, 1));
  expect_close(shear_factor(shape, 0), 5.0 / 6.0 * 2 * b * tf / s.axial_stiffness);
}

/// Torsion constant 2 * integral of phi, where laplace(phi) = -2 inside and phi = 0 on the boundary, by finite
/// differences on a grid of `step` and conjugate gradients.
class StressFunction {
 public:
  StressFunction(double width, double height, double step, const std::function<bool(double, double)>& inside)
      : columns_(static_cast<int>(std::lround(width / step)) + 1),
        rows_(static_cast<int>(std::lround(height / step)) + 1),
        step_(step) {
    free_.assign(static_cast<std::size_t>(columns_) * rows_, 0.0);
    for (int r = 1; r + 1 < rows_; ++r)
      for (int c = 1; c + 1 < columns_; ++c)
        free_[index(r, c)] = inside(c * step - 0.5 * width, r * step - 0.5 * height) ? 1.0 : 0.0;
  }

  double torsion_constant() const {
    const std::size_t n = free_.size();
    std::vector<double> phi(n, 0.0), residual(n), direction, image(n);
    for (std::size_t i = 0; i < n; ++i) residual[i] = 2.0 * step_ * step_ * free_[i];
    direction = residual;
    double norm = dot(residual, residual);
    for (const double target = 1e-16 * norm; norm > target;) {
      apply(direction, image);
      const double length = norm / dot(direction, image);
      for (std::size_t i = 0; i < n; ++i) phi[i] += length * direction[i];
      for (std::size_t i = 0; i < n; ++i) residual[i] -= length * image[i];
      const double next = dot(residual, residual);
      for (std::size_t i = 0; i < n; ++i) direction[i] = residual[i] + next / norm * direction[i];
      norm = next;
    }
    double sum = 0.0;
    for (const double value : phi) sum += value;
    return 2.0 * sum * step_ * step_;
  }

 private:
  std::size_t index(int row, int column) const { return static_cast<std::size_t>(row) * columns_ + column; }

  static double dot(const std::vector<double>& a, const std::vector<double>& b) {
    double sum = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
    return sum;
  }

  void apply(const std::vector<double>& x, std::vector<double>& y) const {
    for (int r = 1; r + 1 < rows_; ++r)
      for (int c = 1; c + 1 < columns_; ++c) {
        const std::size_t i = index(r, c);
        const auto below = i - static_cast<std::size_t>(columns_), above = i + static_cast<std::size_t>(columns_);
        y[i] = free_[i] == 0.0 ? 0.0 : 4.0 * x[i] - x[i - 1] - x[i + 1] - x[below] - x[above];
      }
  }

  int columns_, rows_;
  double step_;
  std::vector<double> free_;  // 1 inside, 0 on the boundary and outside
};

double i_section_torsion_by_differences(double b, double h, double tf, double tw, double step) {
  const double margin = 1e-9;  // nodes on the boundary are not inside
  const auto inside = [=](double y, double z) {
    const bool flange = std::abs(z) > 0.5 * h - tf + margin && std::abs(z) < 0.5 * h - margin;
    return flange ? std::abs(y) < 0.5 * b - margin : std::abs(y) < 0.5 * tw - margin;
  };
  return StressFunction(b, h, step, inside).torsion_constant();
}

TEST(SectionShape, DifferencesReachTheSquare) {
  const StressFunction square(1.0, 1.0, 1.0 / 64, [](double, double) { return true; });
  EXPECT_NEAR(square.torsion_constant(), 0.140577014955153716, 2e-4);  // error of second order in 1 / 64
}

TEST(SectionShape, ISectionTorsionIsThatOfAFieldSolution) {
  struct Proportions {
    double b, h, tf, tw;
  };
  for (const Proportions& p : {Proportions{10, 20, 1, 0.5}, Proportions{15, 30, 1, 0.75}, Proportions{12, 12, 1, 1}}) {
    SCOPED_TRACE(p.b);
    const double coarse = i_section_torsion_by_differences(p.b, p.h, p.tf, p.tw, 0.125);
    const double fine = i_section_torsion_by_differences(p.b, p.h, p.tf, p.tw, 0.0625);
    const double limit = fine + (fine - coarse) / 3.0;  // second order
    expect_close(i_section_torsion_constant(p.b, p.h, p.tf, p.tw), limit, 0.02);
  }
}

TEST(SectionShape, BoxHasTheStiffnessesOfItsWalls) {
  const double b = 0.06, h = 0.1, t = 0.004;
  const SectionShape shape = shape_of(SectionShapeKind::box, b, h, t);
  const Section s = make_section("box", shape);
  const double inner2 = b - 2 * t, inner3 = h - 2 * t;
  expect_close(s.axial_stiffness, b * h - inner2 * inner3, 1e-13);
  expect_close(s.bending_stiffness[0], (b * h * h * h - inner2 * std::pow(inner3, 3)) / 12.0, 1e-13);
  expect_close(s.bending_stiffness[1], (h * b * b * b - inner3 * std::pow(inner2, 3)) / 12.0, 1e-13);
  const double mean2 = b - t, mean3 = h - t;  // Bredt: 4 A_m^2 / integral of ds / t
  expect_close(torsion_constant(shape),
               4 * std::pow(mean2 * mean3, 2) * t / (2 * (mean2 + mean3)) + 2 * (mean2 + mean3) * t * t * t / 3);
  // Cowper 1966, thin-walled square tube: 20 (1 + nu) / (48 + 39 nu)
  SectionShape square = shape_of(SectionShapeKind::box, 1.0, 1.0, 0.01);
  for (const double nu : {0.0, 0.3}) {
    square.poisson_ratio = nu;
    for (const int axis : {0, 1}) expect_close(shear_factor(square, axis), 20 * (1 + nu) / (48 + 39 * nu), 1e-13);
  }
  // a tall box is two webs, a flat one hardly carries by its webs
  EXPECT_NEAR(shear_factor(shape_of(SectionShapeKind::box, 1e-3, 1.0, 1e-6), 1), 5.0 / 6.0, 0.01);
  EXPECT_LT(shear_factor(shape_of(SectionShapeKind::box, 1.0, 1e-2, 1e-4), 1), 0.02);
}

TEST(SectionShape, ISectionTorsionIsNeverBelowItsParts) {
  const double parts = 2.0 * rectangle_torsion_constant(10, 1) + rectangle_torsion_constant(18, 3);
  EXPECT_EQ(i_section_torsion_constant(10, 20, 1, 3), parts);  // thick web: outside of the published formula
  EXPECT_GE(i_section_torsion_constant(10, 20, 1, 1e-3), 2.0 * rectangle_torsion_constant(10, 1));
}

TEST(SectionShape, RefusesImpossibleShapes) {
  const auto refused = [](const SectionShape& shape) { EXPECT_THROW(make_section("s", shape), std::invalid_argument); };
  // of 1e200 the fourth power overflows, of 4e-57 the search for the largest stress did not end
  for (const double diameter : {0.0, double{NAN}, 1e200, 4e-57}) refused(shape_of(SectionShapeKind::circle, diameter));
  refused(shape_of(SectionShapeKind::rectangle, 1.0, -1.0));
  refused(shape_of(SectionShapeKind::tube, 1.0, 0.0, 0.51));
  refused(shape_of(SectionShapeKind::i_section, 1.0, 1.0, 0.5, 0.1));
  refused(shape_of(SectionShapeKind::i_section, 1.0, 1.0, 0.1, 1.1));
  const SectionShape circle = shape_of(SectionShapeKind::circle, 1.0);
  EXPECT_NO_THROW(make_section("s", circle));
  const std::vector<std::function<void(SectionShape&)>> spoilt = {
      [](SectionShape& s) { s.poisson_ratio = 0.51; }, [](SectionShape& s) { s.poisson_ratio = -1.0; },
      [](SectionShape& s) { s.youngs_modulus = 0.0; }, [](SectionShape& s) { s.shear_modulus = -1.0; },
      [](SectionShape& s) { s.shear_correction[0] = 0.0; }};
  for (const auto& spoil : spoilt) {
    SectionShape shape = circle;
    spoil(shape);
    refused(shape);
  }
}

}  // namespace
}  // namespace mixbeam::section_shape_test
