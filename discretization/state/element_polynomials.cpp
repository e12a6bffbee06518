#include "discretization/state/element_polynomials.hpp"

#include <algorithm>

namespace mixbeam {

namespace {

/// Legendre coefficients of one component of N through its `count` Gauss points, from point `first` on.
void fit_force(const InteriorLayout& layout, const double* interior, int first, int count, int component,
               Coefficients& force) {
  const GaussPoints& rule = gauss_points(count);
  for (int q = 0; q < count; ++q) {
    double P[kMaximumOrder + 1];
    legendre(count - 1, rule.xi[q], P);
    const double n = interior[layout.force(first + q) + component];
    for (int j = 0; j < count; ++j) force[j][component] += 0.5 * (2 * j + 1) * rule.weight[q] * P[j] * n;
  }
}

/// Inverse of fit_force; degrees beyond that of the points are dropped.
void put_force(const InteriorLayout& layout, const Coefficients& force, int first, int count, int component,
               double* interior) {
  for (int q = 0; q < count; ++q) {
    double P[kMaximumOrder + 1];
    legendre(count - 1, gauss_points(count).xi[q], P);
    double n = 0.0;
    for (int j = 0; j < count; ++j) n += P[j] * force[j][component];
    interior[layout.force(first + q) + component] = n;
  }
}

InteriorLayout layout_of(const Member& member) {
  return {member.order, force_point_count(member.order, member.force_integration)};
}

constexpr int kMaximumPoints = kMaximumOrder + 1;

/// Calls visit(q, Lagrange polynomial of point q at xi) for each of `count` Gauss points.
template <class Visit>
void for_each_lagrange(int count, double xi, const Visit& visit) {
  double points[kMaximumPoints], weights[kMaximumPoints];
  gauss_rule(count, points, weights);
  for (int q = 0; q < count; ++q) {
    double lagrange = 1.0;
    for (int p = 0; p < count; ++p)
      if (p != q) lagrange *= (xi - points[p]) / (points[q] - points[p]);
    visit(q, lagrange);
  }
}

/// Value at xi of the polynomial through `count` Gauss points; `values(q)` is the vector at point q.
template <class Values>
Vec interpolate_gauss(int count, double xi, const Values& values) {
  Vec sum{{0.0, 0.0, 0.0}};
  for_each_lagrange(count, xi, [&](int q, double lagrange) { sum += lagrange * values(q); });
  return sum;
}

}  // namespace

Vec force_at(const ElementView& element, double xi) {
  Vec force{};
  const auto add = [&](int first, int count, int from, int to) {
    const Vec part = interpolate_gauss(count, xi, [&](int q) { return element.force(first + q); });
    for (int i = from; i < to; ++i) force[i] = part[i];
  };
  for_each_force_rule(element.order(), element.block().force_integration, add);
  return force;
}

void add_force_derivative(const ElementView& element, double xi, const Vec& weight, double* rows) {
  for_each_force_rule(element.order(), element.block().force_integration, [&](int first, int count, int from, int to) {
    for_each_lagrange(count, xi, [&](int q, double lagrange) {
      for (int i = from; i < to; ++i) rows[element.layout().force(first + q) + i] += lagrange * weight[i];
    });
  });
}

Vec force_through_space_at(const ElementView& element, double xi) {
  const auto turned = [&](double at) {
    double P[kMaximumOrder + 1];
    legendre(element.order(), at, P);
    return rotation_matrix(exp_quaternion(element.relative_rotation_at(P)));
  };
  const int points = axial_points(element.order(), element.block().force_integration);
  return transpose(turned(xi)) * interpolate_gauss(points, xi, [&](int q) {
           const double at = gauss_points(points).xi[q];
           return turned(at) * force_at(element, at);
         });
}

Vec value_at(const Coefficients& coefficients, int degree, const double* P) {
  Vec sum{{0.0, 0.0, 0.0}};
  for (int j = 0; j <= degree; ++j) sum += P[j] * coefficients[j];
  return sum;
}

ElementPolynomials polynomials_of(const Member& member, double length, const double* start, const double* end,
                                  const double* triad, const double* interior) {
  const InteriorLayout layout = layout_of(member);
  ElementPolynomials element;
  element.start = load_vector(start);
  element.slope[0] = (1.0 / length) * (load_vector(end) - element.start);
  element.triad = load_quaternion(triad);
  for (int j = 1; j < member.order; ++j) {
    element.slope[j] = load_vector(interior + layout.bubble(j));
    element.psi[j] = load_vector(interior + layout.relative_rotation(j));
  }
  for (int j = 0; j <= member.order; ++j) element.moment[j] = load_vector(interior + layout.moment(j));
  for_each_force_rule(member.order, member.force_integration, [&](int first, int count, int from, int to) {
    for (int i = from; i < to; ++i) fit_force(layout, interior, first, count, i, element.force);
  });
  return element;
}

void store_polynomials(const Member& member, const ElementPolynomials& element, double* triad, double* interior) {
  const InteriorLayout layout = layout_of(member);
  std::fill_n(interior, layout.unknowns(), 0.0);  // a force point may carry one part only
  store_quaternion(element.triad, triad);
  for (int j = 1; j < member.order; ++j) {
    store_vector(element.slope[j], interior + layout.bubble(j));
    store_vector(element.psi[j], interior + layout.relative_rotation(j));
  }
  for (int j = 0; j <= member.order; ++j) store_vector(element.moment[j], interior + layout.moment(j));
  for_each_force_rule(member.order, member.force_integration, [&](int first, int count, int from, int to) {
    for (int i = from; i < to; ++i) put_force(layout, element.force, first, count, i, interior);
  });
}

}  // namespace mixbeam
