/// Values of rotation.hpp, theory (1) to (5), at zero, tiny, moderate angles, at every switch point, next to pi and
/// after many turns, against long-double power series. Derivatives: rotation_derivatives_test.cpp.
#include "kernels/math/rotation.hpp"

#include "tests/kernels/rotation_oracle.hpp"
#include "tests/support/worst_error.hpp"

#include <algorithm>

namespace mixbeam::rotation_test {
namespace {

using oracle::distance;
using oracle::Real;
using oracle::rotation_cases;
using oracle::RotationCase;
using test::kRounding;
using test::WorstError;

constexpr auto kPi = static_cast<double>(oracle::kPi);

// The bounds, in roundings of 1.1e-16, with what was measured with and without fused multiply-add in parentheses.

// k! c_k from the series: c_0 is reached over three steps c_k = 1/k! - x c_{k+2}, each with a factor of up to 10 (8).
constexpr double kStumpffError = 9 * kRounding;  // 1e-15, as stated in rotation.hpp
// k! c_k from cosine and sine, relative to 1 + angle: the square root of x turns by half a rounding of the angle (2.4).
constexpr double kStumpffFarError = 4 * kRounding;
// Entries of exp(psi) and T(psi), relative to 1 + angle: |psi|^2 carries three roundings (2.1).
constexpr double kExpError = 4 * kRounding;
// The same from a quaternion, whose rounding of the norm counts twice (2.7).
constexpr double kExpQuaternionError = 5 * kRounding;
// Quaternion of a matrix (5.3).
constexpr double kQuaternionOfError = 9 * kRounding;
// |q| after normalisation (2), its components (3.5).
constexpr double kNormError = 3 * kRounding;
constexpr double kNormalizedError = 6 * kRounding;
// Vector part of the quaternion of a tiny rotation, relative to the rotation (2.9).
constexpr double kTinyError = 5 * kRounding;
// log against atan2 with 64-bit mantissas, relative to the result (2.5).
constexpr double kLogError = 4 * kRounding;
// log(exp(psi)) relative to psi (3.3) and exp(log(q)) (4.5).
constexpr double kRoundTripError = 7 * kRounding;
// Products that must be equal, or the identity: two matrices with their errors (18).
constexpr double kProductError = 27 * kRounding;
// T^-1, relative to its norm and to 1 + angle: |psi|^2 again (6.8 at 6 rad, where T is nearly singular).
constexpr double kInverseError = 11 * kRounding;

double factorial(int n) { return std::tgamma(n + 1.0); }

// ---- Stumpff

std::vector<double> squared_angles() {
  std::vector<double> x;
  for (const double angle : oracle::angles()) x.push_back(angle * angle);
  for (int i = 0; i <= 1000; ++i) x.push_back(2.0 * kStumpffSeriesLimit * i / 1000);
  x.push_back(kStumpffSeriesLimit);
  x.push_back(std::nextafter(kStumpffSeriesLimit, 1e3));
  return x;
}

/// Largest error of `c(x)[k]` among the arguments that `included` accepts.
template <class Function, class Filter>
WorstError stumpff_error(Function c, Filter included) {
  WorstError worst;
  for (const double x : squared_angles()) {
    if (!included(x)) continue;
    const auto values = c(x);
    const auto exact = oracle::stumpff(Real(x), x);
    const double scale = x <= kStumpffSeriesLimit ? 1.0 : 1.0 + std::sqrt(x);
    for (int k = 0; k < 8; ++k) {
      const auto error = static_cast<double>(std::abs(values[k] - exact[static_cast<std::size_t>(k)]));
      worst.see(error * factorial(k) / scale, "c_", k, "(", x, ")");
    }
  }
  return worst;
}

TEST(Stumpff, ValuesOfTheSeries) {
  const auto near = [](double x) { return x <= kStumpffSeriesLimit; };
  EXPECT_TRUE(stumpff_error(stumpff<double>, near).at_most(kStumpffError));
}

TEST(Stumpff, ValuesOfTheClosedForms) {
  const auto far = [](double x) { return x > kStumpffSeriesLimit; };
  EXPECT_TRUE(stumpff_error(stumpff<double>, far).at_most(kStumpffFarError));
}

TEST(Stumpff, TextbookFormulasFailTheSameBound) {
  // (1 - cos a) / a^2 and its kin below the switch.
  const auto textbook = [](double x) {
    StumpffValues<double> s{};
    const double a = std::sqrt(x);
    s.c[0] = std::cos(a);
    s.c[1] = x > 0.0 ? std::sin(a) / a : 1.0;
    for (int k = 2; k < 8; ++k) s.c[k] = x > 0.0 ? (1.0 / factorial(k - 2) - s.c[k - 2]) / x : 1.0 / factorial(k);
    return s;
  };
  const auto tiny = [](double x) { return x < 1e-3; };
  EXPECT_FALSE(stumpff_error(textbook, tiny).at_most(kStumpffError));
}

TEST(Stumpff, AShorterSeriesFailsTheSameBound) {
  const auto ten_terms = [](double x) {
    StumpffValues<double> s{};
    s.c[6] = s.c[7] = 1.0;
    for (int j = 9; j > 0; --j) {
      s.c[6] = 1.0 - x * s.c[6] / ((2.0 * j + 5.0) * (2.0 * j + 6.0));
      s.c[7] = 1.0 - x * s.c[7] / ((2.0 * j + 6.0) * (2.0 * j + 7.0));
    }
    for (int k = 7; k >= 0; --k) s.c[k] = k > 5 ? s.c[k] / factorial(k) : 1.0 / factorial(k) - x * s.c[k + 2];
    return s;
  };
  const auto near = [](double x) { return x <= kStumpffSeriesLimit; };
  EXPECT_FALSE(stumpff_error(ten_terms, near).at_most(kStumpffError));
}

// ---- quaternions

Quaternion<double> negative(const Quaternion<double>& q) { return {-q.w, -q.x, -q.y, -q.z}; }

/// q and -q are the same rotation.
double rotation_distance(const Quaternion<double>& a, const Quaternion<double>& b) {
  return std::min(distance(a, b), distance(a, negative(b)));
}

double norm_of(const Quaternion<double>& q) {
  return static_cast<double>(std::sqrt(Real(q.w) * q.w + Real(q.x) * q.x + Real(q.y) * q.y + Real(q.z) * q.z));
}

TEST(Quaternion, IdentityIsExact) {
  const Quaternion<double> one = identity_quaternion<double>();
  EXPECT_EQ(distance(rotation_matrix(one), identity_matrix<double>()), 0.0);
  const Quaternion<double> q = exp_quaternion(Vec3<double>{{0.3, -0.2, 0.9}});
  EXPECT_EQ(distance(one * q, q), 0.0);
  EXPECT_EQ(distance(q * one, q), 0.0);
}

TEST(Quaternion, ProductAndConjugateAreThoseOfTheMatrices) {
  const std::vector<RotationCase> cases = rotation_cases();
  WorstError product, inverse;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const RotationCase &a = cases[i], &b = cases[(7 * i + 3) % cases.size()];
    const Quaternion<double> qa = exp_quaternion(a.psi), qb = exp_quaternion(b.psi);
    const Mat3<double> Ra = rotation_matrix(qa), Rb = rotation_matrix(qb);
    product.see(distance(rotation_matrix(qa * qb), Ra * Rb), a, " times ", b);
    inverse.see(distance(rotation_matrix(conjugate(qa)), transpose(Ra)), a);
  }
  EXPECT_TRUE(product.at_most(kProductError));
  EXPECT_TRUE(inverse.at_most(0.0));
}

TEST(Quaternion, NormalizedHasUnitLengthAndTheSameDirection) {
  WorstError length, direction;
  for (const RotationCase& c : rotation_cases())
    for (const double factor : {1e-100, 0.7, 1.0 + 1e-9, 1e100}) {
      const Quaternion<double> q = exp_quaternion(c.psi);
      const Quaternion<double> n =
          normalized(Quaternion<double>{factor * q.w, factor * q.x, factor * q.y, factor * q.z});
      length.see(std::abs(norm_of(n) - 1.0), c, ", factor ", factor);
      direction.see(distance(n, q), c, ", factor ", factor);
    }
  EXPECT_TRUE(length.at_most(kNormError));
  EXPECT_TRUE(direction.at_most(kNormalizedError));
}

/// Largest error of matrix -> quaternion among all cases.
template <class Function>
WorstError quaternion_of_error(Function quaternion_from) {
  WorstError worst;
  for (const RotationCase& c : rotation_cases()) {
    const Quaternion<double> q = exp_quaternion(c.psi);
    worst.see(rotation_distance(quaternion_from(rotation_matrix(q)), q), c);
  }
  return worst;
}

TEST(Quaternion, OfAMatrix) { EXPECT_TRUE(quaternion_of_error(quaternion_of<double>).at_most(kQuaternionOfError)); }

TEST(Quaternion, OfAMatrixByTheTraceFailsNextToPi) {
  const auto by_trace = [](const Mat3<double>& m) {
    const double w = 0.5 * std::sqrt(std::max(1.0 + m(0, 0) + m(1, 1) + m(2, 2), 1e-300)), f = 0.25 / w;
    return Quaternion<double>{w, f * (m(2, 1) - m(1, 2)), f * (m(0, 2) - m(2, 0)), f * (m(1, 0) - m(0, 1))};
  };
  EXPECT_FALSE(quaternion_of_error(by_trace).at_most(kQuaternionOfError));
}

TEST(Quaternion, OfAMatrixTakesEveryBranch) {
  // Half turns about the axes and the identity: each has one component only.
  for (const Quaternion<double>& q : {Quaternion<double>{1, 0, 0, 0}, Quaternion<double>{0, 1, 0, 0},
                                      Quaternion<double>{0, 0, 1, 0}, Quaternion<double>{0, 0, 0, 1}})
    EXPECT_EQ(rotation_distance(quaternion_of(rotation_matrix(q)), q), 0.0);
}

// ---- exponential

TEST(Exp, MatrixAndTangentMapAreThePowerSeries) {
  WorstError rotation, tangent;
  for (const RotationCase& c : rotation_cases()) {
    const auto exact = oracle::exponential(oracle::to_long(c.psi), c.angle);
    rotation.see(distance(exp_matrix(c.psi), exact.rotation) / (1.0 + c.angle), c);
    tangent.see(distance(tangent_map(c.psi), exact.tangent) / (1.0 + c.angle), c);
  }
  EXPECT_TRUE(rotation.at_most(kExpError));
  EXPECT_TRUE(tangent.at_most(kExpError));
}

TEST(Exp, QuaternionIsThePowerSeries) {
  WorstError rotation, length;
  for (const RotationCase& c : rotation_cases()) {
    const Quaternion<double> q = exp_quaternion(c.psi);
    const auto exact = oracle::exponential(oracle::to_long(c.psi), c.angle);
    rotation.see(distance(rotation_matrix(q), exact.rotation) / (1.0 + c.angle), c);
    length.see(std::abs(norm_of(q) - 1.0), c);
  }
  EXPECT_TRUE(rotation.at_most(kExpQuaternionError));
  EXPECT_TRUE(length.at_most(kNormError));
}

TEST(Exp, TinyRotationsKeepAllDigits) {
  // Relative to the rotation itself, not to the identity: that is what a matrix would lose.
  WorstError worst;
  for (const RotationCase& c : rotation_cases(1e-2)) {
    if (c.angle == 0.0) continue;
    const Real half = 0.5L * oracle::length(c.psi);
    const Quaternion<double> q = exp_quaternion(c.psi);
    const Vec3<Real> exact = (0.5L * std::sin(half) / half) * oracle::to_long(c.psi);
    worst.see(distance(Vec3<double>{{q.x, q.y, q.z}}, exact) / static_cast<double>(half), c);
  }
  EXPECT_TRUE(worst.at_most(kTinyError));
}

TEST(Exp, OfTheNegativeIsTheInverse) {
  WorstError matrices, quaternions;
  for (const RotationCase& c : rotation_cases()) {
    matrices.see(distance(exp_matrix(c.psi) * exp_matrix(-c.psi), identity_matrix<double>()), c);
    quaternions.see(rotation_distance(exp_quaternion(c.psi) * exp_quaternion(-c.psi), identity_quaternion<double>()),
                    c);
  }
  EXPECT_TRUE(matrices.at_most(kProductError));
  EXPECT_TRUE(quaternions.at_most(kProductError));
}

// ---- logarithm

/// Largest relative error of log(q) against 64-bit mantissas.
template <class Function>
WorstError log_error(Function log, double largest_angle = 1e3) {
  WorstError worst;
  for (const RotationCase& c : rotation_cases(largest_angle)) {
    if (c.angle == 0.0) continue;
    const Quaternion<double> q = exp_quaternion(c.psi);
    const Vec3<Real> exact = oracle::logarithm(q);
    const auto size = static_cast<double>(std::hypot(exact[0], exact[1], exact[2]));
    worst.see(size > 0.0 ? distance(log(q), exact) / size : distance(log(q), exact), c);
  }
  return worst;
}

TEST(Log, Values) { EXPECT_TRUE(log_error(log_quaternion<double>).at_most(kLogError)); }

/// Angle by the arc cosine of the trace times the axis of the skew part: the textbook.
Vec3<double> log_by_arc_cosine(const Quaternion<double>& q) {
  const Mat3<double> m = rotation_matrix(q);
  const Vec3<double> skew{{m(2, 1) - m(1, 2), m(0, 2) - m(2, 0), m(1, 0) - m(0, 1)}};
  return (std::acos(std::clamp(0.5 * (m(0, 0) + m(1, 1) + m(2, 2) - 1.0), -1.0, 1.0)) / norm(skew)) * skew;
}

TEST(Log, ByArcCosineFailsNextToZeroAndPi) {
  const auto error = [](double angle) {
    const Quaternion<double> q = exp_quaternion(angle * oracle::axes().back());
    return distance(log_by_arc_cosine(q), oracle::logarithm(q)) / angle;
  };
  EXPECT_LE(error(1.0), 2 * kLogError);  // it is a logarithm
  EXPECT_GT(error(1e-4), 1e4 * kLogError);
  EXPECT_GT(error(1e-8), 0.1);  // no digit left
  EXPECT_GT(error(kPi - 1e-8), 1e6 * kLogError);
}

TEST(Log, AShorterSeriesFailsTheSameBound) {
  const auto five_terms = [](const Quaternion<double>& q) {
    const Vec3<double> v{{q.x, q.y, q.z}};
    const double t = dot(v, v) / (q.w * q.w);
    if (!(t < kLogSeriesLimit)) return log_quaternion(q);
    return (2.0 / q.w * (1.0 - t * (1.0 / 3 - t * (1.0 / 5 - t * (1.0 / 7 - t / 9))))) * v;
  };
  const double at_the_switch = 2.0 * std::atan(std::sqrt(kLogSeriesLimit));
  EXPECT_FALSE(log_error(five_terms, at_the_switch).at_most(kLogError));
}

TEST(Log, BothBranchesAgreeAtTheSwitch) {
  for (const double off : {-1e-15, 1e-15}) {
    const double t = kLogSeriesLimit * (1.0 + off), n = std::sqrt(t / (1.0 + t)), w = 1.0 / std::sqrt(1.0 + t);
    const double angle = log_quaternion(Quaternion<double>{w, 0.0, n, 0.0})[1];
    EXPECT_NEAR(angle, 2.0 * std::atan(std::sqrt(kLogSeriesLimit)), 1e-15 * angle);
  }
}

TEST(Log, OfTheIdentityIsExactlyZero) {
  EXPECT_EQ(norm(log_quaternion(identity_quaternion<double>())), 0.0);
  EXPECT_EQ(norm(log_quaternion(negative(identity_quaternion<double>()))), 0.0);
}

TEST(Log, OfAHalfTurn) {
  const Vec3<double> psi = log_quaternion(Quaternion<double>{0.0, 0.6, 0.0, -0.8});
  EXPECT_LE(distance(psi, kPi * Vec3<double>{{0.6, 0.0, -0.8}}), kPi * kLogError);
}

TEST(Log, TakesTheShorterWay) {
  WorstError sign, size;
  for (const RotationCase& c : rotation_cases()) {
    const Quaternion<double> q = exp_quaternion(c.psi);
    const Vec3<double> psi = log_quaternion(q);
    if (q.w != 0.0) sign.see(distance(log_quaternion(negative(q)), psi), c);
    size.see(std::max(0.0, static_cast<double>(oracle::length(psi) / oracle::kPi) - 1.0), c);
  }
  EXPECT_TRUE(sign.at_most(0.0));
  EXPECT_TRUE(size.at_most(kLogError));
}

TEST(Log, InvertsExpBelowPi) {
  // Next to pi, rounding may cross it: there -psi (plus a full turn) is the answer, and no one can tell.
  WorstError worst;
  for (const RotationCase& c : rotation_cases()) {
    if (!c.is_below_pi()) continue;
    const Vec3<double> psi = log_quaternion(exp_quaternion(c.psi));
    double error = distance(psi, c.psi);
    if (c.angle > kPi - 4 * kRounding * kPi) error = std::min(error, distance(psi, -c.psi));
    worst.see(c.angle == 0.0 ? error : error / c.exact_angle(), c);
  }
  EXPECT_TRUE(worst.at_most(kRoundTripError));
}

TEST(Log, RemovesFullTurnsAbovePi) {
  WorstError worst;
  for (const RotationCase& c : rotation_cases()) {
    const Real angle = oracle::length(c.psi), rest = std::remainder(angle, 2.0L * oracle::kPi);
    if (c.is_below_pi() || std::abs(rest) > oracle::kPi - 1e-12L) continue;
    const Vec3<Real> expected = (rest / angle) * oracle::to_long(c.psi);
    worst.see(distance(log_quaternion(exp_quaternion(c.psi)), expected) / c.angle, c);
  }
  EXPECT_TRUE(worst.at_most(kRoundTripError));
}

TEST(Log, ExpInvertsIt) {
  WorstError worst;
  for (const RotationCase& c : rotation_cases()) {
    const Quaternion<double> q = exp_quaternion(c.psi);
    worst.see(rotation_distance(exp_quaternion(log_quaternion(q)), q), c);
  }
  EXPECT_TRUE(worst.at_most(kRoundTripError));
}

// ---- tangent map

// T^-1 is singular at 2 pi.
constexpr double kLargestInverseAngle = 6.0;

double largest_entry(const Mat3<Real>& m) { return distance(m, zero_matrix<Real>()); }

TEST(InverseTangentMap, IsTheInverse) {
  WorstError value, product;
  for (const RotationCase& c : rotation_cases(kLargestInverseAngle)) {
    const Mat3<double> inverse = inverse_tangent_map(c.psi);
    const Mat3<Real> exact = oracle::inverse(oracle::exponential(oracle::to_long(c.psi), c.angle).tangent);
    const double scale = largest_entry(exact) * (1.0 + c.angle);
    value.see(distance(inverse, exact) / scale, c);
    product.see(distance(tangent_map(c.psi) * inverse, identity_matrix<double>()) / scale, c);
  }
  EXPECT_TRUE(value.at_most(kInverseError));
  EXPECT_TRUE(product.at_most(kInverseError));
}

}  // namespace
}  // namespace mixbeam::rotation_test
