#include "discretization/stresses/rectangle_series.hpp"

#include "kernels/math/constants.hpp"

#include <cfloat>
#include <cmath>

namespace mixbeam {

namespace {

constexpr Complex kI{0.0, 1.0};

/// Below this |exp(w)| the power series is summed; above, the closed form and the rest.
constexpr double kSmall = 0.2;
constexpr int kPowerTerms = 24;  // 0.2^24 / 24^2 is 3e-20
constexpr double kNegligible = 1e-19;

/// Product without the treatment of infinities that the operator has.
Complex product_of(Complex a, Complex b) {
  return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}

struct Dilogarithm {
  Complex value{}, log{};  ///< Li2(z), log(1 - z)
};

/// Li2(u) by Bernoulli numbers in u = -log(1 - z), for |u| < 1.3: error below 1e-15.
Complex dilogarithm_series(Complex u) {
  static constexpr std::array<double, 10> c = {1.0 / 36.0,
                                               -1.0 / 3600.0,
                                               1.0 / 211680.0,
                                               -1.0 / 10886400.0,
                                               1.0 / 526901760.0,
                                               -4.0647616451442255e-11,
                                               8.9216910204564526e-13,
                                               -1.9939295860721076e-14,
                                               4.518980029619918e-16,
                                               -1.0356517612181247e-17};
  const Complex square = product_of(u, u);
  Complex sum = c.back();
  for (std::size_t k = c.size() - 1; k-- > 0;) sum = product_of(sum, square) + c[k];
  return u + product_of(square, product_of(sum, u) - 0.25);
}

/// Of z = exp(log_z), |z| <= 1, imaginary part of log_z in [-pi, pi]. At z = 1 the logarithm is cut off at a large
/// number: it is infinite there, its product with log z zero.
Dilogarithm dilogarithm(Complex log_z) {
  const double size = std::exp(log_z.real()), cosine = std::cos(log_z.imag()), sine = std::sin(log_z.imag());
  const double half_sine = std::sin(0.5 * log_z.imag());
  // 1 - z without cancellation near z = 1
  const double x = -std::expm1(log_z.real()) * cosine + 2.0 * half_sine * half_sine, y = -size * sine;
  const Complex log{0.5 * std::log(std::fmax(x * x + y * y, DBL_MIN)), std::atan2(y, x)};
  if (size * cosine <= 0.5) return {dilogarithm_series(-log), log};
  return {kPi * kPi / 6.0 - product_of(log_z, log) - dilogarithm_series(-log_z), log};
}

/// w plus an angle, with its imaginary part in [-pi, pi].
Complex turned_by(Complex w, double angle) {
  const double turned = w.imag() + angle;
  return {w.real(), turned - 2.0 * kPi * std::round(turned / (2.0 * kPi))};
}

Complex exponential_of(Complex w) {
  const double size = std::exp(w.real());
  return {size * std::cos(w.imag()), size * std::sin(w.imag())};
}

/// The sums without q: alternating: Li2(-e^w); odd: the inverse tangent integral of e^w.
AnalyticJet closed_sum(RectangleSeries::Kind kind, Complex w, Complex e) {
  if (kind == RectangleSeries::Kind::alternating) {
    const Dilogarithm d = dilogarithm(turned_by(w, kPi));
    return {d.value, -d.log, -e / (1.0 + e)};
  }
  const Dilogarithm plus = dilogarithm(turned_by(w, 0.5 * kPi)), minus = dilogarithm(turned_by(w, -0.5 * kPi));
  return {product_of(-0.5 * kI, plus.value - minus.value), product_of(0.5 * kI, plus.log - minus.log),
          e / (1.0 + product_of(e, e))};
}

/// (-1)^m / m^2 for m = 1, 2, ..., or (-1)^((m-1)/2) / m^2 for odd m and 0 for even ones.
double base_coefficient(RectangleSeries::Kind kind, int m) {
  if (kind == RectangleSeries::Kind::alternating) return (m % 2 == 0 ? 1.0 : -1.0) / (m * m);
  return m % 2 == 0 ? 0.0 : ((m - 1) / 2 % 2 == 0 ? 1.0 : -1.0) / (m * m);
}

/// Adds sum c_m e^m, and its derivatives by w.
void add_powers(const std::vector<double>& c, Complex e, bool derivatives, AnalyticJet& sum) {
  Complex value = 0.0, first = 0.0, second = 0.0;
  for (int m = static_cast<int>(c.size()); m > 0; --m) {
    value = product_of(value, e) + c[m - 1];
    if (!derivatives) continue;
    first = product_of(first, e) + m * c[m - 1];
    second = product_of(second, e) + m * m * c[m - 1];
  }
  sum.value += product_of(value, e);
  sum.first += product_of(first, e);
  sum.second += product_of(second, e);
}

}  // namespace

RectangleSeries::RectangleSeries(const Form& form) : form_(form) {
  const double sign = form.kind == Kind::odd_minus ? -1.0 : 1.0;
  double power = 1.0;
  for (int m = 1; m <= kPowerTerms; ++m) {
    power *= form.ratio;
    const double base = base_coefficient(form.kind, m), rest = -sign * power / (1.0 + sign * power);
    coefficients_.push_back(base * (1.0 + rest));
    if (power > kNegligible) rest_.push_back(base * rest);
  }
}

AnalyticJet RectangleSeries::sum(Complex w, bool derivatives) const {
  const Complex e = exponential_of(w);
  AnalyticJet sum;
  if (w.real() < std::log(kSmall)) {
    add_powers(coefficients_, e, derivatives, sum);
    return sum;
  }
  sum = closed_sum(form_.kind, w, e);
  add_powers(rest_, e, derivatives, sum);
  return sum;
}

Complex RectangleSeries::value(Complex z) const {
  const Complex along = product_of(form_.direction, z);
  return product_of(form_.amplitude, sum(form_.scale * (-form_.reach + along), false).value +
                                         form_.sign * sum(form_.scale * (-form_.reach - along), false).value);
}

AnalyticJet RectangleSeries::jet(Complex z) const {
  const Complex along = product_of(form_.direction, z), slope = form_.scale * form_.direction;
  const AnalyticJet plus = sum(form_.scale * (-form_.reach + along), true),
                    minus = sum(form_.scale * (-form_.reach - along), true);
  return {product_of(form_.amplitude, plus.value + form_.sign * minus.value),
          product_of(form_.amplitude, product_of(slope, plus.first - form_.sign * minus.first)),
          product_of(form_.amplitude, product_of(product_of(slope, slope), plus.second + form_.sign * minus.second))};
}

RectangleSeries RectangleSeries::of_torque(double b, double a, double j) {
  Form form;
  form.kind = Kind::odd_plus;
  form.sign = -1.0;
  const double narrow = std::fmin(a, b);
  form.reach = std::fmax(a, b);
  form.scale = 0.5 * kPi / narrow;
  form.ratio = std::exp(-2.0 * form.scale * form.reach);
  const double size = 16.0 * narrow / (kPi * kPi * j);
  // along axis 3: -i C (S(p(-a - i z)) - S(p(-a + i z)))
  form.direction = b <= a ? kI : Complex{1.0};
  form.amplitude = b <= a ? size * kI : Complex{size};
  return RectangleSeries(form);
}

RectangleSeries RectangleSeries::of_force3(double b, double a, double i2, double nu) {
  Form form;
  const double rate = nu / ((1.0 + nu) * i2);  // of Poisson's equation that the series solve
  if (runs_along_force(a, b)) {
    form.kind = Kind::alternating;
    form.direction = kI;
    form.reach = a;
    form.scale = kPi / b;
    form.amplitude = -2.0 * b * b * rate / (kPi * kPi);
  } else {
    form.kind = Kind::odd_minus;
    form.reach = b;
    form.scale = 0.5 * kPi / a;
    form.amplitude = 8.0 * rate * b * a / (kPi * kPi);
  }
  form.ratio = std::exp(-2.0 * form.scale * form.reach);
  return RectangleSeries(form);
}

RectangleSeries RectangleSeries::of_force2(double b, double a, double i3, double nu) {
  RectangleSeries series = of_force3(a, b, i3, nu);
  Form& form = series.form_;
  form.direction = product_of(-kI, std::conj(form.direction));
  form.amplitude = product_of(kI, form.amplitude);
  return series;
}

}  // namespace mixbeam
