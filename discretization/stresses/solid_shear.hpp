/// Saint-Venant's shear stresses in circle, tube, ellipse and rectangle: for unit forces a quadratic polynomial and a
/// harmonic part, combined for given forces.
#pragma once

#include "discretization/stresses/rectangle_series.hpp"
#include "discretization/stresses/stress_field.hpp"

#include <array>

namespace mixbeam {

/// A function of x2, x3 with its first and second derivatives.
struct PlaneJet {
  double value = 0.0, d2 = 0.0, d3 = 0.0, d22 = 0.0, d23 = 0.0, d33 = 0.0;
};

/// c0 + c2 x2 + c3 x3 + c22 x2^2 + c23 x2 x3 + c33 x3^2
struct PlaneQuadratic {
  double c0 = 0.0, c2 = 0.0, c3 = 0.0, c22 = 0.0, c23 = 0.0, c33 = 0.0;

  double at(double x2, double x3) const { return c0 + x2 * (c2 + c22 * x2 + c23 * x3) + x3 * (c3 + c33 * x3); }
  PlaneJet jet(double x2, double x3) const {
    return {at(x2, x3), c2 + 2.0 * c22 * x2 + c23 * x3, c3 + c23 * x2 + 2.0 * c33 * x3, 2.0 * c22, c23, 2.0 * c33};
  }
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
  std::array<PlaneJet, 2> jets(double x2, double x3) const;

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
