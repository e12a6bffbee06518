/// Sections and forces for the tests of stresses, and integrals over a section that know nothing of its fields.
#pragma once

#include "discretization/scene/section_shape.hpp"
#include "discretization/stresses/section_stresses.hpp"
#include "tests/support/numbers.hpp"

#include <array>
#include <cmath>
#include <functional>
#include <random>
#include <string>
#include <vector>

namespace mixbeam::test {

struct NamedShape {
  std::string name;
  SectionShape shape;
};

inline SectionShape stress_shape(SectionShapeKind kind, double nu, std::array<double, 4> sizes) {
  SectionShape shape;
  shape.kind = kind;
  shape.size2 = sizes[0];
  shape.size3 = sizes[1];
  shape.wall = sizes[2];
  shape.web = sizes[3];
  shape.youngs_modulus = 1.0;
  shape.poisson_ratio = nu;
  return shape;
}

/// Fields exact in the theory of elasticity.
inline std::vector<NamedShape> solid_shapes(double nu) {
  using Kind = SectionShapeKind;
  return {{"circle", stress_shape(Kind::circle, nu, {2.0})},
          {"tube", stress_shape(Kind::tube, nu, {2.0, 0.0, 0.3})},
          {"thin tube", stress_shape(Kind::tube, nu, {2.0, 0.0, 0.02})},
          {"ellipse", stress_shape(Kind::ellipse, nu, {1.0, 1.7})},
          {"flat ellipse", stress_shape(Kind::ellipse, nu, {3.0, 0.4})},
          {"square", stress_shape(Kind::rectangle, nu, {1.0, 1.0})},
          {"rectangle", stress_shape(Kind::rectangle, nu, {0.9, 2.0})},
          {"flat rectangle", stress_shape(Kind::rectangle, nu, {2.0, 0.5})},
          {"strip", stress_shape(Kind::rectangle, nu, {0.05, 1.0})}};
}

inline std::vector<NamedShape> walled_shapes() {
  using Kind = SectionShapeKind;
  return {{"IPE 200", stress_shape(Kind::i_section, 0.3, {0.1, 0.2, 0.0085, 0.0056})},
          {"HEM 200", stress_shape(Kind::i_section, 0.3, {0.206, 0.22, 0.025, 0.015})},
          {"box 50 x 100 x 5", stress_shape(Kind::box, 0.3, {0.05, 0.1, 0.005})},
          {"box 100 x 100 x 3", stress_shape(Kind::box, 0.3, {0.1, 0.1, 0.003})}};
}

inline double height_of(const SectionShape& s) {
  const bool round = s.kind == SectionShapeKind::circle || s.kind == SectionShapeKind::tube;
  return round ? s.size2 : s.size3;
}

/// Forces that make stresses of order one, each component zero in one case of three.
template <class Generator>
SectionForces random_forces(const SectionShape& shape, Generator& generator) {
  std::uniform_real_distribution<double> number(-1.0, 1.0);
  const auto draw = [&] { return generator() % 3 == 0 ? 0.0 : number(generator); };
  const SectionGeometry g = section_geometry(shape);
  const double b = shape.size2, h = height_of(shape);
  SectionForces f;
  for (double& force : f.force) force = g.area * draw();
  f.moment = {g.torsion_constant / std::fmin(b, h) * draw(), g.second_moment[0] / h * draw(),
              g.second_moment[1] / b * draw()};
  return f;
}

/// Gauss points and weights on [from, to].
struct Quadrature {
  std::vector<double> points, weights;
};
inline Quadrature gauss_panels(const std::vector<double>& ends) {
  // ten points on [-1, 1], Abramowitz and Stegun, table 25.4
  constexpr std::array<double, 5> x = {0.148874338981631211, 0.433395394129247191, 0.679409568299024406,
                                       0.865063366688984511, 0.973906528517171720};
  constexpr std::array<double, 5> w = {0.295524224714752870, 0.269266719309996355, 0.219086362515982044,
                                       0.149451349150580593, 0.066671344308688138};
  Quadrature q;
  for (std::size_t i = 0; i + 1 < ends.size(); ++i)
    for (std::size_t k = 0; k < x.size(); ++k)
      for (const double side : {-1.0, 1.0}) {
        const double half = 0.5 * (ends[i + 1] - ends[i]);
        q.points.push_back(0.5 * (ends[i] + ends[i + 1]) + side * half * x[k]);
        q.weights.push_back(half * w[k]);
      }
  return q;
}

/// Panels that shrink towards both ends of [-half, half], for fields with weak singularities in the corners.
inline std::vector<double> graded_panels(double half) {
  std::vector<double> ends = {0.0};
  for (double gap = 0.5; gap > 1e-5; gap *= 0.3) ends.push_back(half * (1.0 - gap));
  ends.push_back(half);
  std::vector<double> both(ends.rbegin(), ends.rend() - 1);
  for (double& end : both) end = -end;
  both.insert(both.end(), ends.begin(), ends.end());
  return both;
}

using PointFunction = std::function<std::array<double, 8>(double x2, double x3)>;
using Integrals = std::array<double, 8>;

inline void add_rectangle(const Quadrature& along2, const Quadrature& along3, const PointFunction& f, Integrals& sum) {
  for (std::size_t i = 0; i < along2.points.size(); ++i)
    for (std::size_t j = 0; j < along3.points.size(); ++j) {
      const auto value = f(along2.points[i], along3.points[j]);
      for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += along2.weights[i] * along3.weights[j] * value[k];
    }
}

/// Rings by Gauss' rule, around by equal steps.
inline void add_round(const SectionShape& s, const PointFunction& f, Integrals& sum) {
  const double a = 0.5 * s.size2, b = 0.5 * height_of(s);
  const double hole = s.kind == SectionShapeKind::tube ? 1.0 - 2.0 * s.wall / s.size2 : 0.0;
  const Quadrature radii = gauss_panels({hole, 0.5 * (1.0 + hole), 1.0});
  constexpr int kSteps = 64;
  for (std::size_t i = 0; i < radii.points.size(); ++i)
    for (int j = 0; j < kSteps; ++j) {
      const double r = radii.points[i], angle = 2.0 * kPi * (j + 0.5) / kSteps;
      const auto value = f(r * a * std::cos(angle), r * b * std::sin(angle));
      const double weight = radii.weights[i] * 2.0 * kPi / kSteps * r * a * b;
      for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += weight * value[k];
    }
}

/// Over the whole section, walls one by one.
inline Integrals integrate(const SectionShape& s, const PointFunction& f) {
  Integrals sum{};
  const double half2 = 0.5 * s.size2, half3 = 0.5 * s.size3;
  if (s.kind == SectionShapeKind::rectangle) {
    add_rectangle(gauss_panels(graded_panels(half2)), gauss_panels(graded_panels(half3)), f, sum);
  } else if (s.kind == SectionShapeKind::i_section) {
    const double reach = half3 - s.wall;
    for (const auto& flange : {gauss_panels({-half3, -reach}), gauss_panels({reach, half3})})
      add_rectangle(gauss_panels({-half2, 0.0, half2}), flange, f, sum);
    add_rectangle(gauss_panels({-0.5 * s.web, 0.5 * s.web}), gauss_panels({-reach, reach}), f, sum);
  } else if (s.kind == SectionShapeKind::box) {
    const double reach2 = half2 - s.wall, reach3 = half3 - s.wall;
    for (const auto& flange : {gauss_panels({-half3, -reach3}), gauss_panels({reach3, half3})})
      add_rectangle(gauss_panels({-half2, -reach2, reach2, half2}), flange, f, sum);
    for (const auto& web : {gauss_panels({-half2, -reach2}), gauss_panels({reach2, half2})})
      add_rectangle(web, gauss_panels({-reach3, reach3}), f, sum);
  } else if (consists_of_rectangles(s.kind)) {
    for (const WallRectangle& wall : section_rectangles(s))
      add_rectangle(gauss_panels({wall.from[0], wall.middle(0), wall.to[0]}),
                    gauss_panels({wall.from[1], wall.middle(1), wall.to[1]}), f, sum);
  } else {
    add_round(s, f, sum);
  }
  return sum;
}

/// N, Q2, Q3, T, M2, M3 of a field of stresses, and the integrals of sigma^2 and tau^2.
inline Integrals resultants(const SectionShape& shape, const std::function<PointStress(double, double)>& stress) {
  return integrate(shape, [&](double x2, double x3) {
    const PointStress s = stress(x2, x3);
    const auto [t12, t13] = s.shear;
    return std::array<double, 8>{s.normal,
                                 t12,
                                 t13,
                                 x2 * t13 - x3 * t12,
                                 x3 * s.normal,
                                 -x2 * s.normal,
                                 s.normal * s.normal,
                                 t12 * t12 + t13 * t13};
  });
}

}  // namespace mixbeam::test
