/// Derivatives of rotation.hpp, by hand in the header and by automatic differentiation through its functions, against
/// automatic differentiation of the power series in rotation_oracle.hpp. All regimes of the angle, zero included.
#include "kernels/math/rotation.hpp"

#include "tests/kernels/rotation_oracle.hpp"
#include "tests/support/worst_error.hpp"

#include <algorithm>
#include <type_traits>
#include <utility>

namespace mixbeam {
namespace {

using oracle::constant;
using oracle::distance;
using oracle::Real;
using oracle::rotation_cases;
using oracle::RotationCase;
using test::kRounding;
using test::WorstError;

constexpr auto kPi = static_cast<double>(oracle::kPi);
constexpr double kAllAngles = 1e3;

// The bounds, in roundings of 1.1e-16, with what was measured with and without fused multiply-add in parentheses. Maps
// and their derivatives act on unit vectors and are compared relative to 1 + angle, the growth of the rounding of
// |psi|^2.

// exp_matrix, tangent_map and the derivative by hand of the latter: value, first and second derivative (2.7).
constexpr double kExpError = 4 * kRounding;
// One quaternion between psi and the matrix (5.6), and a product of two of them (9.2).
constexpr double kQuaternionError = 8 * kRounding;
constexpr double kProductError = 14 * kRounding;
// T^-T up to pi and the derivative of it by hand (1.2).
constexpr double kInverseError = 2 * kRounding;
// log(exp(psi)): the identity (2.8). Its second derivative by automatic differentiation divides by the square of the
// vector part, 0.05 just above the switch to atan2 (27).
constexpr double kLogError = 4 * kRounding;
constexpr double kLogSecondError = 42 * kRounding;
// The forms a.F(psi)b: gradient, and Hessian relative to (1 + angle)^2, because the second derivatives of the
// coefficients are differences of larger numbers after many turns (2.2).
constexpr double kFormError = 4 * kRounding;
// First and second derivatives of k! c_k (7.2, just above the switch to cosine and sine).
constexpr double kStumpffSlopeError = 11 * kRounding;
// The coefficient of T^-1 (2.3); its derivative is a difference of numbers up to 2.5 times as large (10.8).
constexpr double kCoefficientError = 4 * kRounding;
constexpr double kCoefficientSlopeError = 16 * kRounding;
// Spin by automatic differentiation: a product of two matrices (2.2).
constexpr double kSpinError = 4 * kRounding;

// ---- value, gradient, Hessian of a map

template <class Number>
using First = Sacado::Fad::SFad<Number, 3>;
template <class Number>
using Second = Sacado::Fad::SFad<First<Number>, 3>;

/// psi as independent variables.
template <class Number>
Vec3<First<Number>> first_order(const Vec3<double>& psi) {
  Vec3<First<Number>> v;
  for (int i = 0; i < 3; ++i) v[i] = First<Number>(3, i, Number(psi[i]));
  return v;
}
template <class Number>
Vec3<Second<Number>> second_order(const Vec3<double>& psi) {
  Vec3<Second<Number>> v;
  for (int i = 0; i < 3; ++i) v[i] = Second<Number>(3, i, First<Number>(3, i, Number(psi[i])));
  return v;
}

template <class Number>
Mat3<Number> jacobian(const Vec3<First<Number>>& f) {
  Mat3<Number> m;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) m(i, j) = f[i].dx(j);
  return m;
}
template <class Number>
Vec3<Number> gradient(const First<Number>& f) {
  return {{f.dx(0), f.dx(1), f.dx(2)}};
}
template <class Number>
Mat3<Number> hessian(const Second<Number>& f) {
  Mat3<Number> m;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) m(i, j) = f.dx(i).dx(j);
  return m;
}

/// Errors of a map R^3 -> R^3 and of its first and second derivatives by automatic differentiation.
struct MapErrors {
  WorstError value, first, second;
  testing::AssertionResult within(double bound) const {
    const auto v = value.at_most(bound), f = first.at_most(bound), s = second.at_most(bound);
    if (!v) return testing::AssertionFailure() << "value: " << v.message();
    if (!f) return testing::AssertionFailure() << "first derivative: " << f.message();
    return s ? s : testing::AssertionFailure() << "second derivative: " << s.message();
  }
};

template <class Code, class Exact>
void compare(const Code& code, const Exact& exact, const RotationCase& c, double scale, MapErrors& errors) {
  const Vec3<Second<double>> f = code(second_order<double>(c.psi));
  const Vec3<Second<Real>> g = exact(second_order<Real>(c.psi), c.angle);
  for (int i = 0; i < 3; ++i) {
    const Vec3<double> slope{{f[i].val().dx(0), f[i].val().dx(1), f[i].val().dx(2)}};
    const Vec3<Real> exact_slope{{g[i].val().dx(0), g[i].val().dx(1), g[i].val().dx(2)}};
    errors.value.see(static_cast<double>(std::abs(f[i].val().val() - g[i].val().val())) / scale, c);
    errors.first.see(distance(slope, exact_slope) / scale, c);
    errors.second.see(distance(hessian(f[i]), hessian(g[i])) / scale, c);
  }
}

template <class Code, class Exact>
MapErrors compare_everywhere(const Code& code, const Exact& exact, double largest_angle = kAllAngles) {
  MapErrors errors;
  for (const RotationCase& c : rotation_cases(largest_angle)) compare(code, exact, c, 1.0 + c.angle, errors);
  return errors;
}

constexpr Vec3<double> kA{{0.36, -0.48, 0.8}}, kB{{-0.6, 0.64, 0.48}};  // unit vectors, any will do

template <class Vector>
using ScalarOf = std::decay_t<decltype(std::declval<Vector>()[0])>;

template <class Vector>
Vector vector_a(const Vector&) {
  return constant<ScalarOf<Vector>>(kA);
}

// The same maps by the power series.
const auto exact_exp = [](const auto& psi, double angle) {
  return oracle::exponential(psi, angle).rotation * vector_a(psi);
};
const auto exact_tangent = [](const auto& psi, double angle) {
  return oracle::exponential(psi, angle).tangent * vector_a(psi);
};
const auto exact_inverse_tangent_transpose = [](const auto& psi, double angle) {
  return transpose_times(oracle::inverse(oracle::exponential(psi, angle).tangent), vector_a(psi));
};
const auto itself = [](const auto& psi, double) { return psi; };

// ---- automatic differentiation through the code

TEST(RotationSacado, ExpMatrix) {
  const auto code = [](const auto& psi) { return exp_matrix(psi) * vector_a(psi); };
  EXPECT_TRUE(compare_everywhere(code, exact_exp).within(kExpError));
}

TEST(RotationSacado, ExpQuaternion) {
  const auto code = [](const auto& psi) { return rotation_matrix(exp_quaternion(psi)) * vector_a(psi); };
  EXPECT_TRUE(compare_everywhere(code, exact_exp).within(kQuaternionError));
}

TEST(RotationSacado, QuaternionOfAMatrix) {
  const auto code = [](const auto& psi) { return rotation_matrix(quaternion_of(exp_matrix(psi))) * vector_a(psi); };
  EXPECT_TRUE(compare_everywhere(code, exact_exp).within(kQuaternionError));
}

TEST(RotationSacado, ProductAndConjugate) {
  // exp(psi / 2) exp(-psi / 2)^-1 = exp(psi)
  const auto code = [](const auto& psi) {
    const auto half = 0.5 * psi;
    return rotation_matrix(exp_quaternion(half) * conjugate(exp_quaternion(-half))) * vector_a(psi);
  };
  EXPECT_TRUE(compare_everywhere(code, exact_exp).within(kProductError));
}

TEST(RotationSacado, TangentMap) {
  const auto code = [](const auto& psi) { return tangent_map(psi) * vector_a(psi); };
  EXPECT_TRUE(compare_everywhere(code, exact_tangent).within(kExpError));
}

TEST(RotationSacado, InverseTangentMap) {
  const auto code = [](const auto& phi) { return transpose_times(inverse_tangent_map(phi), vector_a(phi)); };
  EXPECT_TRUE(compare_everywhere(code, exact_inverse_tangent_transpose, kPi).within(kInverseError));
}

TEST(RotationSacado, LogOfExpIsTheIdentityMap) {
  // Value psi, first derivative the identity, second derivative zero; where exp and log are each strongly curved.
  const auto code = [](const auto& psi) { return log_quaternion(exp_quaternion(psi)); };
  const MapErrors errors = compare_everywhere(code, itself, kPi - 1e-14);
  EXPECT_TRUE(errors.value.at_most(kLogError));
  EXPECT_TRUE(errors.first.at_most(kLogError));
  EXPECT_TRUE(errors.second.at_most(kLogSecondError));
}

TEST(RotationSacado, ExpressionsAtExactlyZero) {
  const Vec3<Second<double>> zero = second_order<double>({{0, 0, 0}});
  const Vec3<Second<double>> psi = log_quaternion(exp_quaternion(zero));
  const Vec3<Second<double>> rotated = exp_matrix(zero) * vector_a(zero), spin = tangent_map(zero) * vector_a(zero);
  const Vec3<Second<double>> inverse = inverse_tangent_map(zero) * vector_a(zero);
  const Mat3<double> I = identity_matrix<double>(), cross_a = hat(kA);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      EXPECT_EQ(psi[i].dx(j).val(), I(i, j));
      EXPECT_EQ(rotated[i].dx(j).val(), -cross_a(i, j));
      EXPECT_EQ(spin[i].dx(j).val(), -0.5 * cross_a(i, j));
      EXPECT_EQ(inverse[i].dx(j).val(), 0.5 * cross_a(i, j));
      EXPECT_EQ(hessian(exp_quaternion(zero).w)(i, j), -0.25 * I(i, j));
      for (int k = 0; k < 3; ++k) EXPECT_EQ(psi[k].dx(i).dx(j), 0.0);
    }
}

// ---- derivatives of the header

/// Largest difference of a Jacobian by hand, `code(psi)`, and that of `exact` by automatic differentiation.
template <class Code, class Exact>
WorstError jacobian_error(const Code& code, const Exact& exact, double smallest_angle, double largest_angle) {
  WorstError worst;
  for (const RotationCase& c : rotation_cases(largest_angle)) {
    if (c.angle < smallest_angle) continue;
    const Mat3<Real> expected = jacobian(exact(first_order<Real>(c.psi), c.angle));
    worst.see(distance(code(c.psi), expected) / (1.0 + c.angle), c);
  }
  return worst;
}

TEST(RotationDerivatives, TangentMap) {
  const auto code = [](const Vec3<double>& psi) { return tangent_map_derivative(psi, kA, stumpff(dot(psi, psi))); };
  EXPECT_TRUE(jacobian_error(code, exact_tangent, 0.0, kAllAngles).at_most(kExpError));
}

TEST(RotationDerivatives, TangentMapWithTextbookSlopesFails) {
  // The slopes of (1 - cos a) / a^2 and (a - sin a) / a^3 from the closed forms.
  const auto code = [](const Vec3<double>& psi) {
    const double x = dot(psi, psi), a = std::sqrt(x);
    StumpffValues<double> c = stumpff(x);
    const double slope2 = (a * std::sin(a) - 2.0 * (1.0 - std::cos(a))) / (2.0 * x * x);
    const double slope3 = (3.0 * std::sin(a) - a * (2.0 + std::cos(a))) / (2.0 * x * x * a);
    c.c[4] = slope2 + 0.5 * c[3];            // c_2' = c_4 - c_3 / 2
    c.c[5] = (2.0 * slope3 + c.c[4]) / 3.0;  // c_3' = (3 c_5 - c_4) / 2
    return tangent_map_derivative(psi, kA, c);
  };
  EXPECT_TRUE(jacobian_error(code, exact_tangent, 2.0, 6.0).at_most(2 * kExpError));
  EXPECT_FALSE(jacobian_error(code, exact_tangent, 1e-4, 1e-4).at_most(1e4 * kExpError));
}

TEST(RotationDerivatives, InverseTangentTranspose) {
  const auto code = [](const Vec3<double>& phi) {
    return inverse_tangent_transpose_derivative(phi, kA, inverse_tangent_coefficient(dot(phi, phi)));
  };
  EXPECT_TRUE(jacobian_error(code, exact_inverse_tangent_transpose, 0.0, kPi).at_most(kInverseError));
}

TEST(RotationDerivatives, InverseTangentTransposeWithConstantCoefficientFails) {
  const auto code = [](const Vec3<double>& phi) {
    InverseTangentCoefficient<double> d = inverse_tangent_coefficient(dot(phi, phi));
    d.derivative = 0.0;  // no difference at zero, hardly one at small angles
    return inverse_tangent_transpose_derivative(phi, kA, d);
  };
  EXPECT_TRUE(jacobian_error(code, exact_inverse_tangent_transpose, 0.0, 1e-8).at_most(kInverseError));
  EXPECT_FALSE(jacobian_error(code, exact_inverse_tangent_transpose, 1e-4, kPi).at_most(kInverseError));
}

/// a^T F(psi) b with F = exp(psi)^T (first = 1) or T(psi)^T (first = 2).
template <class S>
S rotation_form(int first, const Vec3<S>& psi, double angle) {
  const auto exact = oracle::exponential(psi, angle);
  return dot(constant<S>(kA), transpose_times(first == 1 ? exact.rotation : exact.tangent, constant<S>(kB)));
}

class RotationForm : public testing::TestWithParam<int> {};

TEST_P(RotationForm, GradientAndHessian) {
  const int first = GetParam();
  WorstError slope, curvature, symmetry;
  for (const RotationCase& c : rotation_cases()) {
    const StumpffValues<double> values = stumpff(dot(c.psi, c.psi));
    const Mat3<double> H = rotation_form_hessian(first, kA, kB, c.psi, values);
    const Second<Real> exact = rotation_form(first, second_order<Real>(c.psi), c.angle);
    const double scale = 1.0 + c.angle;
    slope.see(distance(rotation_form_gradient(first, kA, kB, c.psi, values), gradient(exact.val())) / scale, c);
    curvature.see(distance(H, hessian(exact)) / (scale * scale), c);
    symmetry.see(distance(H, transpose(H)) / (scale * scale), c);
  }
  EXPECT_TRUE(slope.at_most(kFormError));
  EXPECT_TRUE(curvature.at_most(kFormError));
  EXPECT_TRUE(symmetry.at_most(kFormError));
}

TEST_P(RotationForm, TransposedFails) {
  // b^T F a instead of a^T F b: the sign of the part that is odd in psi.
  const int first = GetParam();
  WorstError slope, curvature;
  for (const RotationCase& c : rotation_cases()) {
    const StumpffValues<double> values = stumpff(dot(c.psi, c.psi));
    const Second<Real> exact = rotation_form(first, second_order<Real>(c.psi), c.angle);
    slope.see(distance(rotation_form_gradient(first, kB, kA, c.psi, values), gradient(exact.val())), c);
    curvature.see(distance(rotation_form_hessian(first, kB, kA, c.psi, values), hessian(exact)), c);
  }
  EXPECT_FALSE(slope.at_most(kFormError));
  EXPECT_FALSE(curvature.at_most(kFormError));
}

TEST_P(RotationForm, WithAutomaticallyDifferentiatedArguments) {
  // The Hessian by hand is the derivative of the gradient by hand, at zero as well.
  const int first = GetParam();
  WorstError worst;
  for (const RotationCase& c : rotation_cases()) {
    const Vec3<First<double>> psi = first_order<double>(c.psi);
    const auto a = constant<First<double>>(kA), b = constant<First<double>>(kB);
    const auto slope = rotation_form_gradient(first, a, b, psi, stumpff(dot(psi, psi)));
    const Mat3<double> H = rotation_form_hessian(first, kA, kB, c.psi, stumpff(dot(c.psi, c.psi)));
    worst.see(distance(jacobian(slope), H) / ((1.0 + c.angle) * (1.0 + c.angle)), c);
  }
  EXPECT_TRUE(worst.at_most(kFormError));
}

INSTANTIATE_TEST_SUITE_P(Exp, RotationForm, testing::Values(1));
INSTANTIATE_TEST_SUITE_P(TangentMap, RotationForm, testing::Values(2));

// ---- coefficients

TEST(StumpffDerivatives, FirstAndSecond) {
  WorstError first, second;
  for (const double angle : oracle::angles()) {
    const double x = angle * angle;
    using One = Sacado::Fad::SFad<Real, 1>;
    using Two = Sacado::Fad::SFad<One, 1>;
    const auto exact = oracle::stumpff(Two(1, 0, One(1, 0, Real(x))), x);
    const StumpffValues<double> values = stumpff(x);
    for (int k = 0; k <= 5; ++k) {  // the slope at zero is -k! / (k + 2)! times c_k(0) = 1 / k!
      const double scale = (1.0 + angle) / std::tgamma(k + 3.0);
      const auto& e = exact[static_cast<std::size_t>(k)];
      first.see(static_cast<double>(std::abs(values.first_derivative(k) - e.val().dx(0))) / scale, "c_", k,
                "', x = ", x);
      if (k <= 3)
        second.see(static_cast<double>(std::abs(values.second_derivative(k) - e.dx(0).dx(0))) / scale, "c_", k,
                   "'', x = ", x);
    }
  }
  EXPECT_TRUE(first.at_most(kStumpffSlopeError));
  EXPECT_TRUE(second.at_most(kStumpffSlopeError));
}

/// d = (1 - y cot y) / (4 y^2), y = |phi| / 2, as a function of x = |phi|^2: below 1/2 by Bernoulli numbers,
/// y cot y = 1 - y^2/3 - y^4/45 - ... (Abramowitz and Stegun 4.3.70), d = sum |B_2n| x^(n-1) / (2n)!.
template <class S>
S exact_coefficient(const S& x, double angle) {
  using std::cos;
  using std::sin;
  using std::sqrt;
  if (angle > 0.5) {
    const S y = S(0.5) * sqrt(x);
    return (S(1.0) - y * cos(y) / sin(y)) / x;
  }
  const std::array<Real, 9> bernoulli = {1.0L / 6,      1.0L / 30, 1.0L / 42,     1.0L / 30,     5.0L / 66,
                                         691.0L / 2730, 7.0L / 6,  3617.0L / 510, 43867.0L / 798};
  S sum = 0.0, power = 1.0;
  Real factorial = 1.0L;
  for (std::size_t n = 1; n <= bernoulli.size(); ++n) {
    factorial *= static_cast<Real>((2 * n - 1) * (2 * n));
    sum += S(bernoulli[n - 1] / factorial) * power;
    power *= x;
  }
  return sum;
}

TEST(InverseTangentCoefficient, ValueAndDerivative) {
  WorstError value, slope;
  for (const double angle : oracle::angles()) {
    if (angle > kPi) continue;
    const double x = angle * angle;
    const auto exact = exact_coefficient(Sacado::Fad::SFad<Real, 1>(1, 0, Real(x)), angle);
    const InverseTangentCoefficient<double> d = inverse_tangent_coefficient(x);
    value.see(static_cast<double>(std::abs(d.value / exact.val() - 1.0L)), "angle ", angle);
    slope.see(static_cast<double>(std::abs(d.derivative / exact.dx(0) - 1.0L)), "angle ", angle);
  }
  EXPECT_TRUE(value.at_most(kCoefficientError));
  EXPECT_TRUE(slope.at_most(kCoefficientSlopeError));
}

TEST(InverseTangentCoefficient, TextbookFormulaFailsTheSameBound) {
  const double a = 1e-4, textbook = (1.0 - 0.5 * a / std::tan(0.5 * a)) / (a * a);
  EXPECT_GT(std::abs(12.0 * textbook - 1.0), 1e4 * kCoefficientError);
}

TEST(InverseTangentCoefficient, AtExactlyZero) {
  const InverseTangentCoefficient<double> d = inverse_tangent_coefficient(0.0);
  EXPECT_NEAR(d.value, 1.0 / 12, kCoefficientError / 12);
  EXPECT_NEAR(d.derivative, 1.0 / 720, kCoefficientSlopeError / 720);
  const auto by_sacado = inverse_tangent_coefficient(First<double>(3, 0, 0.0));
  EXPECT_NEAR(by_sacado.value.dx(0), 1.0 / 720, kCoefficientSlopeError / 720);
  EXPECT_NEAR(by_sacado.derivative.dx(0), 1.0 / 15120, kCoefficientSlopeError / 15120);  // 2 |B_6| / 6!
}

// ---- tangent map and the group again

TEST(RotationDerivatives, TangentMapIsTheSpinOfExp) {
  // hat(T(psi) a) = (d exp(psi) . a) exp(psi)^T, all from the code; the material map T^T must fail.
  WorstError worst, twin;
  for (const RotationCase& c : rotation_cases()) {
    const Mat3<First<double>> R = exp_matrix(first_order<double>(c.psi));
    Mat3<double> value, change = zero_matrix<double>();
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        value(i, j) = R(i, j).val();
        for (int k = 0; k < 3; ++k) change(i, j) += R(i, j).dx(k) * kA[k];
      }
    const Mat3<double> spin = change * transpose(value), T = tangent_map(c.psi);
    worst.see(distance(hat(T * kA), spin) / (1.0 + c.angle), c);
    twin.see(distance(hat(transpose_times(T, kA)), spin) / (1.0 + c.angle), c);
  }
  EXPECT_TRUE(worst.at_most(kSpinError));
  EXPECT_FALSE(twin.at_most(kSpinError));
}

}  // namespace
}  // namespace mixbeam
