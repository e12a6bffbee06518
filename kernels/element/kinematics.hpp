/// State of one element seen in the frame of its own constant triad Lambda_lo (the "element frame"): there the energy
/// does not depend on Lambda_lo at all, which makes the discrete strains objective to the last digits.
#pragma once

#include "kernels/element/section.hpp"
#include "kernels/math/rotation.hpp"

namespace mixbeam {

using Vec = Vec3<double>;
using Mat = Mat3<double>;
using Quat = Quaternion<double>;

template <class Real>
KOKKOS_FORCEINLINE_FUNCTION Vec3<Real> load_vector(const Real* x) {
  return {{x[0], x[1], x[2]}};
}
template <class Real>
KOKKOS_FORCEINLINE_FUNCTION void store_vector(const Vec3<Real>& v, Real* x) {
  x[0] = v[0];
  x[1] = v[1];
  x[2] = v[2];
}
template <class Real>
KOKKOS_FORCEINLINE_FUNCTION Quaternion<Real> load_quaternion(const Real* x) {
  return {x[0], x[1], x[2], x[3]};
}
template <class Real>
KOKKOS_FORCEINLINE_FUNCTION void store_quaternion(const Quaternion<Real>& q, Real* x) {
  x[0] = q.w;
  x[1] = q.x;
  x[2] = q.y;
  x[3] = q.z;
}

/// Everything that one element reads, or as many elements as Real has lanes.
template <class Real = double>
struct ElementInput {
  Vec3<Real> displacement[2];           ///< of the end vertices, spatial
  Quaternion<Real> vertex_rotation[2];  ///< Lambda_V of the end vertices
  Quaternion<Real> triad;               ///< Lambda_lo
  const Real* interior;                 ///< InteriorLayout
  const Real* reference;                ///< ReferenceLayout
};

/// Constant-size pieces of the state in the element frame, theory (8).
template <int K, class Real = double>
struct ElementKinematics {
  Real length;
  Mat3<Real> triad;     ///< Lambda_lo
  Vec3<Real> slope[K];  ///< Lambda_lo^T u' = sum_j slope_j P_j
  Vec3<Real> psi[K];    ///< psi_ho = sum_{j >= 1} psi_j P_j (psi_0 unused)

  ElementKinematics() = default;
  KOKKOS_FORCEINLINE_FUNCTION ElementKinematics(const ElementInput<Real>& in, const InteriorLayout& layout)
      : length(in.reference[0]), triad(rotation_matrix(in.triad)) {
    slope[0] = Real(1.0 / length) * transpose_times(triad, in.displacement[1] - in.displacement[0]);
    psi[0] = Vec3<Real>{{Real(0.0), Real(0.0), Real(0.0)}};
    for (int j = 1; j < K; ++j) {
      slope[j] = transpose_times(triad, load_vector(in.interior + layout.bubble(j)));
      psi[j] = load_vector(in.interior + layout.relative_rotation(j));
    }
  }

  /// p = Lambda_lo^T r' at a point with Legendre values P: theory (10).
  KOKKOS_FORCEINLINE_FUNCTION Vec3<Real> centerline_slope(const Vec3<Real>& reference_tangent, const double* P) const {
    Vec3<Real> p = transpose_times(triad, reference_tangent);
    for (int j = 0; j < K; ++j) p += P[j] * slope[j];
    return p;
  }
  /// One lane of several elements.
  KOKKOS_INLINE_FUNCTION ElementKinematics<K> in_lane(int lane) const {
    ElementKinematics<K> one;
    one.length = length[lane];
    one.triad = mixbeam::in_lane(triad, lane);
    for (int j = 0; j < K; ++j) {
      one.slope[j] = mixbeam::in_lane(slope[j], lane);
      one.psi[j] = mixbeam::in_lane(psi[j], lane);
    }
    return one;
  }
  KOKKOS_FORCEINLINE_FUNCTION Vec3<Real> relative_rotation(const double* P) const {
    Vec3<Real> sum{{Real(0.0), Real(0.0), Real(0.0)}};
    for (int j = 1; j < K; ++j) sum += P[j] * psi[j];
    return sum;
  }
};

/// Rotation psi at a point, theory (9), with exp(hat psi), T(psi) and the Stumpff values they come from. For k = 1 psi
/// is zero and both maps are the identity.
template <int K, class Real = double>
struct PointRotation {
  Vec3<Real> psi;
  StumpffValues<Real> c;
  Mat3<Real> exp, tangent;

  KOKKOS_FORCEINLINE_FUNCTION explicit PointRotation(const Vec3<Real>& rotation_vector) : psi(rotation_vector) {
    if constexpr (K > 1) {
      c = stumpff(dot(psi, psi));
      exp = exp_matrix(psi, c);
      tangent = tangent_map(psi, c);
    } else {
      exp = tangent = identity_matrix<Real>();
    }
  }
};

/// Force strain that the resultants of the element make in a general section: S_NN N + S_NM M at a force point. The
/// degree k of M has no part in it: P_k is zero at the k Gauss points.
template <int K, class Real>
KOKKOS_INLINE_FUNCTION Vec3<Real> coupled_force_strain(const GeneralSection<Real>& section, int q,
                                                       const ElementInput<Real>& in, const ElementTables<K>& tables,
                                                       const InteriorLayout& layout) {
  Vec3<Real> moment{{Real(0.0), Real(0.0), Real(0.0)}};
  for (int j = 0; j < K; ++j) moment += tables.force_legendre[q][j] * load_vector(in.interior + layout.moment(j));
  return section.force_force(q) * load_vector(in.interior + layout.force(q)) + section.force_moment(q) * moment;
}

/// Force strain at one point, theory (10), the resultant there and the residual of its law, theory (16).
template <int K, class Real = double>
struct ForcePoint {
  PointRotation<K, Real> rotation;
  Vec3<Real> p;             ///< Lambda_lo^T r'
  Vec3<Real> pulled_back;   ///< Lambda^T r' = gamma + e1
  Vec3<Real> force;         ///< N, material
  Vec3<Real> strain_error;  ///< gamma - C^-1 N, masked: the residual of the constitutive equation (general: all of S)
  Real weight;              ///< quadrature weight times h/2

  template <class AnySection>
  KOKKOS_FORCEINLINE_FUNCTION ForcePoint(int q, const ElementInput<Real>& in,
                                         const ElementKinematics<K, Real>& kinematics, const ElementTables<K>& tables,
                                         const InteriorLayout& layout, const ReferenceLayout& reference,
                                         const AnySection& section)
      : rotation(kinematics.relative_rotation(tables.force_legendre[q])) {
    p = kinematics.centerline_slope(load_vector(in.reference + reference.tangent(q)), tables.force_legendre[q]);
    pulled_back = K > 1 ? transpose_times(rotation.exp, p) : p;
    force = load_vector(in.interior + layout.force(q));
    if constexpr (kIsGeneral<AnySection>) {
      strain_error = pulled_back - Vec3<Real>{{Real(1.0), Real(0.0), Real(0.0)}} -
                     coupled_force_strain(section, q, in, tables, layout);
    } else {
      const double mask[3] = {tables.axial[q], tables.shear[q], tables.shear[q]};
      for (int i = 0; i < 3; ++i)
        strain_error[i] = mask[i] * (pulled_back[i] - (i == 0 ? 1.0 : 0.0) - section.force_compliance[i] * force[i]);
    }
    weight = 0.5 * kinematics.length * tables.force_weight[q];
  }
};

/// Moment strain at one point, theory (11), and the moment there.
template <int K, class Real = double>
struct MomentPoint {
  PointRotation<K, Real> rotation;
  Vec3<Real> slope;   ///< psi'
  Vec3<Real> moment;  ///< M, material
  Vec3<Real> strain;  ///< kappa
  Real weight;

  KOKKOS_FORCEINLINE_FUNCTION MomentPoint(int q, const ElementInput<Real>& in,
                                          const ElementKinematics<K, Real>& kinematics, const ElementTables<K>& tables,
                                          const InteriorLayout& layout, const ReferenceLayout& reference)
      : rotation(kinematics.relative_rotation(tables.moment_legendre[q])) {
    slope = Vec3<Real>{{Real(0.0), Real(0.0), Real(0.0)}};
    for (int j = 1; j < K; ++j) slope += tables.moment_slope[q][j] * kinematics.psi[j];
    if constexpr (K > 1) slope = Real(2.0 / kinematics.length) * slope;
    moment = Vec3<Real>{{Real(0.0), Real(0.0), Real(0.0)}};
    for (int j = 0; j <= K; ++j) moment += tables.moment_legendre[q][j] * load_vector(in.interior + layout.moment(j));
    strain = -load_vector(in.reference + reference.curvature(q));
    if constexpr (K > 1) strain += transpose_times(rotation.tangent, slope);
    weight = 0.5 * kinematics.length * tables.moment_weight[q];
  }
};

/// P_j at an end of the element: (+-1)^j.
KOKKOS_INLINE_FUNCTION double end_value(int end, int j) { return end == 0 && j % 2 == 1 ? -1.0 : 1.0; }

/// Relative rotation between element and vertex at one end (discrete curvature), theory (12), and the moment that works
/// on it, with the sign of the boundary term: + at the right end, - at the left.
template <int K, class Real = double>
struct EndRotation {
  PointRotation<K, Real> rotation;
  double sign;
  Vec3<Real> phi;
  InverseTangentCoefficient<Real> coefficient;
  Mat3<Real> inverse_tangent;  ///< T^-1(phi)
  Vec3<Real> moment;           ///< sign * M(end), material
  Vec3<Real> spin_moment;      ///< s_e of theory (18): conjugate to a spin that multiplies from the left

  KOKKOS_FORCEINLINE_FUNCTION EndRotation(int end, const ElementInput<Real>& in,
                                          const ElementKinematics<K, Real>& kinematics, const InteriorLayout& layout,
                                          const ReferenceLayout& reference)
      : rotation(end_relative_rotation(end, kinematics)), sign(end == 0 ? -1.0 : 1.0) {
    Quaternion<Real> relative =
        conjugate(in.triad) * in.vertex_rotation[end] * load_quaternion(in.reference + reference.end_triad(end));
    if constexpr (K > 1) relative = conjugate(exp_quaternion(rotation.psi)) * relative;
    phi = log_quaternion(relative);
    moment = Vec3<Real>{{Real(0.0), Real(0.0), Real(0.0)}};
    for (int j = 0; j <= K; ++j) moment += (sign * end_value(end, j)) * load_vector(in.interior + layout.moment(j));
    coefficient = inverse_tangent_coefficient(dot(phi, phi));
    inverse_tangent = inverse_tangent_map(phi, coefficient);
    spin_moment = transpose_times(inverse_tangent, moment);
  }

 private:
  KOKKOS_FORCEINLINE_FUNCTION static Vec3<Real> end_relative_rotation(int end,
                                                                      const ElementKinematics<K, Real>& kinematics) {
    Vec3<Real> sum{{Real(0.0), Real(0.0), Real(0.0)}};
    for (int j = 1; j < K; ++j) sum += end_value(end, j) * kinematics.psi[j];
    return sum;
  }
};

}  // namespace mixbeam
