/// Increments of the interior unknowns of an element from those of its vertices: theory (33).
#pragma once

#include "kernels/condensation/tangent.hpp"

namespace mixbeam {

/// Increments of the reduced unknowns, in the element frame.
template <int K, class Real>
struct ReducedIncrement {
  using Blocks = ReducedBlocks<K>;
  Vec3<Real> slope_0, vertex_spin[2];
  Vec3<Real> interior[Blocks::kInterior];

  /// From displacements and spins of both vertices (u_a, theta_a and u_b, theta_b; spatial).
  KOKKOS_FORCEINLINE_FUNCTION ReducedIncrement(const ElementKinematics<K, Real>& kinematics, const Real* a,
                                               const Real* b)
      : slope_0(Real(1.0 / kinematics.length) * transpose_times(kinematics.triad, load_vector(b) - load_vector(a))),
        vertex_spin{transpose_times(kinematics.triad, load_vector(a + 3)),
                    transpose_times(kinematics.triad, load_vector(b + 3))} {}
  /// One row of a response: kResponseColumns numbers.
  KOKKOS_FORCEINLINE_FUNCTION Real respond_in_row(const Real* row) const {
    return row[9] + dot(load_vector(row), slope_0) + dot(load_vector(row + 3), vertex_spin[0]) +
           dot(load_vector(row + 6), vertex_spin[1]);
  }
  /// `rows`: ResponseLayout.
  KOKKOS_FORCEINLINE_FUNCTION void respond(const Real* rows) {
    for (int b = 0; b < Blocks::kInterior; ++b)
      for (int i = 0; i < 3; ++i, rows += kResponseColumns) interior[b][i] = respond_in_row(rows);
  }
  KOKKOS_FORCEINLINE_FUNCTION const Vec3<Real>& spin() const { return interior[Blocks::spin()]; }
  KOKKOS_FORCEINLINE_FUNCTION const Vec3<Real>& psi(int j) const { return interior[Blocks::psi(j)]; }
  KOKKOS_FORCEINLINE_FUNCTION const Vec3<Real>& slope(int j) const {
    return j == 0 ? slope_0 : interior[Blocks::slope(j)];
  }
};

/// dN at each force point, theory (26).
template <int K, class Real>
KOKKOS_FORCEINLINE_FUNCTION void recover_forces(const ElementInput<Real>& in,
                                                const ElementKinematics<K, Real>& kinematics,
                                                const ElementTables<K>& tables, const ReferenceLayout& reference,
                                                const ReducedIncrement<K, Real>& d, const ResponseLayout& kept,
                                                const Real* response, const InteriorLayout& layout, Real* out) {
  const Real* stiffness = response + kept.force_stiffness();
  for (int q = 0; q < tables.force_points; ++q) {
    const double* P = tables.force_legendre[q];
    const PointRotation<K, Real> rotation(kinematics.relative_rotation(P));
    const Vec3<Real> p = kinematics.centerline_slope(load_vector(in.reference + reference.tangent(q)), P);
    const Vec3<Real> pulled_back = K > 1 ? transpose_times(rotation.exp, p) : p;
    Vec3<Real> slope = d.slope_0, psi{{Real(0.0), Real(0.0), Real(0.0)}};
    for (int j = 1; j < K; ++j) {
      slope += P[j] * d.slope(j);
      psi += P[j] * d.psi(j);
    }
    const Vec3<Real> strain = load_vector(response + kept.strain_error(q)) +
                              strain_change<K>(rotation.exp, rotation.tangent, p, pulled_back, slope, d.spin(), psi);
    Real* force = out + layout.force(q);
    force[0] = tables.axial[q] * stiffness[0] * strain[0];
    force[1] = tables.shear[q] * stiffness[1] * strain[1];
    force[2] = tables.shear[q] * stiffness[2] * strain[2];
  }
}

/// Change D dx of the moment rows in theory (27): of kappa at the moment points, and of phi at both ends, theory (15).
template <int K, class Real>
KOKKOS_FORCEINLINE_FUNCTION void add_moment_row_change(const ElementInput<Real>& in,
                                                       const ElementKinematics<K, Real>& kinematics,
                                                       const ElementTables<K>& tables, const InteriorLayout& layout,
                                                       const ReferenceLayout& reference,
                                                       const ReducedIncrement<K, Real>& d, Vec3<Real>* row) {
  if constexpr (K > 1)
    for (int q = 0; q <= K; ++q) {
      const MomentPoint<K, Real> point(q, in, kinematics, tables, layout, reference);
      const double *P = tables.moment_legendre[q], *slopes = tables.moment_slope[q];
      Vec3<Real> psi{{Real(0.0), Real(0.0), Real(0.0)}}, slope = psi;
      for (int j = 1; j < K; ++j) {
        psi += P[j] * d.psi(j);
        slope += slopes[j] * d.psi(j);
      }
      const Mat3<Real> by_psi = tangent_map_derivative(-point.rotation.psi, point.slope, point.rotation.c);
      const Vec3<Real> change =
          point.weight *
          (transpose_times(point.rotation.tangent, Real(2.0 / kinematics.length) * slope) - by_psi * psi);
      for (int j = 0; j <= K; ++j) row[j] += P[j] * change;
    }
  for (int end = 0; end < 2; ++end) {
    const EndRotation<K, Real> joint(end, in, kinematics, layout, reference);
    Vec3<Real> turn = d.vertex_spin[end] - d.spin();
    if constexpr (K > 1) {
      Vec3<Real> psi{{Real(0.0), Real(0.0), Real(0.0)}};
      for (int j = 1; j < K; ++j) psi += end_value(end, j) * d.psi(j);
      turn = transpose_times(joint.rotation.exp, turn - joint.rotation.tangent * psi);
    }
    const Vec3<Real> change = joint.inverse_tangent * turn;
    for (int j = 0; j <= K; ++j) row[j] += signed_end_value(end, j) * change;
  }
}

/// All increments of an element with a plain section, InteriorLayout.
template <int K, class Real>
KOKKOS_FORCEINLINE_FUNCTION void recover_element(const ElementInput<Real>& in,
                                                 const ElementKinematics<K, Real>& kinematics,
                                                 const ElementTables<K>& tables, const InteriorLayout& layout,
                                                 const ReferenceLayout& reference, ReducedIncrement<K, Real>& d,
                                                 const Real* response, Real* out) {
  const ResponseLayout kept{K, layout.force_points};
  d.respond(response);
  recover_forces(in, kinematics, tables, reference, d, kept, response, layout, out);
  Vec3<Real> row[K + 1];
  for (int j = 0; j <= K; ++j) row[j] = load_vector(response + kept.moment_row(j));
  add_moment_row_change(in, kinematics, tables, layout, reference, d, row);
  const Real inverse = 1.0 / kinematics.length;
  const Vec3<Real> stiffness = inverse * load_vector(response + kept.moment_stiffness());
  for (int j = 0; j <= K; ++j) store_vector(stress(Real(2 * j + 1) * stiffness, row[j]), out + layout.moment(j));
  for (int j = 1; j < K; ++j) {
    store_vector(d.psi(j), out + layout.relative_rotation(j));
    store_vector(kinematics.triad * d.slope(j), out + layout.bubble(j));
  }
  store_vector(d.spin(), out + layout.spin());
}

}  // namespace mixbeam
