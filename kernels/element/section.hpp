/// A section whose 6 x 6 compliance S is not diagonal, or varies along the element:
///   gamma = S_NN N + S_NM M,   kappa = S_NM^T N + S_MM M.
/// A rigid component has a zero row and column. Elements of plain sections never see any of this: which of the two an
/// element has is a template argument of its kernels.
#pragma once

#include "kernels/element/layout.hpp"
#include "kernels/math/small_algebra.hpp"

#include <type_traits>

namespace mixbeam {

KOKKOS_INLINE_FUNCTION Mat3<double> load_matrix(const double* x) {
  return {{{x[0], x[1], x[2]}, {x[3], x[4], x[5]}, {x[6], x[7], x[8]}}};
}

/// Compliances of one element at its quadrature points.
struct GeneralSection {
  const double* compliance;  ///< GeneralSectionLayout
  GeneralSectionLayout layout;
  double force_stiffness_limit, moment_stiffness_limit;  ///< SectionConstants

  KOKKOS_INLINE_FUNCTION Mat3<double> force_force(int q) const {
    return load_matrix(compliance + layout.force_force(q));
  }
  KOKKOS_INLINE_FUNCTION Mat3<double> force_moment(int q) const {
    return load_matrix(compliance + layout.force_moment(q));
  }
  KOKKOS_INLINE_FUNCTION Mat3<double> moment_moment(int q) const {
    return load_matrix(compliance + layout.moment_moment(q));
  }
};

template <class AnySection>
constexpr bool kIsGeneral = std::is_same_v<AnySection, GeneralSection>;

/// The compliance that the tangent uses: no entry of the diagonal below 1/limit. It stays positive (semi-)definite, and
/// becomes definite where a component is rigid.
KOKKOS_INLINE_FUNCTION Mat3<double> capped_compliance(Mat3<double> compliance, double limit) {
  for (int i = 0; i < 3; ++i)
    if (compliance(i, i) < 1.0 / limit) compliance(i, i) = 1.0 / limit;
  return compliance;
}

/// Inverse of a symmetric positive definite matrix, from its cofactors. Its rows and columns may differ in units: every
/// entry is a sum of products of one unit.
KOKKOS_INLINE_FUNCTION Mat3<double> inverse_of_symmetric(const Mat3<double>& m) {
  const double c00 = m(1, 1) * m(2, 2) - m(1, 2) * m(1, 2);
  const double c01 = m(0, 2) * m(1, 2) - m(0, 1) * m(2, 2);
  const double c02 = m(0, 1) * m(1, 2) - m(0, 2) * m(1, 1);
  const double c11 = m(0, 0) * m(2, 2) - m(0, 2) * m(0, 2);
  const double c12 = m(0, 1) * m(0, 2) - m(0, 0) * m(1, 2);
  const double c22 = m(0, 0) * m(1, 1) - m(0, 1) * m(0, 1);
  const double f = 1.0 / (m(0, 0) * c00 + m(0, 1) * c01 + m(0, 2) * c02);
  return {{{f * c00, f * c01, f * c02}, {f * c01, f * c11, f * c12}, {f * c02, f * c12, f * c22}}};
}

}  // namespace mixbeam
