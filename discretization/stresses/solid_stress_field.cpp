// Circle, tube, ellipse, rectangle: Saint-Venant's shear stresses, for unit forces a quadratic polynomial and a
// harmonic part, and their largest stress by samples of the section and Newton's method from the largest of them.
//
// F = sigma^2 + 3 tau^2. Without shear forces each term is the square of a harmonic function, so F is largest on the
// boundary; with them it may be largest inside (the middle of a circle).
#include "discretization/stresses/stress_field.hpp"

#include "kernels/math/constants.hpp"

#include <algorithm>
#include <cfloat>
#include <complex>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

namespace mixbeam {

namespace {

using Complex = std::complex<double>;
using Shear = std::array<double, 2>;  ///< tau_12, tau_13

constexpr Complex kI{0.0, 1.0};
constexpr double kEqualSums = 1e-8;  // relative difference of equal maxima after the search

/// Intervals of a grid: along a side, from the hole of a tube to its outside, around it. Fields of round sections have
/// at most four maxima around.
constexpr int kIntervals = 10, kRings = 8, kAngles = 32;
constexpr std::size_t kMostNodes = (kRings + 1) * (kAngles + 1);   // of a grid
static_assert(kMostNodes >= (kIntervals + 7) * (kIntervals + 1));  // side_places()
constexpr std::size_t kMostStarts = 6;                             // local maxima of the samples that are followed

/// Newton's method ends where a step would raise F by less than this share, as convergence is quadratic.
constexpr double kGain = 1e-8, kShrink = 0.25;  // of its reach after a step that leads down
constexpr int kMostFits = 30;
constexpr double kMiddle = 0.5;  // of full round sections, share of the radius
constexpr int kSweeps = 8;       // over the two coordinates, for the top of a parabola

/// The harmonic part of a rectangle is tabulated on squares, by polynomials of so many terms: sizes halve towards a
/// corner, where it is singular, and are a quarter of the narrow side elsewhere; it vanishes as exp(-pi / 2 distance),
/// and beyond so many halves of that side nothing of it is left.
constexpr int kTerms = 16, kHalvings = 10, kReach = 12;

/// Up to this |exp(w)| series of so many powers are summed; 0.2^24 / 24^2 is 3e-20.
constexpr double kSmallPower = 0.2, kNegligible = 1e-19;
constexpr int kPowerTerms = 24, kLogTerms = 28;  // of |log z| <= 3.6 < 2 pi: 0.33^28 / 28^2 is 3e-17

/// Product without the treatment of infinities that the operator has.
Complex product_of(Complex a, Complex b) {
  return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}

/// Li2(z) of z = exp(w + i angle), |z| <= 1: pi^2 / 6 + v (1 - log(-v)) - v^2 / 4 + a series in v^2, v = log z. At
/// z = 1 the logarithm is cut off at a large number: it is infinite there, its product with v zero.
Complex dilogarithm(Complex w, double angle) {
  static const std::array<double, kLogTerms> c = [] {  // (-1)^k 2 zeta(2 k) / ((2 pi)^(2 k) 2 k (2 k + 1))
    std::array<double, kLogTerms> terms{};
    for (int k = 1; k <= kLogTerms; ++k)
      terms[k - 1] = std::pow(-0.25 / (kPi * kPi), k) * std::riemann_zeta(2.0 * k) / (k * (2 * k + 1));
    return terms;
  }();
  const double around = w.imag() + angle;
  const Complex v{w.real(), around - 2.0 * kPi * std::round(around / (2.0 * kPi))}, square = product_of(v, v);
  const Complex log{0.5 * std::log(std::fmax(std::norm(v), DBL_MIN)), std::atan2(-v.imag(), -v.real())};
  Complex sum = 0.0;
  for (int k = kLogTerms - 1; k >= 0; --k) sum = product_of(sum, square) + c[k];
  sum = product_of(sum, square);
  return kPi * kPi / 6.0 + product_of(v, 1.0 - log - 0.25 * v + sum);
}

/// f(z) = amplitude (S(p (-l + d z)) + sign S(p (-l - d z))) of z = x2 + i x3, where S(w) is
///   alternating: sum over m = 1, 2, 3, ... of (-1)^m / m^2 exp(m w) / (1 + q^m)
///   odd:         sum over n = 1, 3, 5, ... of (-1)^((n-1)/2) / n^2 exp(n w) / (1 + q^n), or 1 - q^n,
/// with q = exp(-2 p l), at most 0.05. Then tau_13 + i tau_12 = f(z): equilibrium and compatibility are the equations
/// of Cauchy and Riemann. At the edge the sums converge slowly: there their part without q is taken in closed form.
class RectangleSeries {
 public:
  enum class Kind { alternating, odd_plus, odd_minus };
  struct Form {
    Kind kind = Kind::alternating;
    double scale = 1.0;     ///< p > 0
    double reach = 1.0;     ///< l: |Re(d z)| is at most this
    Complex direction = 1;  ///< d: 1 or i
    double sign = 1.0;
    Complex amplitude = 0.0;
  };

  explicit RectangleSeries(const Form& form) : form_(form) {
    const double q = std::exp(-2.0 * form.scale * form.reach), sign = form.kind == Kind::odd_minus ? -1.0 : 1.0;
    double power = q;
    for (int m = 1; m <= kPowerTerms; ++m, power *= q) {
      const bool is_odd = m % 2 != 0, alternates = form.kind == Kind::alternating;
      const double base = alternates ? (is_odd ? -1.0 : 1.0) : !is_odd ? 0.0 : m % 4 == 1 ? 1.0 : -1.0;
      power_.push_back(base / (m * m) / (1.0 + sign * power));
      if (power > kNegligible) rest_.push_back(-base / (m * m) * sign * power / (1.0 + sign * power));
    }
  }

  Complex value(Complex z) const {
    const Complex along = form_.direction * z;
    return form_.amplitude *
           (sum(form_.scale * (-form_.reach + along)) + form_.sign * sum(form_.scale * (-form_.reach - along)));
  }

 private:
  Complex sum(Complex w) const {
    const double size = std::exp(w.real());
    const Complex e = std::polar(size, w.imag());
    const std::vector<double>& c = size < kSmallPower ? power_ : rest_;
    Complex sum = 0.0;
    for (std::size_t m = c.size(); m-- > 0;) sum = product_of(sum, e) + c[m];
    sum = product_of(sum, e);
    if (size < kSmallPower) return sum;
    if (form_.kind == Kind::alternating) return sum + dilogarithm(w, kPi);
    return sum - 0.5 * kI * (dilogarithm(w, 0.5 * kPi) - dilogarithm(w, -0.5 * kPi));
  }

  Form form_;
  std::vector<double> power_{}, rest_{};  ///< of exp(m w): all, and those beyond the closed form without q
};

/// tau_13 + i tau_12 of a place and its derivatives by x2 and x3.
struct Jet {
  Complex value = 0.0, d2 = 0.0, d3 = 0.0, d22 = 0.0, d23 = 0.0, d33 = 0.0;
  /// Adds f(z), given by its derivatives.
  void add_harmonic(Complex f, Complex df, Complex ddf) {
    value += f, d2 += df, d22 += ddf, d33 -= ddf;
    d3 += product_of(kI, df), d23 += product_of(kI, ddf);
  }
};

/// tau_13 + i tau_12 = c + c2 x2 + c3 x3 + c22 x2^2 + c23 x2 x3 + c33 x3^2 + D / z^2, z = x2 + i x3
struct SmoothShear {
  Complex c = 0.0, c2 = 0.0, c3 = 0.0, c22 = 0.0, c23 = 0.0, c33 = 0.0;
  Complex dipole = 0.0;  ///< D, of a tube

  Jet at(double x2, double x3) const {
    Jet jet{c + x2 * (c2 + x2 * c22 + x3 * c23) + x3 * (c3 + x3 * c33),
            c2 + 2.0 * x2 * c22 + x3 * c23,
            c3 + 2.0 * x3 * c33 + x2 * c23,
            2.0 * c22,
            c23,
            2.0 * c33};
    if (dipole == 0.0) return jet;
    const Complex inverse = 1.0 / Complex{x2, x3}, square = product_of(inverse, inverse);
    const Complex d = product_of(dipole, square);
    jet.add_harmonic(d, -2.0 * product_of(d, inverse), 6.0 * product_of(d, square));
    return jet;
  }

  void add(double factor, const SmoothShear& other) {
    for (const auto part : {&SmoothShear::c, &SmoothShear::c2, &SmoothShear::c3, &SmoothShear::c22, &SmoothShear::c23,
                            &SmoothShear::c33, &SmoothShear::dipole})
      this->*part += factor * (other.*part);
  }
};

/// Shear stresses of a unit torque, or of a unit force along an axis.
struct UnitShear {
  SmoothShear smooth{};
  std::optional<RectangleSeries> series{};  ///< f(z) is added; exchanged: i conj(f(i conj(z)))
  bool exchanged = false;

  Complex harmonic(Complex z) const {
    if (!series) return 0.0;
    if (!exchanged) return series->value(z);
    const Complex f = series->value({z.imag(), z.real()});
    return {f.imag(), f.real()};
  }
};

/// Exchanges axes 2 and 3.
UnitShear exchanged(UnitShear u) {
  SmoothShear& s = u.smooth;
  std::swap(s.c2, s.c3);
  std::swap(s.c22, s.c33);
  for (Complex* c : {&s.c, &s.c2, &s.c3, &s.c22, &s.c23, &s.c33}) *c = {c->imag(), c->real()};
  s.dipole = -kI * std::conj(s.dipole);
  u.exchanged = true;
  return u;
}

/// Half sizes b along axis 2 and a along axis 3, radius of the hole, Poisson's ratio n.
struct SolidSizes {
  double b = 0.0, a = 0.0, hole = 0.0, n = 0.0;
};

/// Circle and tube; Love's function.
UnitShear round_force3(const SolidSizes& s, double i2) {
  const double a = s.a * s.a, b = s.hole * s.hole, size = 1.0 / (2.0 * (1.0 + s.n) * i2), k = 0.75 + 0.5 * s.n;
  UnitShear u;
  u.smooth.c = size * k * (a + b);
  u.smooth.c33 = -size * k;
  u.smooth.c22 = -size * (0.25 - 0.5 * s.n);
  u.smooth.c23 = -size * (0.5 + s.n) * kI;
  u.smooth.dipole = size * k * a * b;
  return u;
}

/// Love, ch. XV.
UnitShear ellipse_force3(const SolidSizes& s, double i2) {
  const double a = s.a * s.a, b = s.b * s.b, n = s.n;
  const double d = (1.0 + n) * (3.0 * a + b) * i2, lead = (2.0 * (1.0 + n) * a + b) / (2.0 * d);
  UnitShear u;
  u.smooth.c = lead * a;
  u.smooth.c33 = -lead;
  u.smooth.c22 = -(1.0 - 2.0 * n) * a / (2.0 * d);
  u.smooth.c23 = -((1.0 + n) * a + n * b) / d * kI;
  return u;
}

/// Timoshenko and Goodier, ch. 11. For flat ones by the series across the other side.
UnitShear rectangle_force3(const SolidSizes& s, double i2) {
  const double a = s.a, b = s.b, rate = s.n / ((1.0 + s.n) * i2);  // of Poisson's equation that the series solve
  RectangleSeries::Form form;
  UnitShear u;
  u.smooth.c = 0.5 * a * a / i2;
  u.smooth.c33 = -0.5 / i2;
  if (rate == 0.0) return u;
  if (a >= 0.5 * b) {
    u.smooth.c -= rate * b * b / 6.0;
    u.smooth.c22 = 0.5 * rate;
    form.direction = kI;
    form.reach = a;
    form.scale = kPi / b;
    form.amplitude = -2.0 * b * b * rate / (kPi * kPi);
  } else {
    u.smooth.c -= 0.5 * rate * a * a;
    u.smooth.c33 += 0.5 * rate;
    u.smooth.c23 = -rate * kI;
    form.kind = RectangleSeries::Kind::odd_minus;
    form.reach = b;
    form.scale = 0.5 * kPi / a;
    form.amplitude = 8.0 * rate * b * a / (kPi * kPi);
  }
  u.series.emplace(form);
  return u;
}

/// Timoshenko and Goodier, art. 109; across the narrow side, where the series converges.
UnitShear rectangle_torque(const SolidSizes& s, double torsion_constant) {
  const double narrow = std::min(s.a, s.b), sign = s.b <= s.a ? 1.0 : -1.0;
  RectangleSeries::Form form;
  form.kind = RectangleSeries::Kind::odd_plus;
  form.sign = -1.0;
  form.reach = std::max(s.a, s.b);
  form.scale = 0.5 * kPi / narrow;
  form.direction = kI;
  form.amplitude = sign * 16.0 * narrow / (kPi * kPi * torsion_constant) * kI;
  UnitShear u;
  u.smooth.c2 = sign * 2.0 / torsion_constant;
  u.series.emplace(form);
  return s.b <= s.a ? u : exchanged(u);
}

/// Shear stresses of unit T, Q2, Q3.
std::array<UnitShear, 3> unit_shears(const SectionShape& shape, const SectionGeometry& g, const SolidSizes& s) {
  const bool rectangle = shape.kind == SectionShapeKind::rectangle, ellipse = shape.kind == SectionShapeKind::ellipse;
  const auto force3 = rectangle ? rectangle_force3 : ellipse ? ellipse_force3 : round_force3;
  UnitShear torque;
  torque.smooth.c3 = (ellipse ? -2.0 / (kPi * s.b * s.a * s.a * s.a) : -1.0 / g.torsion_constant) * kI;
  torque.smooth.c2 = ellipse ? 2.0 / (kPi * s.a * s.b * s.b * s.b) : 1.0 / g.torsion_constant;
  return {rectangle ? rectangle_torque(s, g.torsion_constant) : torque,
          exchanged(force3({s.a, s.b, s.hole, s.n}, g.second_moment[1])), force3(s, g.second_moment[0])};
}

/// The harmonic part of the three unit forces in the quarter x2, x3 >= 0 of a rectangle, without transcendental
/// functions: Taylor polynomials in squares, each made when it is first needed.
class HarmonicTable {
 public:
  using Terms = std::array<std::array<Complex, kTerms>, 3>;  ///< of T, Q2, Q3, powers of (z - middle) / radius
  struct Square {
    std::once_flag made{};
    Complex middle = 0.0;
    Terms terms{};
  };

  HarmonicTable(const std::array<UnitShear, 3>& unit, const SectionPoint& half)
      : unit_(unit), half_(half), narrow_(std::min(half[0], half[1])) {}

  void add(const ShearLoad& load, double x2, double x3, Jet& jet) const {
    const std::array<double, 2> d = {(half_[0] - x2) / narrow_, (half_[1] - x3) / narrow_};  // from the corner
    const double distance = std::max(d[0], d[1]);
    if (distance > kReach) return;
    const int level = distance < std::ldexp(1.0, -kHalvings) ? kHalvings : std::max(1, -std::ilogb(distance));
    const double per_size = std::ldexp(1.0, level);
    std::array<int, 2> at{};
    for (int i : {0, 1}) at[i] = std::min(static_cast<int>(d[i] * per_size), half_[i] > narrow_ ? 2 * kReach : 1);
    const int farther = std::max(at[0], at[1]), other = std::min(at[0], at[1]);
    const int index = farther > 1 ? 4 * kHalvings + 2 * farther + other : 4 * level - 4 + at[0] + 2 * at[1];
    Square& square = squares_[index];
    std::call_once(square.made, [&] { make(square, {at[0] + 0.5, at[1] + 0.5}, narrow_ / per_size); });
    const double per_radius = 2.0 * per_size / narrow_;
    const Complex z = per_radius * (Complex{x2, x3} - square.middle);
    Complex f = 0.0, df = 0.0, ddf = 0.0;
    for (int n = kTerms - 1; n >= 0; --n) {
      ddf = product_of(ddf, z) + df;
      df = product_of(df, z) + f;
      f = product_of(f, z);
      for (int i : {0, 1, 2}) f += load[i] * square.terms[i][n];
    }
    jet.add_harmonic(f, per_radius * df, 2.0 * per_radius * per_radius * ddf);
  }

 private:
  /// Makes the terms by Cauchy's integrals around the circle in the square. `from`: middle over size, from the corner.
  void make(Square& square, const std::array<double, 2>& from, double size) const {
    static const std::array<Complex, kTerms> root = [] {
      std::array<Complex, kTerms> roots;
      for (int k = 0; k < kTerms; ++k) roots[k] = std::polar(1.0, 2.0 * kPi * k / kTerms);
      return roots;
    }();
    square.middle = {half_[0] - from[0] * size, half_[1] - from[1] * size};
    for (int i : {0, 1, 2}) {
      if (!unit_[i].series) continue;
      for (int k = 0; k < kTerms; ++k) {
        const Complex f = unit_[i].harmonic(square.middle + 0.5 * size * root[k]) / static_cast<double>(kTerms);
        for (int n = 0; n < kTerms; ++n) square.terms[i][n] += product_of(f, std::conj(root[k * n % kTerms]));
      }
    }
  }

  std::array<UnitShear, 3> unit_;
  SectionPoint half_;
  double narrow_;
  mutable std::array<Square, 4 * kHalvings + 4 * kReach + 2> squares_{};
};

/// Coordinates of a chart: x2 and x3, or radius and angle, lengths over half the size of the section.
struct Place {
  double u = 0.0, v = 0.0;
};

/// F and its derivatives by two coordinates.
struct Sum {
  double value = 0.0, u = 0.0, v = 0.0, uu = 0.0, uv = 0.0, vv = 0.0;
  double gain(const Place& s) const { return s.u * (u + 0.5 * uu * s.u + uv * s.v) + s.v * (v + 0.5 * vv * s.v); }
};

/// Step for which the parabola rises most between `low` and `high`; at their sides found coordinate by coordinate.
Place top_of(const Sum& f, const Place& low, const Place& high) {
  const auto along = [](double slope, double bend, double from, double to) {
    if (bend < 0.0) return std::clamp(-slope / bend, from, to);
    return slope * (to - from) + 0.5 * bend * (to * to - from * from) > 0.0 ? to : from;
  };
  const double det = f.uu * f.vv - f.uv * f.uv;
  Place top{-(f.vv * f.u - f.uv * f.v) / det, -(f.uu * f.v - f.uv * f.u) / det};
  if (f.uu < 0.0 && det > 0.0 && top.u >= low.u && top.u <= high.u && top.v >= low.v && top.v <= high.v) return top;
  top = {};
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    top.u = along(f.u + f.uv * top.v, f.uu, low.u, high.u);
    top.v = along(f.v + f.uv * top.u, f.vv, low.v, high.v);
  }
  return top;
}

class SolidStressField : public StressField {
 public:
  explicit SolidStressField(const SectionShape& shape)
      : StressField(shape), rectangle_(shape.kind == SectionShapeKind::rectangle) {
    const bool tube = shape.kind == SectionShapeKind::tube, round = tube || shape.kind == SectionShapeKind::circle;
    half_ = {0.5 * shape.size2, 0.5 * (round ? shape.size2 : shape.size3)};
    if (tube) hole_ = std::max(0.0, 1.0 - 2.0 * shape.wall / shape.size2);
    unit_ = unit_shears(shape, geometry(), {half_[0], half_[1], hole_ * half_[0], shape.poisson_ratio});
    if (rectangle_) {
      u_ = side_places(half_[1] / half_[0]);
      v_ = side_places(half_[0] / half_[1]);
    } else {  // rings from the hole, or the centre, to the boundary
      for (int i = 0; i <= kRings; ++i) u_.push_back(hole_ + (1.0 - hole_) * i / kRings);
      for (int i = 0; i <= kAngles; ++i) v_.push_back(2.0 * kPi * i / kAngles);
    }
    for (const double u : u_)
      for (const double v : v_) points_.push_back(point({u, v}, !rectangle_));
    for (const SectionPoint& p : points_) x2_.push_back(p[0]), x3_.push_back(p[1]);
    for (const SectionPoint& p : points_)
      for (std::size_t i = 0; i < 3; ++i) {
        ShearLoad unit{};
        unit[i] = 1.0;
        const Shear tau = shear(unit, p[0], p[1]);
        for (int k : {0, 1}) tau_[i][k].push_back(tau[k]);
      }
    if (rectangle_) table_ = std::make_unique<const HarmonicTable>(unit_, half_);
  }

  Shear shear(const ShearLoad& load, double x2, double x3) const override {
    Complex sum = 0.0;
    for (std::size_t i = 0; i < 3; ++i)
      if (load[i] != 0.0) sum += load[i] * (unit_[i].smooth.at(x2, x3).value + unit_[i].harmonic({x2, x3}));
    return {sum.imag(), sum.real()};
  }

  bool contains(double x2, double x3) const override {
    constexpr double kRounding = 1e-12;  // of coordinates that come from text or from sums
    const double u = x2 / half_[0], v = x3 / half_[1];
    if (rectangle_) return std::max(std::abs(u), std::abs(v)) <= 1.0 + kRounding;
    const double radius = std::hypot(u, v);
    return radius <= 1.0 + kRounding && radius >= hole_ - kRounding;
  }

  SectionPoint farthest(double direction2, double direction3) const override {
    if (rectangle_) return {std::copysign(half_[0], direction2), std::copysign(half_[1], direction3)};
    const double u = half_[0] * direction2, v = half_[1] * direction3, length = std::hypot(u, v);
    if (!(length > 0.0)) return {half_[0], 0.0};
    return {half_[0] * u / length, half_[1] * v / length};
  }

  LargestStress largest_von_mises(const NormalStress& normal, const ShearLoad& load) const override {
    std::array<double, kMostNodes> values;
    for (std::size_t n = 0; n < points_.size(); ++n) {
      const double s = normal.constant + normal.slope2 * x2_[n] + normal.slope3 * x3_[n];
      double t12 = 0.0, t13 = 0.0;
      for (std::size_t i = 0; i < 3; ++i) t12 += load[i] * tau_[i][0][n], t13 += load[i] * tau_[i][1][n];
      values[n] = s * s + 3.0 * (t12 * t12 + t13 * t13);
    }
    LargestVonMises largest(kEqualSums);
    for (std::size_t n = 0; n < points_.size(); ++n) largest.add(values[n], points_[n]);
    for (const auto& [bound, node] : starts(values.data()))
      if (bound > largest.square()) climb(node, normal, load, largest);
    return largest.found();
  }

 private:
  /// Places along a side, denser near its ends, as shear stresses of flat sections change there over lengths like their
  /// thickness. `other`: the other side over this one.
  static std::vector<double> side_places(double other) {
    std::vector<double> places;
    for (int i = 0; i <= kIntervals; ++i) places.push_back(i == kIntervals / 2 ? 0.0 : -std::cos(kPi * i / kIntervals));
    if (other < 0.5)
      for (const double distance : {0.1, 0.3, 0.7})
        places.insert(places.end(), {1.0 - distance * other, -1.0 + distance * other});
    std::sort(places.begin(), places.end());
    return places;
  }

  SectionPoint point(const Place& p, bool polar) const {
    if (polar) return {half_[0] * p.u * std::cos(p.v), half_[1] * p.u * std::sin(p.v)};
    return {half_[0] * p.u, half_[1] * p.v};
  }

  /// The largest nodes that no neighbour exceeds, largest first, with a bound that F hardly exceeds around them.
  std::vector<std::pair<double, std::size_t>> starts(const double* values) const {
    std::vector<std::pair<double, std::size_t>> found;
    const std::size_t rows = u_.size(), columns = v_.size();
    const std::size_t first = rectangle_ || hole_ > 0.0 ? 0 : columns;  // the centre is reached from the ring around it
    for (std::size_t n = first; n < points_.size(); ++n) {
      double bound = values[n];
      bool highest = true;
      const auto compare = [&](bool there, std::size_t neighbour) {
        if (!there) return;
        highest = highest && values[n] >= values[neighbour];
        bound += values[n] - values[neighbour];  // eight times the excess of a parabola over its samples
      };
      compare(n >= first + columns, n - columns);
      if (first > 0 && n < first + columns) bound += std::abs(values[n] - values[0]);
      compare(n / columns + 1 < rows, n + columns);
      compare(n % columns > 0, n - 1);
      compare(n % columns + 1 < columns, n + 1);
      if (highest) found.emplace_back(bound, n);
    }
    std::stable_sort(found.begin(), found.end(),
                     [&](const auto& a, const auto& b) { return values[a.second] > values[b.second]; });
    found.resize(std::min(found.size(), kMostStarts));
    return found;
  }

  /// Distance of a coordinate to the farther neighbour.
  static double gap(const std::vector<double>& x, std::size_t i) {
    return std::max(i > 0 ? x[i] - x[i - 1] : 0.0, i + 1 < x.size() ? x[i + 1] - x[i] : 0.0);
  }

  /// F and its derivatives by x2 and x3; from the quarter where both are positive, by symmetry.
  Sum sum_at(const SectionPoint& p, const NormalStress& normal, const ShearLoad& load) const {
    const double side2 = std::copysign(1.0, p[0]), side3 = std::copysign(1.0, p[1]);
    const ShearLoad there = {load[0], side3 * load[1], side2 * load[2]};
    SmoothShear smooth;
    for (std::size_t i = 0; i < 3; ++i) smooth.add(there[i], unit_[i].smooth);
    Jet t = smooth.at(std::abs(p[0]), std::abs(p[1]));
    if (table_) table_->add(there, std::abs(p[0]), std::abs(p[1]), t);
    const auto dot = [](Complex a, Complex b) { return a.real() * b.real() + a.imag() * b.imag(); };
    const double s = normal.at(p[0], p[1]), s2 = side2 * normal.slope2, s3 = side3 * normal.slope3;
    return {s * s + 3.0 * dot(t.value, t.value),
            side2 * (2.0 * s * s2 + 6.0 * dot(t.value, t.d2)),
            side3 * (2.0 * s * s3 + 6.0 * dot(t.value, t.d3)),
            2.0 * s2 * s2 + 6.0 * (dot(t.d2, t.d2) + dot(t.value, t.d22)),
            side2 * side3 * (2.0 * s2 * s3 + 6.0 * (dot(t.d2, t.d3) + dot(t.value, t.d23))),
            2.0 * s3 * s3 + 6.0 * (dot(t.d3, t.d3) + dot(t.value, t.d33))};
  }

  /// F by radius and angle, or by x2 and x3 over half the size.
  Sum in_chart(const Sum& f, const SectionPoint& p, bool polar) const {
    const double u = p[0] / half_[0], v = p[1] / half_[1], r = polar ? std::hypot(u, v) : 1.0;
    const double c = polar ? u / r : 1.0, s = polar ? v / r : 0.0;
    const SectionPoint eu = {half_[0] * c, half_[1] * s}, turned = {-half_[0] * s, half_[1] * c};
    const SectionPoint ev = {r * turned[0], r * turned[1]};
    const auto slope = [&](const SectionPoint& e) { return f.u * e[0] + f.v * e[1]; };
    const auto bend = [&](const SectionPoint& a, const SectionPoint& b) {
      return a[0] * (f.uu * b[0] + f.uv * b[1]) + a[1] * (f.uv * b[0] + f.vv * b[1]);
    };
    return {f.value,
            slope(eu),
            slope(ev),
            bend(eu, eu),
            bend(eu, ev) + (polar ? slope(turned) : 0.0),
            bend(ev, ev) - (polar ? slope(p) : 0.0)};
  }

  /// Newton's method to a maximum: by radius and angle in round sections, except in the middle of full ones.
  void climb(std::size_t node, const NormalStress& normal, const ShearLoad& load, LargestVonMises& largest) const {
    const Place gaps{gap(u_, node / v_.size()), gap(v_, node % v_.size())};
    SectionPoint at = points_[node];
    Sum f = sum_at(at, normal, load);
    double share = 1.0;
    for (int fit = 0; fit < kMostFits; ++fit) {
      const double u = at[0] / half_[0], v = at[1] / half_[1], radius = std::hypot(u, v);
      const bool polar = !rectangle_ && (hole_ > 0.0 || radius >= kMiddle), is_bounded = polar || rectangle_;
      const Place here = polar ? Place{radius, std::atan2(v, u)} : Place{u, v};
      const Place reach{share * gaps.u, share * (is_bounded ? gaps.v : gaps.u)};
      Place low{-reach.u, -reach.v}, high{reach.u, reach.v};
      if (is_bounded) low.u = std::max(low.u, u_.front() - here.u), high.u = std::min(high.u, 1.0 - here.u);
      if (rectangle_) low.v = std::max(low.v, -1.0 - here.v), high.v = std::min(high.v, 1.0 - here.v);
      const Sum in_chart_now = in_chart(f, at, polar);
      const Place step = top_of(in_chart_now, low, high);
      if (!(in_chart_now.gain(step) > kGain * f.value)) break;
      const SectionPoint next = point({here.u + step.u, here.v + step.v}, polar);
      const Sum there = sum_at(next, normal, load);
      if (there.value > f.value)
        f = there, at = next;
      else
        share *= kShrink;
    }
    largest.add(f.value, at);
  }

  bool rectangle_ = false;
  SectionPoint half_{};                                    ///< half sizes
  double hole_ = 0.0;                                      ///< tube: inner over outer radius
  std::array<UnitShear, 3> unit_;                          ///< of T, Q2, Q3
  std::vector<double> u_, v_;                              ///< the grid's coordinates over half sizes; radius, angle
  std::vector<SectionPoint> points_;                       ///< its nodes, rows of equal u
  std::vector<double> x2_, x3_;                            ///< their coordinates
  std::array<std::array<std::vector<double>, 2>, 3> tau_;  ///< tau_12 and tau_13 there, of unit T, Q2, Q3
  std::unique_ptr<const HarmonicTable> table_;             ///< of a rectangle
};

}  // namespace

std::shared_ptr<const StressField> solid_stress_field(const SectionShape& shape) {
  return std::make_shared<SolidStressField>(shape);
}

}  // namespace mixbeam
