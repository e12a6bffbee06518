// Circle, tube, ellipse, rectangle: fields in closed form, and their largest stress by samples of the section and
// Newton's method from the largest of them.
//
// F = sigma^2 + 3 tau^2. Without shear forces each term is the square of a harmonic function, so F is largest on the
// boundary; with them it may be largest inside (the middle of a circle).
#include "discretization/stresses/solid_maximum.hpp"
#include "discretization/stresses/stress_field.hpp"

#include "kernels/math/constants.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace mixbeam {

namespace {

constexpr int kAngles = 32;  // fields of round sections have at most four maxima around
constexpr std::size_t kMostNodes = 256;
constexpr int kMostStarts = 6;  // local maxima that are followed

/// Samples of the section: a grid of rows and columns, with the shear stresses of unit forces there.
struct SectionGrid {
  std::size_t rows = 0, columns = 0;
  std::vector<double> x2, x3;
  std::array<std::array<std::vector<double>, 2>, 3> tau;  ///< of T, Q2, Q3; tau_12, tau_13

  std::size_t size() const { return x2.size(); }
};

/// The largest local maxima of samples, largest first.
class Starts {
 public:
  struct Start {
    double value = 0.0;
    double bound = 0.0;  ///< what F hardly exceeds around it
    std::size_t node = 0;
    int curve = -1;  ///< of the boundary; -1: inside
  };

  void add(double value, double bound, std::size_t node, int curve) {
    if (count_ == kMostStarts && value <= starts_[count_ - 1].value) return;
    if (count_ < kMostStarts) ++count_;
    int i = count_ - 1;
    for (; i > 0 && starts_[i - 1].value < value; --i) starts_[i] = starts_[i - 1];
    starts_[i] = {value, bound, node, curve};
  }
  const Start* begin() const { return starts_.data(); }
  const Start* end() const { return starts_.data() + count_; }

 private:
  std::array<Start, kMostStarts> starts_{};
  int count_ = 0;
};

class SolidStressField : public StressField {
 public:
  explicit SolidStressField(const SectionShape& shape)
      : StressField(shape), shear_(shape, geometry()), rectangle_(shape.kind == SectionShapeKind::rectangle) {
    const bool round = shape.kind == SectionShapeKind::circle || shape.kind == SectionShapeKind::tube;
    half_ = {0.5 * shape.size2, 0.5 * (round ? shape.size2 : shape.size3)};
    if (shape.kind == SectionShapeKind::tube) hole_ = std::max(0.0, 1.0 - 2.0 * shape.wall / shape.size2);
    if (rectangle_)
      set_rectangular_grid();
    else
      set_round_grid();
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
    const StressSum f{normal, shear_.combined(load)};
    std::array<double, kMostNodes> values;
    sample(normal, load, values.data());
    LargestSum largest;
    for (std::size_t i = 0; i < grid_.size(); ++i) largest.add(values[i], grid_.x2[i], grid_.x3[i]);
    Starts starts;
    add_boundary_starts(values.data(), starts);
    const bool inside = load.force2 != 0.0 || load.force3 != 0.0;
    if (inside) add_inner_starts(values.data(), starts);
    for (const Starts::Start& start : starts) {
      if (start.bound < largest.value) continue;
      climb_from(start, inside, f, largest);
    }
    return {std::sqrt(largest.value), largest.point};
  }

 private:
  /// Rings from the hole, or the centre, to the boundary.
  void set_round_grid() {
    constexpr int kRings = 6;
    grid_.rows = kRings;
    grid_.columns = kAngles;
    for (int ring = 0; ring < kRings; ++ring)
      for (int i = 0; i < kAngles; ++i) {
        const double radius = hole_ + (1.0 - hole_) * ring / (kRings - 1), angle = 2.0 * kPi * i / kAngles;
        add_node(half_[0] * radius * std::cos(angle), half_[1] * radius * std::sin(angle));
      }
  }

  /// Coordinates of one direction over half a side: denser near the ends, as shear stresses of flat sections change
  /// there over lengths like their thickness.
  static std::vector<double> side_places(double half, double other) {
    std::vector<double> places;
    constexpr int kIntervals = 10;
    for (int i = 0; i <= kIntervals; ++i) places.push_back(-half * std::cos(kPi * i / kIntervals));
    if (half > 2.0 * other)
      for (const double distance : {0.1, 0.3, 0.7}) {
        places.push_back(half - distance * other);
        places.push_back(-half + distance * other);
      }
    places[kIntervals / 2] = 0.0;
    std::sort(places.begin(), places.end());
    return places;
  }

  void set_rectangular_grid() {
    const std::vector<double> along2 = side_places(half_[0], half_[1]), along3 = side_places(half_[1], half_[0]);
    grid_.rows = along2.size();
    grid_.columns = along3.size();
    for (const double x2 : along2)
      for (const double x3 : along3) add_node(x2, x3);
  }

  void add_node(double x2, double x3) {
    grid_.x2.push_back(x2);
    grid_.x3.push_back(x3);
  }

  /// Of a quarter of the rectangle; the rest follows by symmetry: each component is even or odd in x2 and x3.
  void sample_unit_force(std::size_t i) {
    const CombinedShear unit = shear_.combined({i == 0 ? 1.0 : 0.0, i == 1 ? 1.0 : 0.0, i == 2 ? 1.0 : 0.0});
    auto& [tau12, tau13] = grid_.tau[i];
    tau12.resize(grid_.size());
    tau13.resize(grid_.size());
    for (std::size_t n = 0; n < grid_.size(); ++n) {
      const std::size_t row = n / grid_.columns, column = n % grid_.columns;
      const bool right = 2 * row >= grid_.rows, upper = 2 * column >= grid_.columns;
      if (rectangle_ && (right || upper)) continue;
      const auto [t, u] = unit.at(grid_.x2[n], grid_.x3[n]);
      tau12[n] = t;
      tau13[n] = u;
    }
    if (!rectangle_) return;
    const auto odd = [](bool yes) { return yes ? -1.0 : 1.0; };
    for (std::size_t n = 0; n < grid_.size(); ++n) {
      const std::size_t row = n / grid_.columns, column = n % grid_.columns;
      const bool right = 2 * row >= grid_.rows, upper = 2 * column >= grid_.columns;
      const std::size_t twin =
          (right ? grid_.rows - 1 - row : row) * grid_.columns + (upper ? grid_.columns - 1 - column : column);
      // T: tau_12 is odd in x3, tau_13 in x2; Q3: tau_12 is odd in both; Q2: tau_13 is
      tau12[n] = tau12[twin] * (i == 0 ? odd(upper) : i == 2 ? odd(right) * odd(upper) : 1.0);
      tau13[n] = tau13[twin] * (i == 0 ? odd(right) : i == 1 ? odd(right) * odd(upper) : 1.0);
    }
  }

  void sample(const NormalStress& normal, const ShearLoad& load, double* values) const {
    const auto& [torque, force2, force3] = grid_.tau;
    for (std::size_t i = 0; i < grid_.size(); ++i) {
      const double s = normal.at(grid_.x2[i], grid_.x3[i]);
      const double t = load.torque * torque[0][i] + load.force2 * force2[0][i] + load.force3 * force3[0][i];
      const double u = load.torque * torque[1][i] + load.force2 * force2[1][i] + load.force3 * force3[1][i];
      values[i] = s * s + 3.0 * (t * t + u * u);
    }
  }

  /// Curves of the boundary: of a rectangle rows 0 and last and columns 0 and last, of others the row of each circle.
  void add_boundary_starts(const double* values, Starts& starts) const {
    const std::size_t last_row = grid_.rows - 1, last_column = grid_.columns - 1;
    const auto add = [&](std::size_t before, std::size_t node, std::size_t after, int curve) {
      if (values[node] >= values[before] && values[node] >= values[after] &&
          (values[node] > values[before] || values[node] > values[after]))
        starts.add(values[node], bound(values, node), node, curve);
    };
    if (!rectangle_) {
      for (const std::size_t row : {last_row, std::size_t{0}}) {
        if (row == 0 && hole_ == 0.0) continue;
        const std::size_t first = row * grid_.columns;
        for (std::size_t i = 0; i < grid_.columns; ++i)
          add(first + (i + last_column) % grid_.columns, first + i, first + (i + 1) % grid_.columns, row == 0 ? 0 : 1);
      }
      return;
    }
    for (const std::size_t row : {std::size_t{0}, last_row})
      for (std::size_t i = 0; i <= last_column; ++i)
        add(node(row, i == 0 ? 0 : i - 1), node(row, i), node(row, std::min(i + 1, last_column)), row == 0 ? 0 : 1);
    for (const std::size_t column : {std::size_t{0}, last_column})
      for (std::size_t i = 0; i <= last_row; ++i)
        add(node(i == 0 ? 0 : i - 1, column), node(i, column), node(std::min(i + 1, last_row), column),
            column == 0 ? 2 : 3);
  }

  /// F at a sample and what parabolas through its neighbours in both directions add, four times over.
  double bound(const double* values, std::size_t n) const {
    const std::size_t row = n / grid_.columns, column = n % grid_.columns;
    const auto rise = [&](std::size_t place, std::size_t count, std::size_t stride, bool round,
                          const std::vector<double>& x) {
      const std::size_t first = n - place * stride;
      const std::size_t middle = round ? place : std::clamp<std::size_t>(place, 1, count - 2);
      const std::size_t a = first + (middle + count - 1) % count * stride, b = first + middle * stride,
                        c = first + (middle + 1) % count * stride;
      const double before = rectangle_ ? x[b] - x[a] : 1.0, after = rectangle_ ? x[c] - x[b] : 1.0;
      return 0.5 * std::max(before, after) *
             std::abs((values[c] - values[b]) / after - (values[b] - values[a]) / before);
    };
    return values[n] + rise(row, grid_.rows, grid_.columns, false, grid_.x2) +
           rise(column, grid_.columns, 1, !rectangle_, grid_.x3);
  }

  void add_inner_starts(const double* values, Starts& starts) const {
    const std::size_t columns = grid_.columns;
    const std::size_t first = rectangle_ ? 1 : 0, last = rectangle_ ? columns - 2 : columns - 1;
    for (std::size_t row = 1; row + 1 < grid_.rows; ++row)
      for (std::size_t i = first; i <= last; ++i) {
        const double here = values[node(row, i)];
        const std::size_t before = (i + columns - 1) % columns, after = (i + 1) % columns;
        bool highest = here >= values[node(row, before)] && here > values[node(row, after)];
        for (const std::size_t beside : {row - 1, row + 1}) highest = highest && here >= values[node(beside, i)];
        if (highest) starts.add(here, bound(values, node(row, i)), node(row, i), -1);
      }
    if (rectangle_ || hole_ > 0.0) return;
    const double* ring = values + columns;  // around the centre
    if (values[0] >= *std::max_element(ring, ring + columns)) starts.add(values[0], 2.0 * values[0], 0, -1);
  }

  void climb_from(const Starts::Start& start, bool inside, const StressSum& f, LargestSum& largest) const {
    SectionPoint p = {grid_.x2[start.node], grid_.x3[start.node]};
    if (start.curve >= 0) p = rectangle_ ? climb_side(start, f, largest) : climb_circle(start, f, largest);
    if (!inside || is_corner(p)) return;  // otherwise the maximum may lie between boundary and first samples inside
    const SectionPoint size = {half_[0] * (1.0 - hole_), half_[1] * (1.0 - hole_)};
    climb_inside(
        p, size, [&](const SectionPoint& q) { return contains(q[0], q[1]); }, f, largest);
  }

  bool is_corner(const SectionPoint& p) const {
    return rectangle_ && std::abs(p[0]) == half_[0] && std::abs(p[1]) == half_[1];
  }

  SectionPoint climb_circle(const Starts::Start& start, const StressSum& f, LargestSum& largest) const {
    const double ratio = start.curve == 0 ? hole_ : 1.0, a = ratio * half_[0], b = ratio * half_[1];
    const double step = 2.0 * kPi / kAngles, angle = step * static_cast<double>(start.node % kAngles);
    const auto circle = [&](double t) {
      const double c = std::cos(t), s = std::sin(t);
      return CurvePoint{a * c, b * s, -a * s, b * c, -a * c, -b * s};
    };
    return climb_along(circle, angle - step, angle + step, angle, f, largest);
  }

  /// Whether F falls from a corner, where shear stresses are zero, up to a place of a side beside it.
  template <class Side>
  static bool falls_from_corner(const Side& side, double corner, double place, const StressSum& f) {
    const CurvePoint p = side(corner), q = side(place);
    const double sigma = f.normal.at(p.x2, p.x3), slope = f.normal.slope2 * p.d2 + f.normal.slope3 * p.d3;
    const double outward = place > corner ? 1.0 : -1.0;
    if (!(sigma * slope * outward < 0.0)) return false;
    const PlaneJet j = f.jet(q.x2, q.x3);
    return (j.d2 * q.d2 + j.d3 * q.d3) * outward < 0.0;
  }

  /// Along a side of the rectangle between the samples beside a start. At a corner derivatives are infinite.
  SectionPoint climb_side(const Starts::Start& start, const StressSum& f, LargestSum& largest) const {
    const bool along3 = start.curve < 2;
    const std::size_t count = along3 ? grid_.columns : grid_.rows, stride = along3 ? 1 : grid_.columns;
    const std::size_t place = along3 ? start.node % grid_.columns : start.node / grid_.columns;
    const std::vector<double>& x = along3 ? grid_.x3 : grid_.x2;
    const double fixed = along3 ? grid_.x2[start.node] : grid_.x3[start.node], here = x[start.node];
    const double from = place == 0 ? here : x[start.node - stride];
    const double to = place + 1 == count ? here : x[start.node + stride];
    const bool corner = place == 0 || place + 1 == count;
    const double t = corner ? 0.5 * (from + to) : here;
    const auto side = [&](double s) {
      return along3 ? CurvePoint{fixed, s, 0.0, 1.0, 0.0, 0.0} : CurvePoint{s, fixed, 1.0, 0.0, 0.0, 0.0};
    };
    if (corner && falls_from_corner(side, here, t, f)) return {grid_.x2[start.node], grid_.x3[start.node]};
    return climb_along(side, from, to, t, f, largest);
  }

  std::size_t node(std::size_t row, std::size_t column) const { return row * grid_.columns + column; }

  SolidShear shear_;
  bool rectangle_ = false;
  SectionPoint half_{};  ///< half sizes
  double hole_ = 0.0;    ///< tube: inner over outer radius
  SectionGrid grid_{};
};

}  // namespace

std::shared_ptr<const StressField> solid_stress_field(const SectionShape& shape) {
  return std::make_shared<SolidStressField>(shape);
}

}  // namespace mixbeam
