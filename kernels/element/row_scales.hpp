/// Scales that divide the rows of the mixed residual, theory (40): one tolerance then means the same accuracy for any
/// units, slenderness and load.
#pragma once

#include "kernels/element/layout.hpp"
#include "kernels/execution/pack.hpp"

namespace mixbeam {

struct ResidualScales {
  double force = 1.0;      ///< vertex force rows
  double moment = 1.0;     ///< vertex moment rows
  double strain = 1.0;     ///< N rows: a strain
  double rotation = 1.0;   ///< M rows: a relative rotation
  double length = 1.0;     ///< rows of prescribed displacements
  double amplitude = 1.0;  ///< displacement level of the structure: strain and rotation before they allow for rounding
  /// Rounding errors over the tolerance: of a rotation, and of a displacement (of a strain, once divided by a length).
  double rotation_noise = 0.0, displacement_noise = 0.0;

  // Scales of one element of length h. Its rows are integrals over it: a scale shared by short and long elements would
  // be below the rounding errors of the longest or far too large for the others.
  /// N rows
  template <class Real>
  KOKKOS_FORCEINLINE_FUNCTION Real element_strain(const Real& h) const {
    return larger(Real(strain), displacement_noise / h);
  }
  /// Spin and psi rows
  template <class Real>
  KOKKOS_FORCEINLINE_FUNCTION Real element_moment(const Real& h) const {
    return larger(Real(moment), force * h);
  }
  /// Beta rows
  template <class Real>
  KOKKOS_FORCEINLINE_FUNCTION Real element_bubble(const Real& h) const {
    return force * h;
  }

 private:
  template <class Real>
  KOKKOS_FORCEINLINE_FUNCTION static Real larger(const Real& a, const Real& b) {
    return select(b > a, b, a);
  }
};

/// Divides the interior rows of an element of length h by their scales; multiplies if `inverse`.
template <class Real>
KOKKOS_FORCEINLINE_FUNCTION void scale_interior_rows(const InteriorLayout& layout, const ResidualScales& scales,
                                                     const Real& h, bool inverse, Real* row) {
  const auto factor = [inverse](const Real& scale) { return inverse ? scale : 1.0 / scale; };
  const Real strain = factor(scales.element_strain(h)), rotation = factor(Real(scales.rotation)),
             spin = factor(scales.element_moment(h)), bubble = factor(scales.element_bubble(h));
  for (int i = 0; i < layout.moment(0); ++i) row[i] *= strain;
  for (int i = layout.moment(0); i < layout.relative_rotation(1); ++i) row[i] *= rotation;
  for (int i = layout.relative_rotation(1); i < layout.bubble(1); ++i) row[i] *= spin;
  for (int i = layout.bubble(1); i < layout.spin(); ++i) row[i] *= bubble;
  for (int i = layout.spin(); i < layout.increments(); ++i) row[i] *= spin;
}

}  // namespace mixbeam
