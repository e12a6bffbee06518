#include "discretization/stresses/solid_shear.hpp"

#include "kernels/math/constants.hpp"

namespace mixbeam {

namespace {

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

/// Adds the real or the imaginary part of factor f(z), whose derivative by x3 is i f'.
void add_real(PlaneJet& jet, const AnalyticJet& f) {
  jet.value += f.value.real();
  jet.d2 += f.first.real();
  jet.d3 -= f.first.imag();
  jet.d22 += f.second.real();
  jet.d23 -= f.second.imag();
  jet.d33 -= f.second.real();
}
void add_imaginary(PlaneJet& jet, const AnalyticJet& f) {
  jet.value += f.value.imag();
  jet.d2 += f.first.imag();
  jet.d3 += f.first.real();
  jet.d22 += f.second.imag();
  jet.d23 += f.second.real();
  jet.d33 -= f.second.imag();
}

}  // namespace

std::array<double, 2> CombinedShear::at(double x2, double x3) const {
  Complex f = 0.0;  // tau_13 + i tau_12
  const Complex z{x2, x3};
  if (dipole_ != 0.0) f += dipole_ / (z * z);
  for (int i = 0; i < count_; ++i) f += parts_[i].factor * parts_[i].series->value(z);
  return {polynomials_.tau12.at(x2, x3) + f.imag(), polynomials_.tau13.at(x2, x3) + f.real()};
}

std::array<PlaneJet, 2> CombinedShear::jets(double x2, double x3) const {
  std::array<PlaneJet, 2> tau = {polynomials_.tau12.jet(x2, x3), polynomials_.tau13.jet(x2, x3)};
  const Complex z{x2, x3};
  const auto add = [&](const AnalyticJet& f) {
    add_imaginary(tau[0], f);
    add_real(tau[1], f);
  };
  if (dipole_ != 0.0) {
    const Complex f = dipole_ / (z * z), slope = -2.0 * f / z;
    add({f, slope, -3.0 * slope / z});
  }
  for (int i = 0; i < count_; ++i) {
    AnalyticJet f = parts_[i].series->jet(z);
    for (Complex* value : {&f.value, &f.first, &f.second}) *value *= parts_[i].factor;
    add(f);
  }
  return tau;
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
