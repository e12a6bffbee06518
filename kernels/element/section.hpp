/// Section whose 6 x 6 compliance S is not diagonal, or varies along the element, theory (13): gamma = S_NN N + S_NM M,
/// kappa = S_NM^T N + S_MM M. A rigid component has a zero row and column. The section type is a template argument of
/// the element kernels, so plain sections do not pay for this.
#pragma once

#include "kernels/element/layout.hpp"
#include "kernels/execution/pack.hpp"
#include "kernels/math/small_algebra.hpp"

namespace mixbeam {

template <class Real>
KOKKOS_INLINE_FUNCTION Mat3<Real> load_matrix(const Real* x) {
  return {{{x[0], x[1], x[2]}, {x[3], x[4], x[5]}, {x[6], x[7], x[8]}}};
}

/// Compliances of one element at its quadrature points.
template <class Real = double>
struct GeneralSection {
  const Real* compliance;  ///< GeneralSectionLayout
  GeneralSectionLayout layout;
  Real force_stiffness_limit, moment_stiffness_limit;  ///< SectionNumbers
  bool is_coupled = true;                              ///< S_NM is nonzero in some lane

  KOKKOS_INLINE_FUNCTION Mat3<Real> force_force(int q) const { return load_matrix(compliance + layout.force_force(q)); }
  KOKKOS_INLINE_FUNCTION Mat3<Real> force_moment(int q) const {
    return load_matrix(compliance + layout.force_moment(q));
  }
  KOKKOS_INLINE_FUNCTION Mat3<Real> moment_moment(int q) const {
    return load_matrix(compliance + layout.moment_moment(q));
  }
};

template <class AnySection>
constexpr bool kIsGeneral = false;
template <class Real>
constexpr bool kIsGeneral<GeneralSection<Real>> = true;

/// Compliance used by the tangent, theory (36): no diagonal entry below 1/limit. It stays positive (semi-)definite, and
/// becomes definite where a component is rigid.
template <class Real>
KOKKOS_INLINE_FUNCTION Mat3<Real> capped_compliance(Mat3<Real> compliance, const Real& limit) {
  const Real least = 1.0 / limit;
  for (int i = 0; i < 3; ++i) compliance(i, i) = select(compliance(i, i) < least, least, compliance(i, i));
  return compliance;
}

/// Inverse of a symmetric positive definite matrix, by cofactors. Rows and columns may differ in units: every entry is
/// a sum of products of equal units.
template <class Real>
KOKKOS_INLINE_FUNCTION Mat3<Real> inverse_of_symmetric(const Mat3<Real>& m) {
  const Real c00 = m(1, 1) * m(2, 2) - m(1, 2) * m(1, 2);
  const Real c01 = m(0, 2) * m(1, 2) - m(0, 1) * m(2, 2);
  const Real c02 = m(0, 1) * m(1, 2) - m(0, 2) * m(1, 1);
  const Real c11 = m(0, 0) * m(2, 2) - m(0, 2) * m(0, 2);
  const Real c12 = m(0, 1) * m(0, 2) - m(0, 0) * m(1, 2);
  const Real c22 = m(0, 0) * m(1, 1) - m(0, 1) * m(0, 1);
  const Real f = 1.0 / (m(0, 0) * c00 + m(0, 1) * c01 + m(0, 2) * c02);
  return {{{f * c00, f * c01, f * c02}, {f * c01, f * c11, f * c12}, {f * c02, f * c12, f * c22}}};
}

}  // namespace mixbeam
