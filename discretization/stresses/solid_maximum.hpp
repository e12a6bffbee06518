/// F = sigma^2 + 3 tau^2 over a solid section, and the way from a sample of it to a local maximum.
#pragma once

#include "discretization/stresses/solid_shear.hpp"
#include "discretization/stresses/stress_field.hpp"

#include <cmath>

namespace mixbeam {

/// Last step of Newton's method over the distance of samples: F is off by the square of it.
inline constexpr double kEnough = 1e-6;

/// F and where it is wanted.
struct StressSum {
  NormalStress normal{};
  CombinedShear shear{};

  double at(double x2, double x3) const {
    const double s = normal.at(x2, x3);
    const auto [t, u] = shear.at(x2, x3);
    return s * s + 3.0 * (t * t + u * u);
  }
  PlaneJet jet(double x2, double x3) const {
    const double s = normal.at(x2, x3), s2 = normal.slope2, s3 = normal.slope3;
    PlaneJet f{s * s, 2.0 * s * s2, 2.0 * s * s3, 2.0 * s2 * s2, 2.0 * s2 * s3, 2.0 * s3 * s3};
    for (const PlaneJet& t : shear.jets(x2, x3)) {
      f.value += 3.0 * t.value * t.value;
      f.d2 += 6.0 * t.value * t.d2;
      f.d3 += 6.0 * t.value * t.d3;
      f.d22 += 6.0 * (t.d2 * t.d2 + t.value * t.d22);
      f.d23 += 6.0 * (t.d2 * t.d3 + t.value * t.d23);
      f.d33 += 6.0 * (t.d3 * t.d3 + t.value * t.d33);
    }
    return f;
  }
};

/// The largest F so far; of equal ones the first.
struct LargestSum {
  double value = 0.0;
  SectionPoint point{};
  void add(double f, double x2, double x3) {
    constexpr double kEqual = 1e-12;  // rounding of fields and series
    if (f <= value * (1.0 + kEqual)) return;
    value = f;
    point = {x2, x3};
  }
};

/// Place on a boundary curve with its first and second derivatives by the curve's parameter.
struct CurvePoint {
  double x2 = 0.0, x3 = 0.0, d2 = 0.0, d3 = 0.0, dd2 = 0.0, dd3 = 0.0;
};

/// Maximum along a curve between two parameters, from `t`; returns its place.
template <class Curve>
SectionPoint climb_along(const Curve& curve, double from, double to, double t, const StressSum& f,
                         LargestSum& largest) {
  const double enough = kEnough * (to - from);
  CurvePoint p;
  for (int i = 0; i < 40; ++i) {  // halving alone needs 20
    p = curve(t);
    const PlaneJet j = f.jet(p.x2, p.x3);
    largest.add(j.value, p.x2, p.x3);
    const double slope = j.d2 * p.d2 + j.d3 * p.d3;
    const double bend =
        j.d22 * p.d2 * p.d2 + 2.0 * j.d23 * p.d2 * p.d3 + j.d33 * p.d3 * p.d3 + j.d2 * p.dd2 + j.d3 * p.dd3;
    (slope > 0.0 ? from : to) = t;
    double next = bend < 0.0 ? t - slope / bend : from - 1.0;
    if (!(next > from && next < to)) next = 0.5 * (from + to);
    if (std::abs(next - t) <= enough) break;
    t = next;
  }
  return {p.x2, p.x3};
}

/// Maximum inside, by Newton's method in coordinates of size one; steps stay inside and climb.
template <class Inside>
void climb_inside(SectionPoint p, const SectionPoint& size, const Inside& inside, const StressSum& f,
                  LargestSum& largest) {
  PlaneJet j = f.jet(p[0], p[1]);
  for (int i = 0; i < 20; ++i) {
    largest.add(j.value, p[0], p[1]);
    const double g2 = j.d2 * size[0], g3 = j.d3 * size[1], h22 = j.d22 * size[0] * size[0],
                 h23 = j.d23 * size[0] * size[1], h33 = j.d33 * size[1] * size[1], det = h22 * h33 - h23 * h23;
    double s2 = 0.0, s3 = 0.0;
    if (h22 < 0.0 && det > 0.0) {
      s2 = -(h33 * g2 - h23 * g3) / det;
      s3 = -(h22 * g3 - h23 * g2) / det;
    } else {
      const double g = std::hypot(g2, g3);
      if (g == 0.0) return;
      s2 = 0.1 * g2 / g;
      s3 = 0.1 * g3 / g;
    }
    double fraction = 1.0;
    for (bool higher = false; !higher; fraction *= 0.5) {
      if (!(fraction * std::hypot(s2, s3) > kEnough)) return;  // nan, too
      const SectionPoint next = {p[0] + fraction * s2 * size[0], p[1] + fraction * s3 * size[1]};
      if (!inside(next)) continue;
      const PlaneJet there = f.jet(next[0], next[1]);
      if (there.value < j.value) continue;
      higher = true;
      p = next;
      j = there;
    }
  }
}

}  // namespace mixbeam
