#include "discretization/stresses/solid_shear.hpp"

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

/// Li2(z) of z = exp(log_z), |z| <= 1, imaginary part of log_z in [-pi, pi]. At z = 1 log(1 - z) is cut off at a large
/// number: it is infinite there, its product with log z zero.
Complex dilogarithm(Complex log_z) {
  const double size = std::exp(log_z.real()), cosine = std::cos(log_z.imag()), sine = std::sin(log_z.imag());
  const double half_sine = std::sin(0.5 * log_z.imag());
  // 1 - z without cancellation near z = 1
  const double x = -std::expm1(log_z.real()) * cosine + 2.0 * half_sine * half_sine, y = -size * sine;
  const Complex log{0.5 * std::log(std::fmax(x * x + y * y, DBL_MIN)), std::atan2(y, x)};
  if (size * cosine <= 0.5) return dilogarithm_series(-log);
  return kPi * kPi / 6.0 - product_of(log_z, log) - dilogarithm_series(-log_z);
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
Complex closed_sum(RectangleSeries::Kind kind, Complex w) {
  if (kind == RectangleSeries::Kind::alternating) return dilogarithm(turned_by(w, kPi));
  return product_of(-0.5 * kI, dilogarithm(turned_by(w, 0.5 * kPi)) - dilogarithm(turned_by(w, -0.5 * kPi)));
}

/// (-1)^m / m^2 for m = 1, 2, ..., or (-1)^((m-1)/2) / m^2 for odd m and 0 for even ones.
double base_coefficient(RectangleSeries::Kind kind, int m) {
  if (kind == RectangleSeries::Kind::alternating) return (m % 2 == 0 ? 1.0 : -1.0) / (m * m);
  return m % 2 == 0 ? 0.0 : ((m - 1) / 2 % 2 == 0 ? 1.0 : -1.0) / (m * m);
}

/// sum c_m e^m
Complex power_sum(const std::vector<double>& c, Complex e) {
  Complex sum = 0.0;
  for (std::size_t m = c.size(); m-- > 0;) sum = product_of(sum, e) + c[m];
  return product_of(sum, e);
}

/// The field of a force along axis 2 from that of a force along axis 3 in the section with axes exchanged.
ShearPolynomials with_axes_exchanged(const ShearPolynomials& p) {
  const auto exchanged = [](const PlaneQuadratic& q) { return PlaneQuadratic{q.c0, q.c3, q.c2, q.c33, q.c23, q.c22}; };
  return {exchanged(p.tau13), exchanged(p.tau12)};
}

/// Ellipse of half axes a along Q3 = 1 and b across it; Love, ch. XV.
ShearPolynomials ellipse_force3(double a, double b, double i2, double n) {
  const double d = (1.0 + n) * (3.0 * a * a + b * b) * i2;
  const double lead = (2.0 * (1.0 + n) * a * a + b * b) / (2.0 * d);
  ShearPolynomials p;
  p.tau13.c0 = lead * a * a;
  p.tau13.c33 = -lead;
  p.tau13.c22 = -(1.0 - 2.0 * n) * a * a / (2.0 * d);
  p.tau12.c23 = -((1.0 + n) * a * a + n * b * b) / d;
  return p;
}

/// Beside the series of the rectangle, half sizes a along Q3 = 1 and b across it.
ShearPolynomials rectangle_force3(double a, double b, double i2, double n) {
  const double rate = n / ((1.0 + n) * i2);
  ShearPolynomials p;
  p.tau13.c0 = 0.5 * a * a / i2;
  p.tau13.c33 = -0.5 / i2;
  if (RectangleSeries::runs_along_force(a, b)) {
    p.tau13.c0 -= rate * b * b / 6.0;
    p.tau13.c22 = 0.5 * rate;
  } else {
    p.tau13.c0 -= 0.5 * rate * a * a;
    p.tau13.c33 += 0.5 * rate;
    p.tau12.c23 = -rate;
  }
  return p;
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

Complex RectangleSeries::sum(Complex w) const {
  const Complex e = exponential_of(w);
  if (w.real() < std::log(kSmall)) return power_sum(coefficients_, e);
  return closed_sum(form_.kind, w) + power_sum(rest_, e);
}

Complex RectangleSeries::value(Complex z) const {
  const Complex along = product_of(form_.direction, z);
  return product_of(form_.amplitude,
                    sum(form_.scale * (-form_.reach + along)) + form_.sign * sum(form_.scale * (-form_.reach - along)));
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

std::array<double, 2> CombinedShear::at(double x2, double x3) const {
  Complex f = 0.0;  // tau_13 + i tau_12
  const Complex z{x2, x3};
  if (dipole_ != 0.0) f += dipole_ / (z * z);
  for (int i = 0; i < count_; ++i) f += parts_[i].factor * parts_[i].series->value(z);
  return {polynomials_.tau12.at(x2, x3) + f.imag(), polynomials_.tau13.at(x2, x3) + f.real()};
}

SolidShear::SolidShear(const SectionShape& shape, const SectionGeometry& geometry) {
  if (shape.kind == SectionShapeKind::rectangle)
    set_rectangle(shape, geometry);
  else if (shape.kind == SectionShapeKind::ellipse)
    set_ellipse(shape, geometry);
  else
    set_round(shape, geometry);
}

CombinedShear SolidShear::combined(const ShearLoad& load) const {
  CombinedShear shear;
  const std::array<double, 3> factors = {load.torque, load.force2, load.force3};
  for (std::size_t i = 0; i < 3; ++i) {
    if (factors[i] == 0.0) continue;
    shear.polynomials_.tau12.add(factors[i], unit_[i].tau12);
    shear.polynomials_.tau13.add(factors[i], unit_[i].tau13);
    if (has_series_) shear.parts_[shear.count_++] = {&series_[i], factors[i]};
  }
  shear.dipole_ = dipole_ * Complex{load.force3, -load.force2};
  return shear;
}

/// Circle and tube, radii a and b; Love's function.
void SolidShear::set_round(const SectionShape& shape, const SectionGeometry& g) {
  const bool tube = shape.kind == SectionShapeKind::tube;
  const double a = 0.5 * shape.size2, b = tube ? a - shape.wall : 0.0, n = shape.poisson_ratio;
  const double size = 1.0 / (2.0 * (1.0 + n) * g.second_moment[0]), k = 0.75 + 0.5 * n;
  unit_[0].tau12.c3 = -1.0 / g.torsion_constant;
  unit_[0].tau13.c2 = 1.0 / g.torsion_constant;
  unit_[2].tau13.c0 = size * k * (a * a + b * b);
  unit_[2].tau13.c33 = -size * k;
  unit_[2].tau13.c22 = -size * (0.25 - 0.5 * n);
  unit_[2].tau12.c23 = -size * (0.5 + n);
  unit_[1] = with_axes_exchanged(unit_[2]);
  dipole_ = size * k * a * a * b * b;
}

void SolidShear::set_ellipse(const SectionShape& shape, const SectionGeometry& g) {
  const double b = 0.5 * shape.size2, a = 0.5 * shape.size3, n = shape.poisson_ratio;
  unit_[0].tau12.c3 = -2.0 / (kPi * b * a * a * a);
  unit_[0].tau13.c2 = 2.0 / (kPi * a * b * b * b);
  unit_[1] = with_axes_exchanged(ellipse_force3(b, a, g.second_moment[1], n));
  unit_[2] = ellipse_force3(a, b, g.second_moment[0], n);
}

void SolidShear::set_rectangle(const SectionShape& shape, const SectionGeometry& g) {
  const double b = 0.5 * shape.size2, a = 0.5 * shape.size3, n = shape.poisson_ratio;
  const auto [i2, i3] = g.second_moment;
  (b <= a ? unit_[0].tau13.c2 : unit_[0].tau12.c3) = (b <= a ? 2.0 : -2.0) / g.torsion_constant;
  unit_[1] = with_axes_exchanged(rectangle_force3(b, a, i3, n));
  unit_[2] = rectangle_force3(a, b, i2, n);
  series_ = {RectangleSeries::of_torque(b, a, g.torsion_constant), RectangleSeries::of_force2(b, a, i3, n),
             RectangleSeries::of_force3(b, a, i2, n)};
  has_series_ = true;
}

}  // namespace mixbeam
