/// Legendre polynomials, their derivatives and integrals against printed coefficients, Gauss rules and the standard
/// library.
#include "kernels/math/legendre.hpp"

#include "kernels/math/gauss.hpp"
#include "tests/support/worst_error.hpp"

#include <array>
#include <vector>

namespace mixbeam::legendre_test {
namespace {

using test::kRounding;
using test::WorstError;
using Real = long double;

constexpr int kPrinted = 9;  // degree of the highest closed form below
constexpr int kHighest = 20;
constexpr int kIntervals = 400;

// Abramowitz and Stegun, table 22.9: coefficients of x^0, x^1, ... times the common denominator.
struct ClosedForm {
  Real denominator;
  std::array<Real, kPrinted + 1> coefficient;

  Real value(Real x) const {
    Real sum = 0.0L;
    for (int i = kPrinted; i >= 0; --i) sum = sum * x + coefficient[static_cast<std::size_t>(i)];
    return sum / denominator;
  }
  Real derivative(Real x) const {
    Real sum = 0.0L;
    for (int i = kPrinted; i >= 1; --i) sum = sum * x + i * coefficient[static_cast<std::size_t>(i)];
    return sum / denominator;
  }
  /// From -1 to x.
  Real integral(Real x) const { return primitive(x) - primitive(-1.0L); }

 private:
  Real primitive(Real x) const {
    Real sum = 0.0L;
    for (int i = kPrinted; i >= 0; --i) sum = sum * x + coefficient[static_cast<std::size_t>(i)] / (i + 1);
    return sum * x / denominator;
  }
};

const std::array<ClosedForm, kPrinted + 1> kClosedForms = {{{1, {1}},
                                                            {1, {0, 1}},
                                                            {2, {-1, 0, 3}},
                                                            {2, {0, -3, 0, 5}},
                                                            {8, {3, 0, -30, 0, 35}},
                                                            {8, {0, 15, 0, -70, 0, 63}},
                                                            {16, {-5, 0, 105, 0, -315, 0, 231}},
                                                            {16, {0, -35, 0, 315, 0, -693, 0, 429}},
                                                            {128, {35, 0, -1260, 0, 6930, 0, -12012, 0, 6435}},
                                                            {128, {0, 315, 0, -4620, 0, 18018, 0, -25740, 0, 12155}}}};

enum class Kind { value, derivative, integral };

/// Entries 0..degree from the code; the entry that it must not set is left NaN.
std::vector<double> evaluate(Kind kind, int degree, double xi) {
  std::vector<double> result(static_cast<std::size_t>(degree) + 1, std::nan(""));
  if (kind == Kind::value) legendre(degree, xi, result.data());
  if (kind == Kind::derivative) legendre_derivatives(degree, xi, result.data());
  if (kind == Kind::integral) integrated_legendre(degree, xi, result.data());
  return result;
}

/// Calls f(xi) for points of [-1, 1], the ends and the middle included.
template <class Action>
void for_many_points(Action f) {
  for (int i = 0; i <= kIntervals; ++i) f(-1.0 + 2.0 * i / kIntervals);
}

// Absolute errors in roundings of 1.1e-16, measured with and without fused multiply-add in parentheses.
// The recurrence is stable inside of [-1, 1]; rounding grows to the ends, where P_n changes n^2 times as fast as xi
// (14).
constexpr double kValueError = 21 * kRounding;
// Relative to the largest derivative n (n + 1) / 2 (7.7).
constexpr double kDerivativeError = 12 * kRounding;
constexpr double kIntegralError = 1.5 * kRounding;  // (0.7)
// Sums over Gauss points carry the rounding of the weights (8.2 and 7).
constexpr double kOrthogonalityError = 13 * kRounding;
constexpr double kIntegratedError = 11 * kRounding;

TEST(Legendre, ValuesDerivativesIntegralsOfClosedForms) {
  WorstError value, derivative, integral;
  for_many_points([&](double xi) {
    const auto p = evaluate(Kind::value, kPrinted, xi), d = evaluate(Kind::derivative, kPrinted, xi);
    const auto b = evaluate(Kind::integral, kPrinted, xi);
    for (std::size_t n = 0; n <= kPrinted; ++n) {
      const double largest_slope = n > 0 ? 0.5 * static_cast<double>(n * (n + 1)) : 1.0;
      const ClosedForm& exact = kClosedForms[n];
      value.see(static_cast<double>(std::abs(p[n] - exact.value(xi))), "P_", n, "(", xi, ")");
      derivative.see(static_cast<double>(std::abs(d[n] - exact.derivative(xi))) / largest_slope, "P'_", n, "(", xi,
                     ")");
      if (n > 0) integral.see(static_cast<double>(std::abs(b[n] - exact.integral(xi))), "B_", n, "(", xi, ")");
    }
  });
  EXPECT_TRUE(value.at_most(kValueError));
  EXPECT_TRUE(derivative.at_most(kDerivativeError));
  EXPECT_TRUE(integral.at_most(kIntegralError));
}

TEST(Legendre, HigherDegreesAgainstTheStandardLibrary) {
  WorstError worst;
  for_many_points([&](double xi) {
    const auto p = evaluate(Kind::value, kHighest, xi);
    for (unsigned n = 0; n <= kHighest; ++n)
      worst.see(static_cast<double>(std::abs(p[n] - std::legendre(n, Real(xi)))), "P_", n, "(", xi, ")");
  });
  EXPECT_TRUE(worst.at_most(kValueError));
}

TEST(Legendre, EndsAreExact) {
  for (const double end : {-1.0, 1.0}) {
    const auto p = evaluate(Kind::value, kHighest, end), d = evaluate(Kind::derivative, kHighest, end);
    const auto b = evaluate(Kind::integral, kHighest, end);
    for (int n = 0; n <= kHighest; ++n) {
      const auto i = static_cast<std::size_t>(n);
      const double sign = end < 0.0 && n % 2 == 1 ? -1.0 : 1.0;
      EXPECT_EQ(p[i], sign) << "P_" << n << "(" << end << ")";
      EXPECT_EQ(d[i], sign * end * 0.5 * n * (n + 1)) << "P'_" << n << "(" << end << ")";
      if (n > 0) {
        EXPECT_EQ(b[i], 0.0) << "B_" << n << "(" << end << ")";
      }
    }
  }
}

TEST(Legendre, DerivativeByTheQuotientIsUselessAtTheEnds) {
  // n (x P_n - P_{n-1}) / (x^2 - 1), the formula one finds first.
  const auto p = evaluate(Kind::value, 5, 1.0);
  EXPECT_TRUE(std::isnan(5 * (1.0 * p[5] - p[4]) / (1.0 * 1.0 - 1.0)));
}

struct Rule {
  explicit Rule(int n) : points(static_cast<std::size_t>(n)), weights(static_cast<std::size_t>(n)) {
    gauss_rule(n, points.data(), weights.data());
  }
  std::vector<double> points, weights;
};

/// Integral of the products of all pairs of functions of one kind.
std::vector<std::vector<Real>> gram_matrix(Kind kind, const Rule& rule) {
  std::vector<std::vector<Real>> gram(kHighest + 1, std::vector<Real>(kHighest + 1, 0.0L));
  for (std::size_t q = 0; q < rule.points.size(); ++q) {
    const auto p = evaluate(kind, kHighest, rule.points[q]);
    for (std::size_t m = 0; m <= kHighest; ++m)
      for (std::size_t n = 0; n <= kHighest; ++n) gram[m][n] += Real(rule.weights[q]) * p[m] * p[n];
  }
  return gram;
}

WorstError orthogonality_error(int points) {
  WorstError worst;
  const auto gram = gram_matrix(Kind::value, Rule(points));
  for (std::size_t m = 0; m <= kHighest; ++m)
    for (std::size_t n = 0; n <= kHighest; ++n) {
      const Real exact = m == n ? 2.0L / static_cast<Real>(2 * n + 1) : 0.0L;
      worst.see(static_cast<double>(std::abs(gram[m][n] - exact)), "P_", m, " P_", n, " with ", points, " points");
    }
  return worst;
}

TEST(Legendre, Orthogonality) {
  EXPECT_TRUE(orthogonality_error(kHighest + 1).at_most(kOrthogonalityError));
  EXPECT_FALSE(orthogonality_error(kHighest).at_most(kOrthogonalityError)) << "one point too few must be seen";
}

TEST(IntegratedLegendre, AreTheIntegrals) {
  // A Gauss rule on [-1, xi], exact for every degree here.
  const Rule rule(kHighest);
  WorstError worst, twin;
  for_many_points([&](double xi) {
    const auto b = evaluate(Kind::integral, kHighest, xi);
    std::vector<Real> integral(kHighest + 1, 0.0L);
    for (std::size_t q = 0; q < rule.points.size(); ++q) {
      const double x = 0.5 * (xi + 1.0) * (rule.points[q] + 1.0) - 1.0;
      const auto p = evaluate(Kind::value, kHighest, x);
      for (std::size_t j = 1; j <= kHighest; ++j) integral[j] += 0.5L * (Real(xi) + 1.0L) * rule.weights[q] * p[j];
    }
    for (std::size_t j = 1; j <= kHighest; ++j) {
      worst.see(static_cast<double>(std::abs(b[j] - integral[j])), "B_", j, "(", xi, ")");
      const double without_factor = b[j] * static_cast<double>(2 * j + 1);  // P_{j+1} - P_{j-1}
      twin.see(static_cast<double>(std::abs(without_factor - integral[j])), "B_", j, "(", xi, ")");
    }
  });
  EXPECT_TRUE(worst.at_most(kIntegratedError));
  EXPECT_FALSE(twin.at_most(kIntegratedError));
}

TEST(IntegratedLegendre, AreOrthogonalToAllButTheirNeighbours) {
  // B_j = (P_{j+1} - P_{j-1}) / (2j + 1) has no other component.
  const Rule rule(kHighest + 2);
  WorstError worst;
  for (std::size_t j = 1; j <= kHighest; ++j)
    for (std::size_t n = 0; n <= kHighest; ++n) {
      Real sum = 0.0L;
      for (std::size_t q = 0; q < rule.points.size(); ++q) {
        const double xi = rule.points[q];
        sum +=
            Real(rule.weights[q]) * evaluate(Kind::integral, kHighest, xi)[j] * evaluate(Kind::value, kHighest, xi)[n];
      }
      const Real norm = 2.0L / static_cast<Real>((2 * n + 1) * (2 * j + 1));
      const Real exact = n == j + 1 ? norm : n + 1 == j ? -norm : 0.0L;
      worst.see(static_cast<double>(std::abs(sum - exact)), "B_", j, " P_", n);
    }
  EXPECT_TRUE(worst.at_most(kOrthogonalityError));
}

TEST(Legendre, SetsItsOwnEntriesOnly) {
  for (const Kind kind : {Kind::value, Kind::derivative, Kind::integral})
    for (int degree = 0; degree <= kHighest; ++degree) {
      constexpr double kUntouched = 7.0;
      std::vector<double> result(static_cast<std::size_t>(degree) + 2, kUntouched);
      if (kind == Kind::value) legendre(degree, 0.3, result.data());
      if (kind == Kind::derivative) legendre_derivatives(degree, 0.3, result.data());
      if (kind == Kind::integral) integrated_legendre(degree, 0.3, result.data());
      EXPECT_EQ(result.back(), kUntouched) << "degree " << degree;
      for (std::size_t n = 1; n + 1 < result.size(); ++n) EXPECT_NE(result[n], kUntouched) << "degree " << degree;
      EXPECT_EQ(result[0] == kUntouched, kind == Kind::integral);
    }
}

}  // namespace
}  // namespace mixbeam::legendre_test
