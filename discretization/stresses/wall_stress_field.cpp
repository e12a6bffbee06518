// I, box, T, L and U: shear stresses along walls.
#include "discretization/stresses/stress_field.hpp"

#include <gsl/gsl_poly.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace mixbeam {

namespace {

/// Distance at which the stresses of a wall end before the wall that it meets, over its length: a point belongs to one
/// wall only, whose stresses are reported for it.
constexpr double kInset = 1e-9;

/// c0 + c1 x + c2 x^2
struct Parabola {
  double c0 = 0.0, c1 = 0.0, c2 = 0.0;
  double at(double x) const { return c0 + x * (c1 + x * c2); }
};

Parabola sum_of_parabolas(double f, const Parabola& p, double g, const Parabola& q) {
  return {f * p.c0 + g * q.c0, f * p.c1 + g * q.c1, f * p.c2 + g * q.c2};
}

/// A straight wall along axis 2 or 3. The shear stress along it is a parabola of the coordinate x along the wall, for
/// each unit force, and linear through its thickness for a unit torque.
struct Wall {
  bool along2 = true;
  double from = 0.0, to = 0.0;  ///< of x
  double middle = 0.0;          ///< of the other coordinate
  double thickness = 0.0;
  double corner = 0.0;  ///< length beyond both ends, on the outer face, over which the shear stress of the end is kept
  Parabola of_force2{}, of_force3{};
  double circulating = 0.0;  ///< shear stress of a unit torque in the middle of the wall
  double twisting = 0.0;     ///< its increase per length across the wall

  /// Shear stress along the wall, at `across` from its middle.
  Parabola shear(const ShearLoad& load, double across) const {
    Parabola p = sum_of_parabolas(load[1], of_force2, load[2], of_force3);
    p.c0 += load[0] * (circulating + twisting * across);
    return p;
  }
  /// Normal stress along the wall as c0 + c1 x, at `across` from its middle.
  Parabola normal(const NormalStress& s, double across) const {
    const double other = middle + across;
    if (along2) return {s.constant + s.slope3 * other, s.slope2, 0.0};
    return {s.constant + s.slope2 * other, s.slope3, 0.0};
  }
  SectionPoint point(double x, double across) const {
    if (along2) return {x, middle + across};
    return {middle + across, x};
  }
};

/// Where sigma^2 + 3 tau^2 has its one local maximum along a line, if any: the middle root of the derivative, a cubic
/// with positive leading coefficient. `h`: half the length of the line, for scaling.
bool inner_maximum(const Parabola& sigma, const Parabola& tau, double h, double& x) {
  const double r = tau.c2 * h * h, q = tau.c1 * h, p = tau.c0, a = sigma.c0, b = sigma.c1 * h;
  if (r == 0.0) return false;  // convex
  const double lead = 12.0 * r * r;
  std::array<double, 3> root{};
  const int roots = gsl_poly_solve_cubic(18.0 * q * r / lead, (2.0 * b * b + 6.0 * q * q + 12.0 * p * r) / lead,
                                         (2.0 * a * b + 6.0 * p * q) / lead, &root[0], &root[1], &root[2]);
  x = h * root[1];
  return roots == 3 && std::isfinite(x);  // one real root: a minimum
}

constexpr double kEqualOnWalls = 1e-13;  // rounding of a dozen operations

void add_face(LargestVonMises& largest, const Wall& wall, double across, const NormalStress& normal,
              const ShearLoad& load) {
  const Parabola sigma = wall.normal(normal, across), tau = wall.shear(load, across);
  const auto add = [&](double x, double place) {
    const double s = sigma.at(place), along = tau.at(x);
    largest.add(s * s + 3.0 * along * along, wall.point(place, across));
  };
  for (const auto& [end, outward] : {std::pair{wall.from, -1.0}, std::pair{wall.to, 1.0}}) {
    add(end, end);
    if (across * wall.middle > 0.0 && wall.corner > 0.0) add(end, end + outward * wall.corner);
  }
  const double half = 0.5 * (wall.to - wall.from), middle = 0.5 * (wall.to + wall.from);
  const auto shifted = [&](const Parabola& p) { return Parabola{p.at(middle), p.c1 + 2.0 * p.c2 * middle, p.c2}; };
  double x = 0.0;
  if (!inner_maximum(shifted(sigma), shifted(tau), half, x) || std::abs(x) >= half) return;
  add(middle + x, middle + x);
}

class FieldOfWalls : public StressField {
 public:
  using StressField::StressField;

  std::array<double, 2> shear(const ShearLoad& load, double x2, double x3) const override {
    const Wall& wall = wall_at(x2, x3);
    const double x = wall.along2 ? x2 : x3, across = (wall.along2 ? x3 : x2) - wall.middle;
    const double tau = wall.shear(load, across).at(std::clamp(x, wall.from, wall.to));
    if (wall.along2) return {tau, 0.0};
    return {0.0, tau};
  }

  /// Searches the faces of walls: across a wall stresses are linear, so the sum of their squares is largest there.
  LargestStress largest_von_mises(const NormalStress& normal, const ShearLoad& load) const override {
    LargestVonMises largest(kEqualOnWalls);
    for (const Wall& wall : walls_)
      for (const double side : {0.5, -0.5}) add_face(largest, wall, side * wall.thickness, normal, load);
    return largest.found();
  }

 protected:
  virtual const Wall& wall_at(double x2, double x3) const = 0;

  std::vector<Wall> walls_{};
};

class WallStressField : public FieldOfWalls {
 public:
  explicit WallStressField(const SectionShape& shape)
      : FieldOfWalls(shape), shape_(shape), sharp_(section_geometry(sharp_shape(shape))) {
    if (shape.kind == SectionShapeKind::box)
      add_walls_of_box();
    else
      add_walls_of_i();
  }

  bool contains(double x2, double x3) const override {
    const double rounding = 1e-12;  // of coordinates that come from text or from sums
    const double reach2 = 0.5 * shape_.size2, reach3 = 0.5 * shape_.size3, y2 = std::abs(x2), y3 = std::abs(x3);
    if (y2 > reach2 * (1.0 + rounding) || y3 > reach3 * (1.0 + rounding)) return false;
    const bool in_flange = y3 >= (reach3 - shape_.wall) * (1.0 - rounding);
    if (shape_.kind == SectionShapeKind::box) return in_flange || y2 >= (reach2 - shape_.wall) * (1.0 - rounding);
    return in_flange || y2 <= 0.5 * shape_.web * (1.0 + rounding);
  }

  SectionPoint farthest(double direction2, double direction3) const override {
    return {std::copysign(0.5 * shape_.size2, direction2), std::copysign(0.5 * shape_.size3, direction3)};
  }

 private:
  // I: four halves of flanges, web; box: two along axis 2, two along axis 3
  const Wall& wall_at(double x2, double x3) const override {
    const double beyond3 = std::abs(x3) - (0.5 * shape_.size3 - shape_.wall);
    if (shape_.kind == SectionShapeKind::box) {
      const double beyond2 = std::abs(x2) - (0.5 * shape_.size2 - shape_.wall);
      return beyond3 >= beyond2 ? walls_[x3 >= 0.0 ? 0 : 1] : walls_[x2 >= 0.0 ? 2 : 3];
    }
    if (beyond3 < 0.0) return walls_[4];
    return walls_[(x3 >= 0.0 ? 0 : 2) + (x2 >= 0.0 ? 0 : 1)];
  }

  void add_walls_of_i() {
    const auto [i2, i3] = sharp_.second_moment;
    const double half = 0.5 * shape_.size2, arm = 0.5 * (shape_.size3 - shape_.wall),
                 reach = 0.5 * shape_.size3 - shape_.wall;
    for (const double top : {1.0, -1.0})
      for (const double right : {1.0, -1.0}) {
        Wall flange;
        flange.from = std::min(right * kInset * half, right * half);
        flange.to = std::max(right * kInset * half, right * half);
        flange.middle = top * arm;
        flange.thickness = shape_.wall;
        flange.of_force2 = {0.5 * half * half / i3, 0.0, -0.5 / i3};
        flange.of_force3 = {top * right * arm * half / i2, -top * arm / i2, 0.0};
        flange.twisting = -2.0 / geometry().torsion_constant;
        walls_.push_back(flange);
      }
    Wall web;
    web.along2 = false;
    web.from = -(1.0 - kInset) * reach;
    web.to = (1.0 - kInset) * reach;
    web.thickness = shape_.web;
    web.of_force3 = {shape_.size2 * shape_.wall * arm / (i2 * shape_.web) + 0.5 * reach * reach / i2, 0.0, -0.5 / i2};
    web.twisting = 2.0 / geometry().torsion_constant;
    walls_.push_back(web);
  }

  /// A wall of a box along one axis: `length` and `other` are the outer dimensions along and across it.
  Wall box_wall(bool along2, double side, double length, double other) const {
    const double t = shape_.wall, arm = 0.5 * (other - t), reach = 0.5 * length - t, j = sharp_.torsion_constant;
    const double i_along = sharp_.second_moment[along2 ? 1 : 0], i_across = sharp_.second_moment[along2 ? 0 : 1];
    Wall wall;
    wall.along2 = along2;
    wall.to = along2 ? reach : (1.0 - kInset) * reach;
    wall.from = -wall.to;
    wall.middle = side * arm;
    wall.thickness = t;
    wall.corner = along2 ? (1.0 - kInset) * t : t;
    // first moments of both walls across this one, and of the parts beyond x of the two along it
    const Parabola carried = {0.5 * other * 0.5 * (length - t) / i_along + 0.5 * reach * reach / i_along, 0.0,
                              -0.5 / i_along};
    const Parabola led = {0.0, -side * arm / i_across, 0.0};  // from its middle to the walls that carry
    wall.of_force2 = along2 ? carried : led;
    wall.of_force3 = along2 ? led : carried;
    const double turn = along2 ? -1.0 : 1.0;  // T > 0 turns from axis 2 to axis 3
    const double enclosed = (shape_.size2 - t) * (shape_.size3 - t), round = shape_.size2 + shape_.size3 - 2.0 * t;
    wall.circulating = turn * side * enclosed / (round * j);
    wall.twisting = turn * 2.0 / j;
    return wall;
  }

  void add_walls_of_box() {
    for (const double side : {1.0, -1.0}) walls_.push_back(box_wall(true, side, shape_.size2, shape_.size3));
    for (const double side : {1.0, -1.0}) walls_.push_back(box_wall(false, side, shape_.size3, shape_.size2));
  }

  SectionShape shape_;
  SectionGeometry sharp_;  ///< without fillets: shear flows, which then balance the walls that are drawn
};

/// T, L and U. The flow q along a wall has dq/dx = -t sigma', sigma' = a2 x2 + a3 x3 the rate of the normal stress that
/// makes Q2 or Q3, and no flow at free ends.
class RectangleStressField : public FieldOfWalls {
 public:
  explicit RectangleStressField(const SectionShape& shape)
      : FieldOfWalls(shape), rectangles_(section_rectangles(shape)) {
    const WallRectangle &first = rectangles_[0], &last = rectangles_.back();
    const double far = last.middle(1) < first.middle(1) ? last.from[1] : last.to[1];
    if (shape.kind == SectionShapeKind::t_section) {
      add_wall(first, 0, first.from[0], first.from[0], first.middle(0) - kInset * shape.size2);
      add_wall(first, 0, first.to[0], first.middle(0) + kInset * shape.size2, first.to[0]);
      add_upright(last, far);
    } else if (shape.kind == SectionShapeKind::l_section) {
      add_wall(first, 0, first.to[0], first.from[0], first.to[0]);
      add_upright(last, far);
    } else {
      const WallRectangle& bottom = rectangles_[1];
      add_wall(first, 0, first.to[0], first.from[0], first.to[0]);
      add_wall(bottom, 0, bottom.to[0], bottom.from[0], bottom.to[0]);
      add_upright(last, last.from[1], &bottom);
    }
  }

  const Wall& wall_at(double x2, double x3) const override {
    const auto outside = [&](const Wall& wall) {
      const double x = wall.along2 ? x2 : x3, across = std::abs((wall.along2 ? x3 : x2) - wall.middle);
      const double beyond = std::max({wall.from - x, x - wall.to, across - 0.5 * wall.thickness});
      return std::max(beyond, kOnEdge * (wall.to - wall.from));
    };
    const auto nearer = [&](const Wall& a, const Wall& b) { return outside(a) < outside(b); };
    return *std::min_element(walls_.begin(), walls_.end(), nearer);
  }

  bool contains(double x2, double x3) const override {
    const std::array<double, 2> x{x2, x3};
    return std::any_of(rectangles_.begin(), rectangles_.end(), [&](const WallRectangle& wall) {
      const double rounding = 1e-12 * (wall.length(0) + wall.length(1));
      bool inside = true;
      for (std::size_t i = 0; i < 2; ++i)
        inside = inside && x[i] >= wall.from[i] - rounding && x[i] <= wall.to[i] + rounding;
      return inside;
    });
  }

  SectionPoint farthest(double direction2, double direction3) const override {
    SectionPoint found{};
    double most = -1.0;
    for (const WallRectangle& wall : rectangles_)
      for (const double x2 : {wall.to[0], wall.from[0]})
        for (const double x3 : {wall.to[1], wall.from[1]}) {
          const double reach = direction2 * x2 + direction3 * x3;
          if (most >= 0.0 && reach <= most) continue;
          most = std::max(reach, 0.0);
          found = {x2, x3};
        }
    return found;
  }
  SectionPoint farthest_against(double direction2, double direction3) const override {
    return farthest(-direction2, -direction3);
  }

 private:
  static constexpr double kOnEdge = 1e-12;  // of the length of a wall: rounding of coordinates

  /// Adds the part from..to of a rectangle, whose flow begins at `start` with that of `before`.
  void add_wall(const WallRectangle& r, std::size_t axis, double start, double from, double to,
                const WallRectangle* before = nullptr) {
    const auto [i2, i3] = geometry().second_moment;
    const double i23 = geometry().product_moment, determinant = i2 * i3 - i23 * i23;
    Wall wall;
    wall.along2 = axis == 0;
    wall.from = from;
    wall.to = to;
    wall.middle = r.middle(1 - axis);
    wall.thickness = r.length(1 - axis);
    wall.twisting = (wall.along2 ? -2.0 : 2.0) / geometry().torsion_constant;
    const auto flow = [&](double a2, double a3) {  // over the thickness
      const double even = (wall.along2 ? a3 : a2) * wall.middle, slope = wall.along2 ? a2 : a3;
      Parabola tau{even * start + 0.5 * slope * start * start, -even, -0.5 * slope};
      if (before != nullptr)
        tau.c0 -=
            before->length(0) * before->length(1) * (a2 * before->middle(0) + a3 * before->middle(1)) / wall.thickness;
      return tau;
    };
    wall.of_force2 = flow(i2 / determinant, -i23 / determinant);
    wall.of_force3 = flow(-i23 / determinant, i3 / determinant);
    walls_.push_back(wall);
  }
  /// Adds a web or leg, which ends just before the walls that it meets.
  void add_upright(const WallRectangle& r, double start, const WallRectangle* before = nullptr) {
    const double inset = kInset * r.length(1);
    add_wall(r, 1, start, r.from[1] + inset, r.to[1] - inset, before);
  }

  std::vector<WallRectangle> rectangles_;
};

}  // namespace

std::shared_ptr<const StressField> wall_stress_field(const SectionShape& shape) {
  if (consists_of_rectangles(shape.kind)) return std::make_shared<RectangleStressField>(shape);
  return std::make_shared<WallStressField>(shape);
}

}  // namespace mixbeam
