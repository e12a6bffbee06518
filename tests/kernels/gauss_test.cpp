/// Gauss rules: degree of exactness from both sides, printed tables, and roots with 64-bit mantissas.
#include "kernels/math/gauss.hpp"

#include "tests/support/worst_error.hpp"

#include <array>
#include <vector>

namespace mixbeam {
namespace {

using test::kRounding;
using test::WorstError;
using Real = long double;

constexpr int kMostPoints = 20;

struct Rule {
  explicit Rule(int n) : points(static_cast<std::size_t>(n)), weights(static_cast<std::size_t>(n)) {
    gauss_rule(n, points.data(), weights.data());
  }
  /// Summed with 64-bit mantissas: the sum adds no error of its own.
  template <class Function>
  Real integral(Function f) const {
    Real sum = 0.0L;
    for (std::size_t i = 0; i < points.size(); ++i) sum += Real(weights[i]) * f(Real(points[i]));
    return sum;
  }
  std::vector<double> points, weights;
};

unsigned as_unsigned(int n) { return static_cast<unsigned>(n); }

// Absolute errors in roundings of 1.1e-16, measured with and without fused multiply-add in parentheses.
constexpr double kPointError = 1 * kRounding;  // (0.85, up to 100 points)
// The weight is computed from the slope of P_n, a recurrence of n steps (3).
constexpr double kWeightError = 5 * kRounding;
// The errors of the weights add up (9, in the sum of 19 weights).
constexpr double kIntegralError = 14 * kRounding;

TEST(GaussRule, IntegratesMonomialsUpToDegreeTwoNMinusOne) {
  WorstError worst;
  for (int n = 1; n <= kMostPoints; ++n)
    for (int degree = 0; degree <= 2 * n - 1; ++degree) {
      const Real exact = degree % 2 == 0 ? 2.0L / (degree + 1) : 0.0L;
      const Real result = Rule(n).integral([&](Real x) { return std::pow(x, Real(degree)); });
      worst.see(static_cast<double>(std::abs(result - exact)), n, " points, degree ", degree);
    }
  EXPECT_TRUE(worst.at_most(kIntegralError));
}

TEST(GaussRule, IntegratesShiftedPowersUpToDegreeTwoNMinusOne) {
  // ((1 + x) / 2)^degree lives at one end of the interval and has no symmetry to help.
  WorstError worst;
  for (int n = 1; n <= kMostPoints; ++n)
    for (int degree = 0; degree <= 2 * n - 1; ++degree) {
      const Real result = Rule(n).integral([&](Real x) { return std::pow(0.5L * (1.0L + x), Real(degree)); });
      worst.see(static_cast<double>(std::abs(result - 2.0L / (degree + 1))), n, " points, degree ", degree);
    }
  EXPECT_TRUE(worst.at_most(kIntegralError));
}

TEST(GaussRule, MissesDegreeTwoNByTheKnownError) {
  // The error for x^2n is 2^(2n+1) (n!)^4 / ((2n+1) (2n)!^2) (Abramowitz and Stegun 25.4.30 with f^(2n) = (2n)!).
  for (int n = 1; n <= kMostPoints; ++n) {
    const Real exact = 2.0L / (2 * n + 1);
    const Real result = Rule(n).integral([&](Real x) { return std::pow(x, Real(2 * n)); });
    const Real log_error = (2 * n + 1) * std::log(2.0L) + 4 * std::lgamma(n + 1.0L) - std::log(2.0L * n + 1) -
                           2 * std::lgamma(2.0L * n + 1);
    EXPECT_GT(exact - result, 100 * kIntegralError) << n << " points: degree 2n must not be integrated";
    EXPECT_NEAR(static_cast<double>(exact - result), static_cast<double>(std::exp(log_error)), kIntegralError) << n;
  }
}

TEST(GaussRule, MissesTheSquareOfItsPolynomialCompletely) {
  // P_n^2 has degree 2n and is zero at every point.
  for (int n = 1; n <= kMostPoints; ++n) {
    const Real result = Rule(n).integral([&](Real x) { return std::pow(std::legendre(as_unsigned(n), x), 2.0L); });
    EXPECT_LE(result, kIntegralError) << n << " points";
    EXPECT_GT(2.0L / (2 * n + 1), 0.04L);
  }
}

/// Root of P_n next to x and the weight there, by Newton's method with 64-bit mantissas.
std::array<Real, 2> exact_point_and_weight(int n, Real x) {
  Real slope = 0.0L;
  for (int step = 0; step < 4; ++step) {
    const Real p = std::legendre(as_unsigned(n), x), before = std::legendre(as_unsigned(n - 1), x);
    slope = n * (x * p - before) / (x * x - 1.0L);
    x -= p / slope;
  }
  return {x, 2.0L / ((1.0L - x * x) * slope * slope)};
}

TEST(GaussRule, PointsAndWeightsAgainstLongDouble) {
  WorstError point, weight;
  for (int n = 1; n <= 100; ++n) {
    const Rule rule(n);
    for (std::size_t i = 0; i < rule.points.size(); ++i) {
      const std::array<Real, 2> exact = exact_point_and_weight(n, rule.points[i]);
      point.see(static_cast<double>(std::abs(rule.points[i] - exact[0])), "point ", i, " of ", n);
      weight.see(static_cast<double>(std::abs(rule.weights[i] - exact[1])), "weight ", i, " of ", n);
    }
  }
  EXPECT_TRUE(point.at_most(kPointError));
  EXPECT_TRUE(weight.at_most(kWeightError));
}

TEST(GaussRule, PointsAscendAndAreSymmetric) {
  for (int n = 1; n <= 100; ++n) {
    const Rule rule(n);
    const auto last = rule.points.size() - 1;
    for (std::size_t i = 0; i <= last; ++i) {
      EXPECT_EQ(rule.points[i], -rule.points[last - i]) << "point " << i << " of " << n;
      EXPECT_EQ(rule.weights[i], rule.weights[last - i]) << "weight " << i << " of " << n;
      EXPECT_GT(rule.weights[i], 0.0);
      EXPECT_LT(std::abs(rule.points[i]), 1.0);
      if (i > 0) {
        EXPECT_GT(rule.points[i], rule.points[i - 1]) << "point " << i << " of " << n;
      }
    }
  }
}

TEST(GaussRule, WritesNoMoreThanItsPoints) {
  constexpr double kUntouched = 7.0;
  for (int n = 1; n <= kMostPoints; ++n) {
    std::vector<double> points(static_cast<std::size_t>(n) + 1, kUntouched), weights = points;
    gauss_rule(n, points.data(), weights.data());
    EXPECT_EQ(points.back(), kUntouched);
    EXPECT_EQ(weights.back(), kUntouched);
  }
}

TEST(GaussRule, ClosedForms) {
  const std::vector<std::vector<std::array<Real, 2>>> rules = {
      {{0.0L, 2.0L}},
      {{1.0L / std::sqrt(3.0L), 1.0L}},
      {{0.0L, 8.0L / 9}, {std::sqrt(0.6L), 5.0L / 9}},
      {{std::sqrt(3.0L / 7 - 2.0L / 7 * std::sqrt(1.2L)), (18 + std::sqrt(30.0L)) / 36},
       {std::sqrt(3.0L / 7 + 2.0L / 7 * std::sqrt(1.2L)), (18 - std::sqrt(30.0L)) / 36}},
      {{0.0L, 128.0L / 225},
       {std::sqrt(5 - 2 * std::sqrt(10.0L / 7)) / 3, (322 + 13 * std::sqrt(70.0L)) / 900},
       {std::sqrt(5 + 2 * std::sqrt(10.0L / 7)) / 3, (322 - 13 * std::sqrt(70.0L)) / 900}}};
  for (std::size_t n = 1; n <= rules.size(); ++n) {
    const Rule rule(static_cast<int>(n));
    for (std::size_t i = 0; i < rules[n - 1].size(); ++i) {  // the right half, from the middle outwards
      EXPECT_NEAR(rule.points[n / 2 + i], static_cast<double>(rules[n - 1][i][0]), kPointError) << n << " points";
      EXPECT_NEAR(rule.weights[n / 2 + i], static_cast<double>(rules[n - 1][i][1]), kWeightError) << n << " points";
    }
  }
}

// Abramowitz and Stegun, Handbook of Mathematical Functions, table 25.4: right half, rounded to 15 decimals.
struct TableRow {
  double point, weight;
};
constexpr std::array<TableRow, 5> kTenPoints = {{{0.148874338981631, 0.295524224714753},
                                                 {0.433395394129247, 0.269266719309996},
                                                 {0.679409568299024, 0.219086362515982},
                                                 {0.865063366688985, 0.149451349150581},
                                                 {0.973906528517172, 0.066671344308688}}};
constexpr std::array<TableRow, 10> kTwentyPoints = {{{0.076526521133497, 0.152753387130726},
                                                     {0.227785851141645, 0.149172986472604},
                                                     {0.373706088715420, 0.142096109318382},
                                                     {0.510867001950827, 0.131688638449177},
                                                     {0.636053680726515, 0.118194531961518},
                                                     {0.746331906460151, 0.101930119817240},
                                                     {0.839116971822219, 0.083276741576705},
                                                     {0.912234428251326, 0.062672048334109},
                                                     {0.963971927277914, 0.040601429800387},
                                                     {0.993128599185095, 0.017614007139152}}};
constexpr double kTableError = 0.5e-15 + kWeightError;  // half a unit of the last printed decimal

template <std::size_t N>
void expect_table(const std::array<TableRow, N>& table) {
  const Rule rule(static_cast<int>(2 * N));
  for (std::size_t i = 0; i < N; ++i) {
    EXPECT_NEAR(rule.points[N + i], table[i].point, kTableError) << "row " << i;
    EXPECT_NEAR(rule.weights[N + i], table[i].weight, kTableError) << "row " << i;
  }
}

TEST(GaussRule, PrintedTables) {
  expect_table(kTenPoints);
  expect_table(kTwentyPoints);
}

}  // namespace
}  // namespace mixbeam
