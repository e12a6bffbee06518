// Circle, tube, ellipse, rectangle: fields in closed form, and their largest stress by samples of the section and
// parabolas around the largest of them.
//
// F = sigma^2 + 3 tau^2. Without shear forces each term is the square of a harmonic function, so F is largest on the
// boundary; with them it may be largest inside (the middle of a circle).
#include "discretization/stresses/solid_shear.hpp"
#include "discretization/stresses/stress_field.hpp"

#include "kernels/math/constants.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace mixbeam {

namespace {

constexpr int kAngles = 32;  // fields of round sections have at most four maxima around
constexpr int kRings = 6;
constexpr std::size_t kMostNodes = 320;
constexpr std::size_t kMostStarts = 6;  // local maxima that are followed

/// Each stencil over the one before it. A parabola through samples of distance h finds a maximum to h^2, its value to
/// h^4: three stencils leave less than 1e-6 of it (test: 1e-7 of the worst among all shapes).
constexpr double kShrink = 0.15;
constexpr int kShrinks = 2, kMostFits = 12;

/// Coordinates of a chart: x2 and x3, or radius and angle, lengths over half the size of the section.
struct Place {
  double u = 0.0, v = 0.0;
};

/// Coefficients of c + g2 s + g3 t + (h22 s^2 + 2 h23 s t + h33 t^2) / 2 on a square |s|, |t| <= 1.
struct StencilParabola {
  double c = 0.0, g2 = 0.0, g3 = 0.0, h22 = 0.0, h23 = 0.0, h33 = 0.0;

  /// Through the centre and the four samples beside it, with the mixed derivative of the corners. `f`: row by row.
  explicit StencilParabola(const std::array<double, 9>& f)
      : c(f[4]),
        g2(0.5 * (f[7] - f[1])),
        g3(0.5 * (f[5] - f[3])),
        h22(f[7] - 2.0 * f[4] + f[1]),
        h23(0.25 * (f[8] - f[6] - f[2] + f[0])),
        h33(f[5] - 2.0 * f[4] + f[3]) {}

  double at(const Place& p) const {
    return c + g2 * p.u + g3 * p.v + 0.5 * (h22 * p.u * p.u + 2.0 * h23 * p.u * p.v + h33 * p.v * p.v);
  }

  /// Where it is largest on the square: inside, or on one of the four sides.
  Place largest() const {
    const auto along = [](double slope, double bend) {
      return bend < 0.0 ? std::clamp(-slope / bend, -1.0, 1.0) : std::copysign(1.0, slope);
    };
    Place best;
    const auto compare = [&](const Place& p) {
      if (at(p) > at(best)) best = p;
    };
    const double det = h22 * h33 - h23 * h23;
    const Place inner = {-(h33 * g2 - h23 * g3) / det, -(h22 * g3 - h23 * g2) / det};
    if (h22 < 0.0 && det > 0.0 && std::max(std::abs(inner.u), std::abs(inner.v)) <= 1.0) return inner;
    for (const double side : {-1.0, 1.0}) {
      compare({side, along(g3 + side * h23, h33)});
      compare({along(g2 + side * h23, h22), side});
    }
    return best;
  }
};

/// Largest F so far; of equal ones the first.
struct LargestSum {
  double value = 0.0;
  SectionPoint point{};
  void add(double f, const SectionPoint& p) {
    constexpr double kEqual = 1e-10;  // rounding of fields and series
    if (f <= value * (1.0 + kEqual)) return;
    value = f;
    point = p;
  }
};

class SolidStressField : public StressField {
 public:
  explicit SolidStressField(const SectionShape& shape)
      : StressField(shape), shear_(shape, geometry()), rectangle_(shape.kind == SectionShapeKind::rectangle) {
    const bool round = shape.kind == SectionShapeKind::circle || shape.kind == SectionShapeKind::tube;
    half_ = {0.5 * shape.size2, 0.5 * (round ? shape.size2 : shape.size3)};
    if (shape.kind == SectionShapeKind::tube) hole_ = std::max(0.0, 1.0 - 2.0 * shape.wall / shape.size2);
    if (rectangle_) {
      u_ = side_places(half_[1] / half_[0]);
      v_ = side_places(half_[0] / half_[1]);
    } else {  // rings from the hole, or the centre, to the boundary
      for (int ring = 0; ring < kRings; ++ring) u_.push_back(hole_ + (1.0 - hole_) * ring / (kRings - 1));
      for (int i = 0; i < kAngles; ++i) v_.push_back(2.0 * kPi * i / kAngles);
    }
    for (const double u : u_)
      for (const double v : v_) points_.push_back(point({u, v}, !rectangle_));
    for (std::size_t i = 0; i < 3; ++i) sample_unit_force(i);
  }

  std::array<double, 2> shear(const ShearLoad& load, double x2, double x3) const override {
    return shear_.combined(load).at(x2, x3);
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
    const CombinedShear shear = shear_.combined(load);
    const auto f = [&](const SectionPoint& p) {
      const double s = normal.at(p[0], p[1]);
      const auto [t, u] = shear.at(p[0], p[1]);
      return s * s + 3.0 * (t * t + u * u);
    };
    std::array<double, kMostNodes> values;
    sample(normal, load, values.data());
    LargestSum largest;
    for (std::size_t n = 0; n < points_.size(); ++n) largest.add(values[n], points_[n]);
    std::array<Start, kMostStarts> starts;
    const std::size_t count = find_starts(values.data(), starts);
    for (std::size_t i = 0; i < count; ++i)
      if (starts[i].bound > largest.value) climb(starts[i].node, f, largest);
    return {std::sqrt(largest.value), largest.point};
  }

 private:
  /// Local maximum of the samples.
  struct Start {
    double value = 0.0;
    double bound = 0.0;  ///< F hardly exceeds it around the node
    std::size_t node = 0;
  };

  /// Coordinates of one direction over half a side: denser near the ends, as shear stresses of flat sections change
  /// there over lengths like their thickness. `other`: the other side over this one.
  static std::vector<double> side_places(double other) {
    std::vector<double> places;
    constexpr int kIntervals = 10;
    for (int i = 0; i <= kIntervals; ++i) places.push_back(-std::cos(kPi * i / kIntervals));
    if (other < 0.5)
      for (const double distance : {0.1, 0.3, 0.7}) {
        places.push_back(1.0 - distance * other);
        places.push_back(-1.0 + distance * other);
      }
    places[kIntervals / 2] = 0.0;
    std::sort(places.begin(), places.end());
    return places;
  }

  SectionPoint point(const Place& p, bool polar) const {
    if (polar) return {half_[0] * p.u * std::cos(p.v), half_[1] * p.u * std::sin(p.v)};
    return {half_[0] * p.u, half_[1] * p.v};
  }
  Place place(const SectionPoint& p, bool polar) const {
    const double u = p[0] / half_[0], v = p[1] / half_[1];
    if (polar) return {std::hypot(u, v), std::atan2(v, u)};
    return {u, v};
  }

  /// Shear stresses of a unit force at the nodes; three quarters of a rectangle follow by symmetry: each component is
  /// even or odd in x2 and x3.
  void sample_unit_force(std::size_t i) {
    const CombinedShear unit = shear_.combined({i == 0 ? 1.0 : 0.0, i == 1 ? 1.0 : 0.0, i == 2 ? 1.0 : 0.0});
    for (std::size_t n = 0; n < points_.size(); ++n) {
      const std::size_t row = n / v_.size(), column = n % v_.size();
      const bool right = rectangle_ && 2 * row >= u_.size(), upper = rectangle_ && 2 * column >= v_.size();
      if (!right && !upper) {
        tau_[i].push_back(unit.at(points_[n][0], points_[n][1]));
        continue;
      }
      const double odd2 = right ? -1.0 : 1.0, odd3 = upper ? -1.0 : 1.0;
      const auto [t, u] =
          tau_[i][(right ? u_.size() - 1 - row : row) * v_.size() + (upper ? v_.size() - 1 - column : column)];
      // T: tau_12 is odd in x3, tau_13 in x2; Q3: tau_12 is odd in both; Q2: tau_13 is
      tau_[i].push_back({t * (i == 0   ? odd3
                              : i == 2 ? odd2 * odd3
                                       : 1.0),
                         u * (i == 0   ? odd2
                              : i == 1 ? odd2 * odd3
                                       : 1.0)});
    }
  }

  void sample(const NormalStress& normal, const ShearLoad& load, double* values) const {
    for (std::size_t n = 0; n < points_.size(); ++n) {
      const double s = normal.at(points_[n][0], points_[n][1]);
      const double t = load.torque * tau_[0][n][0] + load.force2 * tau_[1][n][0] + load.force3 * tau_[2][n][0];
      const double u = load.torque * tau_[0][n][1] + load.force2 * tau_[1][n][1] + load.force3 * tau_[2][n][1];
      values[n] = s * s + 3.0 * (t * t + u * u);
    }
  }

  /// The largest nodes that no neighbour exceeds, largest first; returns their number.
  std::size_t find_starts(const double* values, std::array<Start, kMostStarts>& starts) const {
    std::size_t count = 0;
    const std::size_t rows = u_.size(), columns = v_.size();
    const std::size_t first_row = rectangle_ || hole_ > 0.0 ? 0 : 1;  // the centre is reached from the ring around it
    for (std::size_t n = first_row * columns; n < points_.size(); ++n) {
      const std::size_t row = n / columns, column = n % columns, first = row * columns;
      Start start = {values[n], values[n], n};
      bool highest = true;
      const auto compare = [&](bool there, std::size_t neighbour) {
        if (!there) return;
        highest = highest && values[n] >= values[neighbour];
        start.bound += 0.5 * (values[n] - values[neighbour]);  // four times what a parabola exceeds its samples by
      };
      compare(row > first_row, n - columns);
      compare(row + 1 < rows, n + columns);
      if (row == 1 && first_row == 1) start.bound += 0.5 * std::abs(values[n] - values[0]);
      compare(!rectangle_ || column > 0, first + (column + columns - 1) % columns);
      compare(!rectangle_ || column + 1 < columns, first + (column + 1) % columns);
      if (!highest || (count == kMostStarts && values[n] <= starts[count - 1].value)) continue;
      if (count < kMostStarts) ++count;
      starts[count - 1] = start;
      for (std::size_t i = count - 1; i > 0 && starts[i - 1].value < starts[i].value; --i)
        std::swap(starts[i], starts[i - 1]);
    }
    return count;
  }

  /// Distance of a coordinate to the farther neighbour.
  static double gap(const std::vector<double>& x, std::size_t i) {
    return std::max(i > 0 ? x[i] - x[i - 1] : 0.0, i + 1 < x.size() ? x[i + 1] - x[i] : 0.0);
  }

  /// Goes from a node to the largest value of parabolas through stencils of nine samples, which move while they climb
  /// and shrink where they do not. Angles serve round sections but for the middle of full ones.
  template <class Sum>
  void climb(std::size_t node, const Sum& f, LargestSum& largest) const {
    constexpr double kMiddle = 0.5;
    SectionPoint at = points_[node];
    double here = f(at), size = 1.0;
    const Place gaps = {gap(u_, node / v_.size()), rectangle_ ? gap(v_, node % v_.size()) : v_[1]};
    for (int fit = 0, shrinks = 0; fit < kMostFits && shrinks <= kShrinks; ++fit) {
      const bool polar = !rectangle_ && (hole_ > 0.0 || place(at, true).u >= kMiddle);
      const double h2 = size * gaps.u, h3 = size * (polar || rectangle_ ? gaps.v : gaps.u);
      const Place before = place(at, polar);
      Place centre = before;
      const bool bounded2 = polar || rectangle_;
      if (bounded2) centre.u = std::clamp(before.u, u_.front() + h2, u_.back() - h2);
      if (rectangle_) centre.v = std::clamp(before.v, v_.front() + h3, v_.back() - h3);
      Place step{(before.u - centre.u) / h2, (before.v - centre.v) / h3};
      bool moved = false;
      const auto go = [&](double s, double t) {
        const SectionPoint there = point({centre.u + s * h2, centre.v + t * h3}, polar);
        const double value = f(there);
        if (value <= here) return value;
        here = value;
        at = there;
        step = {s, t};
        moved = true;
        return value;
      };
      std::array<double, 9> samples;
      for (int i = 0; i < 9; ++i) samples[i] = go(i / 3 - 1, i % 3 - 1);
      const Place top = StencilParabola(samples).largest();
      go(top.u, top.v);
      if (!moved && fit == 0 && rectangle_ && std::abs(before.u) == 1.0 && std::abs(before.v) == 1.0) break;
      const auto beyond = [&](double s, double x, double h, const std::vector<double>& range, bool bounded) {
        const bool at_bound = bounded && std::min(x - range.front(), range.back() - x) < 0.5 * h;
        return std::abs(s) == 1.0 && !at_bound;
      };
      if (moved && (beyond(step.u, centre.u + step.u * h2, h2, u_, bounded2) ||
                    beyond(step.v, centre.v + step.v * h3, h3, v_, rectangle_)))
        continue;
      ++shrinks;
      size *= kShrink;
    }
    largest.add(here, at);
  }

  SolidShear shear_;
  bool rectangle_ = false;
  SectionPoint half_{};                                    ///< half sizes
  double hole_ = 0.0;                                      ///< tube: inner over outer radius
  std::vector<double> u_, v_;                              ///< the grid's coordinates over half sizes; radius, angle
  std::vector<SectionPoint> points_;                       ///< its nodes, rows of equal u
  std::array<std::vector<std::array<double, 2>>, 3> tau_;  ///< tau_12, tau_13 at nodes of unit T, Q2, Q3
};

}  // namespace

std::shared_ptr<const StressField> solid_stress_field(const SectionShape& shape) {
  return std::make_shared<SolidStressField>(shape);
}

}  // namespace mixbeam
