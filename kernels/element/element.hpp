/// Mixed element in the frame of its own constant triad Lambda_lo (the "element frame"). The energy does not depend on
/// Lambda_lo there, which makes the discrete strains objective to the last digits. First the state, then the residual
/// of the whole mixed system, theory (16) to theory (20): the first variation of the functional of theory (13),
/// stationary in all fields.
#pragma once

#include "kernels/element/section.hpp"

namespace mixbeam {

/// Input of one element, or of as many elements as Real has lanes.
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
  /// Extracts one lane of several elements.
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

/// Rotation psi at a point, theory (9), with exp(hat psi), T(psi) and the Stumpff values behind them. For k = 1 psi is
/// zero and both maps are the identity.
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

/// Force strain S_NN N + S_NM M at a force point of a general section. The coefficient of degree k of M does not
/// contribute: P_k is zero at the k Gauss points.
template <int K, class Real>
KOKKOS_INLINE_FUNCTION Vec3<Real> coupled_force_strain(const GeneralSection<Real>& section, int q,
                                                       const ElementInput<Real>& in, const ElementTables<K>& tables,
                                                       const InteriorLayout& layout) {
  const Vec3<Real> strain = section.force_force(q) * load_vector(in.interior + layout.force(q));
  if (!section.is_coupled) return strain;
  Vec3<Real> moment{{Real(0.0), Real(0.0), Real(0.0)}};
  for (int j = 0; j < K; ++j) moment += tables.force_legendre[q][j] * load_vector(in.interior + layout.moment(j));
  return strain + section.force_moment(q) * moment;
}

/// Force strain at one point, theory (10), the force there and the residual of its constitutive law, theory (16).
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

/// Relative rotation between element and vertex at one end (discrete curvature), theory (12), and its conjugate moment
/// with the sign of the boundary term: + at the right end, - at the left.
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

/// Gradients in the element frame. Interior N and M rows are strains, the others forces or moments.
template <int K, class Real = double>
struct ElementGradient {
  Vec3<Real>
      strain_error[ElementTables<K>::kMaximumForcePoints];  ///< gamma - C^-1 N at each force point (not weighted)
  Vec3<Real> moment_row[K + 1];  ///< int P_j (kappa - C^-1 M) + discrete curvature: a relative rotation
  Vec3<Real> spin;               ///< conjugate to w
  Vec3<Real> psi[K];             ///< conjugate to psi_j, j >= 1
  Vec3<Real> slope[K];           ///< conjugate to the slopes Lambda_lo^T u'_j
  Vec3<Real> vertex_spin[2];     ///< conjugate to the spins of the end vertices, in the element frame
  Vec3<Real> vertex_force[2];    ///< from line loads, spatial; the rest of the vertex force is +-slope[0]/h
  Real largest_end_angle;        ///< |phi| at the two ends; the element is valid below pi
};

/// Change of gamma at a force point, theory (15).
template <int K, class Real>
KOKKOS_FORCEINLINE_FUNCTION Vec3<Real> strain_change(const Mat3<Real>& exp, const Mat3<Real>& tangent,
                                                     const Vec3<Real>& p, const Vec3<Real>& pulled_back,
                                                     const Vec3<Real>& slope, const Vec3<Real>& spin,
                                                     const Vec3<Real>& psi) {
  const Vec3<Real> moved = slope + cross(p, spin);
  if constexpr (K == 1) return moved;
  return transpose_times(exp, moved) + cross(pulled_back, transpose_times(tangent, psi));
}

/// Adds the work of a material force at one point, theory (18): of N, or of its substitute by theory (26).
template <int K, class Real>
KOKKOS_FORCEINLINE_FUNCTION void add_force_gradient(const ForcePoint<K, Real>& point, const Vec3<Real>& force,
                                                    const double* P, ElementGradient<K, Real>& g) {
  const Vec3<Real> nu = K > 1 ? point.rotation.exp * force : force;
  for (int j = 0; j < K; ++j) g.slope[j] += (point.weight * P[j]) * nu;
  g.spin += point.weight * cross(nu, point.p);
  if constexpr (K > 1) {
    const Vec3<Real> turning = point.weight * (point.rotation.tangent * cross(force, point.pulled_back));
    for (int j = 1; j < K; ++j) g.psi[j] += P[j] * turning;
  }
}

/// Adds the sums over the moment points in theory (17) and theory (18), without compliances.
template <int K, class Real>
KOKKOS_FORCEINLINE_FUNCTION void add_moment_gradient(const MomentPoint<K, Real>& point, const double* P,
                                                     const double* slope, const Real& length,
                                                     ElementGradient<K, Real>& g) {
  for (int j = 0; j <= K; ++j) g.moment_row[j] += (point.weight * P[j]) * point.strain;
  if constexpr (K > 1) {
    const Vec3<Real> along_slope = (point.weight * 2.0 / length) * (point.rotation.tangent * point.moment);
    const Vec3<Real> along_value =
        point.weight * rotation_form_gradient(2, point.moment, point.slope, point.rotation.psi, point.rotation.c);
    for (int j = 1; j < K; ++j) g.psi[j] += slope[j] * along_slope + P[j] * along_value;
  }
}

/// Adds the terms of one end in theory (17) and theory (18).
template <int K, class Real>
KOKKOS_FORCEINLINE_FUNCTION void add_end_gradient(int end, const EndRotation<K, Real>& end_rotation,
                                                  ElementGradient<K, Real>& g) {
  const Vec3<Real> spun = K > 1 ? end_rotation.rotation.exp * end_rotation.spin_moment : end_rotation.spin_moment;
  g.vertex_spin[end] = spun;
  g.spin += -spun;
  if constexpr (K > 1) {
    const Vec3<Real> turning = end_rotation.rotation.tangent * end_rotation.spin_moment;
    for (int j = 1; j < K; ++j) g.psi[j] += (-end_value(end, j)) * turning;
  }
  for (int j = 0; j <= K; ++j) g.moment_row[j] += (end_rotation.sign * end_value(end, j)) * end_rotation.phi;
}

template <int K, class Real>
KOKKOS_FORCEINLINE_FUNCTION void clear(ElementGradient<K, Real>& g) {
  const Vec3<Real> zero{{Real(0.0), Real(0.0), Real(0.0)}};
  for (Vec3<Real>& error : g.strain_error) error = zero;
  for (int j = 0; j <= K; ++j) g.moment_row[j] = zero;
  for (int j = 0; j < K; ++j) g.psi[j] = g.slope[j] = zero;
  g.spin = zero;
  for (int end = 0; end < 2; ++end) g.vertex_spin[end] = g.vertex_force[end] = zero;
  g.largest_end_angle = 0.0;
}

/// Subtracts the compliances times M in theory (17), constant section.
template <int K, class Real>
KOKKOS_FORCEINLINE_FUNCTION void add_moment_compliance(const ElementInput<Real>& in,
                                                       const ElementKinematics<K, Real>& kinematics,
                                                       const ElementTables<K>&, const InteriorLayout& layout,
                                                       const SectionNumbers<Real>& section,
                                                       ElementGradient<K, Real>& g) {
  for (int j = 0; j <= K; ++j)
    for (int i = 0; i < 3; ++i)
      g.moment_row[j][i] -=
          kinematics.length / (2 * j + 1) * section.moment_compliance[i] * in.interior[layout.moment(j) + i];
}

/// Same for a general section: w P_j S_MM M summed over the moment points, w P_j S_MN N over the force points.
template <int K, class Real>
KOKKOS_INLINE_FUNCTION void add_moment_compliance(const ElementInput<Real>& in,
                                                  const ElementKinematics<K, Real>& kinematics,
                                                  const ElementTables<K>& tables, const InteriorLayout& layout,
                                                  const GeneralSection<Real>& section, ElementGradient<K, Real>& g) {
  const Real half = 0.5 * kinematics.length;
  for (int q = 0; q <= K; ++q) {
    Vec3<Real> moment{{Real(0.0), Real(0.0), Real(0.0)}};
    for (int j = 0; j <= K; ++j) moment += tables.moment_legendre[q][j] * load_vector(in.interior + layout.moment(j));
    const Vec3<Real> strain = (half * tables.moment_weight[q]) * (section.moment_moment(q) * moment);
    for (int j = 0; j <= K; ++j) g.moment_row[j] += (-tables.moment_legendre[q][j]) * strain;
  }
  for (int q = 0; section.is_coupled && q < tables.force_points; ++q) {
    const Vec3<Real> force = load_vector(in.interior + layout.force(q));
    const Vec3<Real> strain = (half * tables.force_weight[q]) * transpose_times(section.force_moment(q), force);
    for (int j = 0; j < K; ++j) g.moment_row[j] += (-tables.force_legendre[q][j]) * strain;
  }
}

/// Gradient of the element energy, without line fields (element/line_fields.hpp).
template <int K, class Real, class AnySection>
KOKKOS_FORCEINLINE_FUNCTION void element_gradient(const ElementInput<Real>& in,
                                                  const ElementKinematics<K, Real>& kinematics,
                                                  const ElementTables<K>& tables, const InteriorLayout& layout,
                                                  const ReferenceLayout& reference, const AnySection& section,
                                                  ElementGradient<K, Real>& g) {
  clear(g);
  for (int q = 0; q < tables.force_points; ++q) {
    const ForcePoint<K, Real> point(q, in, kinematics, tables, layout, reference, section);
    g.strain_error[q] = point.strain_error;
    add_force_gradient(point, point.force, tables.force_legendre[q], g);
  }
  for (int q = 0; q <= K; ++q) {
    const MomentPoint<K, Real> point(q, in, kinematics, tables, layout, reference);
    add_moment_gradient(point, tables.moment_legendre[q], tables.moment_slope[q], kinematics.length, g);
  }
  add_moment_compliance(in, kinematics, tables, layout, section, g);
  for (int end = 0; end < 2; ++end) {
    const EndRotation<K, Real> end_rotation(end, in, kinematics, layout, reference);
    add_end_gradient(end, end_rotation, g);
    const Real angle = norm(end_rotation.phi);
    g.largest_end_angle = select(angle > g.largest_end_angle, angle, g.largest_end_angle);
  }
}

/// Writes the spatial rows of both vertices from those of slope_0 and of the vertex spins in the element frame.
template <int K, class Real>
KOKKOS_FORCEINLINE_FUNCTION void store_vertex_rows(const Vec3<Real>& slope, const Vec3<Real>& spin_a,
                                                   const Vec3<Real>& spin_b, const ElementGradient<K, Real>& gradient,
                                                   const ElementKinematics<K, Real>& kinematics, Real* row) {
  const Vec3<Real> force = Real(1.0 / kinematics.length) * (kinematics.triad * slope);
  store_vector(gradient.vertex_force[0] - force, row);
  store_vector(kinematics.triad * spin_a, row + 3);
  store_vector(gradient.vertex_force[1] + force, row + 6);
  store_vector(kinematics.triad * spin_b, row + 9);
}

/// Writes the interior rows (InteriorLayout with spin) and the 12 vertex rows (u_a, theta_a, u_b, theta_b): theory
/// (20). All are spatial except the N, M, psi and spin rows, which are material.
template <int K, class Real>
KOKKOS_FORCEINLINE_FUNCTION void store_residual(const ElementGradient<K, Real>& g,
                                                const ElementKinematics<K, Real>& kinematics,
                                                const InteriorLayout& layout, Real* interior_row, Real* vertex_row) {
  for (int q = 0; q < layout.force_points; ++q) store_vector(g.strain_error[q], interior_row + layout.force(q));
  for (int j = 0; j <= K; ++j) store_vector(g.moment_row[j], interior_row + layout.moment(j));
  for (int j = 1; j < K; ++j) {
    store_vector(g.psi[j], interior_row + layout.relative_rotation(j));
    store_vector(kinematics.triad * g.slope[j], interior_row + layout.bubble(j));
  }
  store_vector(g.spin, interior_row + layout.spin());
  store_vertex_rows(g.slope[0], g.vertex_spin[0], g.vertex_spin[1], g, kinematics, vertex_row);
}

}  // namespace mixbeam
