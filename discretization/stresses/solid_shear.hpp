/// Saint-Venant's shear stresses in circle, tube, ellipse and rectangle: for unit forces a quadratic polynomial and a
/// harmonic part, combined for given forces. The harmonic part of a rectangle is a series that converges slowly at the
/// edge, summed in closed form (dilogarithm) but for a rest that falls like exp(-pi n).
#pragma once

#include "discretization/stresses/stress_field.hpp"

#include <array>
#include <complex>
#include <vector>

namespace mixbeam {

using Complex = std::complex<double>;

/// f(z) = amplitude (S(p (-l + d z)) + sign S(p (-l - d z))) of z = x2 + i x3, where S(w) is
///   alternating: sum over m = 1, 2, 3, ... of (-1)^m / m^2 exp(m w) / (1 + q^m)
///   odd:         sum over n = 1, 3, 5, ... of (-1)^((n-1)/2) / n^2 exp(n w) / (1 + q^n), or 1 - q^n.
/// Then tau_13 + i tau_12 = f(z): equilibrium and compatibility are the equations of Cauchy and Riemann.
class RectangleSeries {
 public:
  enum class Kind { alternating, odd_plus, odd_minus };
  struct Form {
    Kind kind = Kind::alternating;
    double scale = 1.0;     ///< p > 0
    double reach = 1.0;     ///< l: |Re(d z)| is at most this
    Complex direction = 1;  ///< d: 1 or i
    double sign = 1.0;
    double ratio = 0.0;  ///< q, at most 0.05
    Complex amplitude = 0.0;
  };

  RectangleSeries() = default;
  explicit RectangleSeries(const Form& form);

  Complex value(Complex z) const;

  /// Of a unit torque in a rectangle of half sizes b along axis 2 and a along axis 3 with torsion constant J.
  /// Timoshenko and Goodier, art. 109; across the narrow side, where it converges.
  static RectangleSeries of_torque(double b, double a, double j);
  /// Of a unit force along axis 3; nu Poisson's ratio, i2 the second moment about axis 2. Timoshenko and Goodier,
  /// ch. 11. For flat ones by the series across the other side.
  static RectangleSeries of_force3(double b, double a, double i2, double nu);
  /// The same with axes exchanged.
  static RectangleSeries of_force2(double b, double a, double i3, double nu);

  /// Whether the series of a force runs along it: what `of_force3` expects of the polynomial beside it.
  static bool runs_along_force(double along, double across) { return along >= 0.5 * across; }

 private:
  Complex sum(Complex w) const;

  Form form_{};
  std::vector<double> coefficients_{};  ///< of exp(m w) with all of the denominator, up to where |exp(w)| = kSmall ends
  std::vector<double> rest_{};          ///< of exp(m w): what the closed form without q leaves
};

/// c0 + c2 x2 + c3 x3 + c22 x2^2 + c23 x2 x3 + c33 x3^2
struct PlaneQuadratic {
  double c0 = 0.0, c2 = 0.0, c3 = 0.0, c22 = 0.0, c23 = 0.0, c33 = 0.0;

  double at(double x2, double x3) const { return c0 + x2 * (c2 + c22 * x2 + c23 * x3) + x3 * (c3 + c33 * x3); }
  PlaneQuadratic& add(double factor, const PlaneQuadratic& other) {
    for (double PlaneQuadratic::*c : {&PlaneQuadratic::c0, &PlaneQuadratic::c2, &PlaneQuadratic::c3,
                                      &PlaneQuadratic::c22, &PlaneQuadratic::c23, &PlaneQuadratic::c33})
      this->*c += factor * (other.*c);
    return *this;
  }
};

/// Polynomial part of tau_12 and tau_13.
struct ShearPolynomials {
  PlaneQuadratic tau12{}, tau13{};
};

/// Shear stresses of given forces at any point.
class CombinedShear {
 public:
  std::array<double, 2> at(double x2, double x3) const;

 private:
  friend class SolidShear;
  struct Part {
    const RectangleSeries* series = nullptr;
    double factor = 0.0;
  };

  ShearPolynomials polynomials_{};
  Complex dipole_{};             ///< tube: of 1 / z^2
  std::array<Part, 3> parts_{};  ///< rectangle
  int count_ = 0;
};

class SolidShear {
 public:
  SolidShear(const SectionShape& shape, const SectionGeometry& geometry);

  /// Refers to this object.
  CombinedShear combined(const ShearLoad& load) const;

 private:
  void set_round(const SectionShape& shape, const SectionGeometry& geometry);
  void set_ellipse(const SectionShape& shape, const SectionGeometry& geometry);
  void set_rectangle(const SectionShape& shape, const SectionGeometry& geometry);

  std::array<ShearPolynomials, 3> unit_{};  ///< of T, Q2, Q3
  double dipole_ = 0.0;
  bool has_series_ = false;
  std::array<RectangleSeries, 3> series_{};
};

}  // namespace mixbeam
