// Circle, tube, ellipse, rectangle: Saint-Venant's shear stresses, for unit forces a quadratic polynomial and a
// harmonic part, and their largest stress by samples of the section and parabolas around the largest of them.
//
// F = sigma^2 + 3 tau^2. Without shear forces each term is the square of a harmonic function, so F is largest on the
// boundary; with them it may be largest inside (the middle of a circle).
#include "discretization/stresses/stress_field.hpp"

#include "kernels/math/constants.hpp"

#include <algorithm>
#include <cfloat>
#include <complex>
#include <optional>
#include <utility>
#include <vector>

namespace mixbeam {

namespace {

using Complex = std::complex<double>;
using Shear = std::array<double, 2>;  ///< tau_12, tau_13

constexpr Complex kI{0.0, 1.0};
constexpr double kEqualSums = 1e-8;  // what parabolas leave of equal maxima

/// Intervals of a grid: along a side, from the hole of a tube to its outside, around it. Fields of round sections have
/// at most four maxima around.
constexpr int kIntervals = 10, kRings = 8, kAngles = 32;
constexpr std::size_t kMostStarts = 6;  // local maxima of the samples that are followed

/// Each stencil of nine samples over the one before it. A parabola through samples of distance h finds a maximum to
/// h^2, its value to h^4: these leave less than 1e-6 of it (test: 1e-7 of the worst among all shapes).
constexpr double kShrink = 0.15;
constexpr int kStencils = 3, kMostFits = 12;
constexpr double kMiddle = 0.5;  // of full round sections, share of the radius
constexpr int kSweeps = 8;       // over the two coordinates, for the top of a parabola

/// Up to this |exp(w)| series of so many powers are summed; 0.2^24 / 24^2 is 3e-20.
constexpr double kSmallPower = 0.2, kNegligible = 1e-19;
constexpr int kPowerTerms = 24;

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

/// Li2(z) of z = exp(w + i angle), |z| <= 1. At z = 1 log(1 - z) is cut off at a large number: it is infinite there,
/// its product with log z zero.
Complex dilogarithm(Complex w, double angle) {
  const double around = w.imag() + angle;
  const Complex log_z{w.real(), around - 2.0 * kPi * std::round(around / (2.0 * kPi))};
  const double size = std::exp(log_z.real()), cosine = std::cos(log_z.imag()), sine = std::sin(log_z.imag());
  const double half_sine = std::sin(0.5 * log_z.imag());
  // 1 - z without cancellation near z = 1
  const double x = -std::expm1(log_z.real()) * cosine + 2.0 * half_sine * half_sine, y = -size * sine;
  const Complex log{0.5 * std::log(std::fmax(x * x + y * y, DBL_MIN)), std::atan2(y, x)};
  if (size * cosine <= 0.5) return dilogarithm_series(-log);
  return kPi * kPi / 6.0 - product_of(log_z, log) - dilogarithm_series(-log_z);
}

/// f(z) = amplitude (S(p (-l + d z)) + sign S(p (-l - d z))) of z = x2 + i x3, where S(w) is
///   alternating: sum over m = 1, 2, 3, ... of (-1)^m / m^2 exp(m w) / (1 + q^m)
///   odd:         sum over n = 1, 3, 5, ... of (-1)^((n-1)/2) / n^2 exp(n w) / (1 + q^n), or 1 - q^n,
/// with q = exp(-2 p l), at most 0.05. Then tau_13 + i tau_12 = f(z): equilibrium and compatibility are the equations
/// of Cauchy and Riemann. At the edge the sums converge slowly: there what they are without q is taken in closed form.
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
  std::vector<double> power_{}, rest_{};  ///< of exp(m w): all of it, and what the closed form without q leaves
};

/// Shear stresses of a unit torque, or of a unit force along axis 3:
///   tau_12 = x3 (l + b x2), tau_13 = c + s x2 + q2 x2^2 + q3 x3^2, and beside them tau_13 + i tau_12 = D / z^2 + f(z)
struct UnitShear {
  double constant = 0.0, slope = 0.0, square2 = 0.0, square3 = 0.0;  ///< c, s, q2, q3
  double linear12 = 0.0, bilinear12 = 0.0;                           ///< l, b
  double dipole = 0.0;                                               ///< D, of a tube
  std::optional<RectangleSeries> series{};                           ///< f
  double exchanged = 0.0;  ///< the sign with which it holds after an exchange of both axes; 0: it holds as it stands

  Shear at(double x2, double x3) const {
    if (exchanged != 0.0) std::swap(x2, x3);
    const Complex z{x2, x3};
    Complex f{constant + x2 * (slope + square2 * x2) + square3 * x3 * x3, x3 * (linear12 + bilinear12 * x2)};
    if (dipole != 0.0) f += dipole / (z * z);
    if (series) f += series->value(z);
    if (exchanged != 0.0) return {exchanged * f.real(), exchanged * f.imag()};
    return {f.imag(), f.real()};
  }
};

/// Half sizes b along axis 2 and a along axis 3, radius of the hole, Poisson's ratio n.
struct SolidSizes {
  double b = 0.0, a = 0.0, hole = 0.0, n = 0.0;
};

/// Circle and tube; Love's function.
UnitShear round_force3(const SolidSizes& s, double i2) {
  const double a = s.a * s.a, b = s.hole * s.hole, size = 1.0 / (2.0 * (1.0 + s.n) * i2), k = 0.75 + 0.5 * s.n;
  UnitShear u;
  u.constant = size * k * (a + b);
  u.square3 = -size * k;
  u.square2 = -size * (0.25 - 0.5 * s.n);
  u.bilinear12 = -size * (0.5 + s.n);
  u.dipole = size * k * a * b;
  return u;
}

/// Love, ch. XV.
UnitShear ellipse_force3(const SolidSizes& s, double i2) {
  const double a = s.a * s.a, b = s.b * s.b, n = s.n;
  const double d = (1.0 + n) * (3.0 * a + b) * i2, lead = (2.0 * (1.0 + n) * a + b) / (2.0 * d);
  UnitShear u;
  u.constant = lead * a;
  u.square3 = -lead;
  u.square2 = -(1.0 - 2.0 * n) * a / (2.0 * d);
  u.bilinear12 = -((1.0 + n) * a + n * b) / d;
  return u;
}

/// Timoshenko and Goodier, ch. 11. For flat ones by the series across the other side.
UnitShear rectangle_force3(const SolidSizes& s, double i2) {
  const double a = s.a, b = s.b, rate = s.n / ((1.0 + s.n) * i2);  // of Poisson's equation that the series solve
  RectangleSeries::Form form;
  UnitShear u;
  u.constant = 0.5 * a * a / i2;
  u.square3 = -0.5 / i2;
  if (a >= 0.5 * b) {
    u.constant -= rate * b * b / 6.0;
    u.square2 = 0.5 * rate;
    form.direction = kI;
    form.reach = a;
    form.scale = kPi / b;
    form.amplitude = -2.0 * b * b * rate / (kPi * kPi);
  } else {
    u.constant -= 0.5 * rate * a * a;
    u.square3 += 0.5 * rate;
    u.bilinear12 = -rate;
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
  const double narrow = std::min(s.a, s.b);
  RectangleSeries::Form form;
  form.kind = RectangleSeries::Kind::odd_plus;
  form.sign = -1.0;
  form.reach = std::max(s.a, s.b);
  form.scale = 0.5 * kPi / narrow;
  form.direction = kI;
  form.amplitude = 16.0 * narrow / (kPi * kPi * torsion_constant) * kI;
  UnitShear u;
  u.slope = 2.0 / torsion_constant;
  u.series.emplace(form);
  u.exchanged = s.b <= s.a ? 0.0 : -1.0;
  return u;
}

/// Of T, Q2, Q3.
std::array<UnitShear, 3> unit_shears(const SectionShape& shape, const SectionGeometry& g, const SolidSizes& s) {
  const bool rectangle = shape.kind == SectionShapeKind::rectangle, ellipse = shape.kind == SectionShapeKind::ellipse;
  const auto force3 = rectangle ? rectangle_force3 : ellipse ? ellipse_force3 : round_force3;
  UnitShear torque;
  torque.linear12 = ellipse ? -2.0 / (kPi * s.b * s.a * s.a * s.a) : -1.0 / g.torsion_constant;
  torque.slope = ellipse ? 2.0 / (kPi * s.a * s.b * s.b * s.b) : 1.0 / g.torsion_constant;
  std::array<UnitShear, 3> unit = {rectangle ? rectangle_torque(s, g.torsion_constant) : torque,
                                   force3({s.a, s.b, s.hole, s.n}, g.second_moment[1]), force3(s, g.second_moment[0])};
  unit[1].exchanged = 1.0;
  return unit;
}

/// Coordinates of a chart: x2 and x3, or radius and angle, lengths over half the size of the section.
struct Place {
  double u = 0.0, v = 0.0;
};

/// Where the parabola through nine samples of a square |s|, |t| <= 1 is largest on it; at its sides found coordinate by
/// coordinate. `f`: row by row of equal s.
Place top_of(const std::array<double, 9>& f) {
  const double g2 = 0.5 * (f[7] - f[1]), g3 = 0.5 * (f[5] - f[3]), h23 = 0.25 * (f[8] - f[6] - f[2] + f[0]);
  const double h22 = f[7] - 2.0 * f[4] + f[1], h33 = f[5] - 2.0 * f[4] + f[3];
  const auto along = [](double slope, double bend) {
    return bend < 0.0 ? std::clamp(-slope / bend, -1.0, 1.0) : std::copysign(1.0, slope);
  };
  const double det = h22 * h33 - h23 * h23;
  Place top{-(h33 * g2 - h23 * g3) / det, -(h22 * g3 - h23 * g2) / det};
  if (h22 < 0.0 && det > 0.0 && std::max(std::abs(top.u), std::abs(top.v)) <= 1.0) return top;
  top = {};
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    top.u = along(g2 + h23 * top.v, h22);
    top.v = along(g3 + h23 * top.u, h33);
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
    for (std::size_t i = 0; i < 3; ++i) sample_unit_force(i);
  }

  Shear shear(const ShearLoad& load, double x2, double x3) const override {
    Shear sum{};
    for (std::size_t i = 0; i < 3; ++i) {
      if (load[i] == 0.0) continue;
      const Shear one = unit_[i].at(x2, x3);
      sum = {sum[0] + load[i] * one[0], sum[1] + load[i] * one[1]};
    }
    return sum;
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
    const auto sum_at = [&](const SectionPoint& p, const Shear& tau) {
      const double s = normal.at(p[0], p[1]);
      return s * s + 3.0 * (tau[0] * tau[0] + tau[1] * tau[1]);
    };
    std::vector<double> values(points_.size());
    LargestVonMises largest(kEqualSums);
    for (std::size_t n = 0; n < points_.size(); ++n) {
      const Shear &t = tau_[0][n], &q2 = tau_[1][n], &q3 = tau_[2][n];
      values[n] = sum_at(points_[n], {load[0] * t[0] + load[1] * q2[0] + load[2] * q3[0],
                                      load[0] * t[1] + load[1] * q2[1] + load[2] * q3[1]});
      largest.add(values[n], points_[n]);
    }
    const auto f = [&](const SectionPoint& p) { return sum_at(p, shear(load, p[0], p[1])); };
    for (const auto& [bound, node] : starts(values))
      if (bound > largest.square()) climb(node, f, largest);
    return largest.found();
  }

 private:
  /// Denser near the ends, as shear stresses of flat sections change there over lengths like their thickness. `other`:
  /// the other side over this one.
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

  /// Shear stresses at the nodes. Three quarters of a rectangle follow by symmetry: each component is even or odd in x2
  /// and x3.
  void sample_unit_force(std::size_t i) {
    for (std::size_t n = 0; n < points_.size(); ++n) {
      const std::size_t row = n / v_.size(), column = n % v_.size();
      const std::size_t mirrored =
          std::min(row, u_.size() - 1 - row) * v_.size() + std::min(column, v_.size() - 1 - column);
      if (!rectangle_ || mirrored == n) {
        tau_[i].push_back(unit_[i].at(points_[n][0], points_[n][1]));
        continue;
      }
      const double odd2 = 2 * row >= u_.size() ? -1.0 : 1.0, odd3 = 2 * column >= v_.size() ? -1.0 : 1.0;
      const std::array<Shear, 3> signs = {Shear{odd3, odd2}, Shear{1.0, odd2 * odd3}, Shear{odd2 * odd3, 1.0}};
      tau_[i].push_back({signs[i][0] * tau_[i][mirrored][0], signs[i][1] * tau_[i][mirrored][1]});
    }
  }

  /// The largest nodes that no neighbour exceeds, largest first, with what F hardly exceeds around them.
  std::vector<std::pair<double, std::size_t>> starts(const std::vector<double>& values) const {
    std::vector<std::pair<double, std::size_t>> found;
    const std::size_t rows = u_.size(), columns = v_.size();
    const std::size_t first = rectangle_ || hole_ > 0.0 ? 0 : columns;  // the centre is reached from the ring around it
    for (std::size_t n = first; n < points_.size(); ++n) {
      double bound = values[n];
      bool highest = true;
      const auto compare = [&](bool there, std::size_t neighbour) {
        if (!there) return;
        highest = highest && values[n] >= values[neighbour];
        bound += values[n] - values[neighbour];  // eight times what a parabola exceeds its samples by
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

  /// Goes from a node to the largest value of parabolas through stencils of nine samples, which move while they climb
  /// and shrink where they do not. Radius and angle serve round sections but for the middle of full ones.
  template <class Sum>
  void climb(std::size_t node, const Sum& f, LargestVonMises& largest) const {
    const Place gaps{gap(u_, node / v_.size()), gap(v_, node % v_.size())};
    SectionPoint at = points_[node];
    double here = f(at), share = 1.0;
    for (int fit = 0, shrinks = 0; fit < kMostFits && shrinks < kStencils; ++fit) {
      const double u = at[0] / half_[0], v = at[1] / half_[1], radius = std::hypot(u, v);
      const bool polar = !rectangle_ && (hole_ > 0.0 || radius >= kMiddle), is_bounded = polar || rectangle_;
      const Place size{share * gaps.u, share * (is_bounded ? gaps.v : gaps.u)};
      const Place low{is_bounded ? u_.front() : -HUGE_VAL, rectangle_ ? -1.0 : -HUGE_VAL},
          high{is_bounded ? 1.0 : HUGE_VAL, rectangle_ ? 1.0 : HUGE_VAL};
      const Place start = polar ? Place{radius, std::atan2(v, u)} : Place{u, v};
      const Place centre{std::clamp(start.u, low.u + size.u, high.u - size.u),
                         std::clamp(start.v, low.v + size.v, high.v - size.v)};
      Place best = start;
      const double before = here;
      const auto go = [&](double s, double t) {
        const Place there{centre.u + s * size.u, centre.v + t * size.v};
        const SectionPoint p = point(there, polar);
        const double value = f(p);
        if (value > here) here = value, at = p, best = there;
        return value;
      };
      std::array<double, 9> samples;
      for (int i = 0; i < 9; ++i) samples[i] = go(i / 3 - 1, i % 3 - 1);
      const Place top = top_of(samples);
      go(top.u, top.v);
      const auto is_beyond = [](double x, double middle, double h, double from, double to) {
        return std::abs(x - middle) > 0.99 * h && x > from + 0.5 * h && x < to - 0.5 * h;
      };
      const bool is_on_its_way = here > before && (is_beyond(best.u, centre.u, size.u, low.u, high.u) ||
                                                   is_beyond(best.v, centre.v, size.v, low.v, high.v));
      if (is_on_its_way) continue;
      ++shrinks;
      share *= kShrink;
    }
    largest.add(here, at);
  }

  bool rectangle_ = false;
  SectionPoint half_{};                    ///< half sizes
  double hole_ = 0.0;                      ///< tube: inner over outer radius
  std::array<UnitShear, 3> unit_;          ///< of T, Q2, Q3
  std::vector<double> u_, v_;              ///< the grid's coordinates over half sizes; radius, angle
  std::vector<SectionPoint> points_;       ///< its nodes, rows of equal u
  std::array<std::vector<Shear>, 3> tau_;  ///< at the nodes, of unit T, Q2, Q3
};

}  // namespace

std::shared_ptr<const StressField> solid_stress_field(const SectionShape& shape) {
  return std::make_shared<SolidStressField>(shape);
}

}  // namespace mixbeam
