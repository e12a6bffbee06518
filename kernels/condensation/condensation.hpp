/// Condensed tangent of an element: its interior is eliminated, and two vertices with a displacement and a rotation
/// each remain.
///
/// Order of elimination: N at each force point (pointwise, its compliance is diagonal or 3 x 3), M (by Legendre modes:
/// diagonal for a constant section; by values at points for a varying one), then the rotations and slopes of the
/// reduced system (reduced_system.hpp). Forces are eliminated with compliances only, so stiff and rigid sections cost
/// no digits. Increments of the interior follow from those of the vertices, theory (33).
#pragma once

#include "kernels/condensation/moment_elimination.hpp"
#include "kernels/element/line_fields.hpp"

#include <type_traits>

namespace mixbeam {

template <bool General, class Real>
using SectionOf = std::conditional_t<General, GeneralSection<Real>, SectionNumbers<Real>>;

/// Adds a given interior right-hand side in place of the gradient of the state (rows as written by store_residual).
template <int K, class Real>
KOKKOS_FORCEINLINE_FUNCTION void add_given_gradient(const Real* rhs, const ElementKinematics<K, Real>& kinematics,
                                                    const InteriorLayout& layout, ElementGradient<K, Real>& g) {
  for (int q = 0; q < layout.force_points; ++q) g.strain_error[q] = load_vector(rhs + layout.force(q));
  for (int j = 0; j <= K; ++j) g.moment_row[j] = load_vector(rhs + layout.moment(j));
  for (int j = 1; j < K; ++j) {
    g.psi[j] = load_vector(rhs + layout.relative_rotation(j));
    g.slope[j] = transpose_times(kinematics.triad, load_vector(rhs + layout.bubble(j)));
  }
  g.spin = load_vector(rhs + layout.spin());
}

/// Builds the reduced system of an element and keeps the data for the recovery of N and M.
template <int K, bool General, class Real>
struct CondensedElement {
  using Blocks = ReducedBlocks<K>;
  using Section = SectionOf<General, Real>;
  using Stiffness = std::conditional_t<General, Mat3<Real>, Vec3<Real>>;
  ReducedSystem<K, Real> system;
  std::conditional_t<General, GeneralMomentRows<K, Real>, MomentRows<K, Real>> moment_rows;
  ForceRows<K, Real> force_rows_[General ? K : 1];  ///< coupled sections only
  ElementGradient<K, Real> gradient;
  InteriorResponse<K, Real> response;
  VertexSystem<Real> condensed;

  /// On entry `gradient` holds what does not follow from the state: the given right-hand side, or the line fields.
  KOKKOS_FORCEINLINE_FUNCTION void build(const ElementTables<K>& tables, const InteriorLayout& layout,
                                         const ReferenceLayout& reference, const ElementInput<Real>& in,
                                         const ElementKinematics<K, Real>& kinematics, const Section& section,
                                         bool own_gradient) {
    system.clear();
    moment_rows.clear(tables);
    for (int q = 0; q < tables.force_points; ++q) {
      const ForcePoint<K, Real> point(q, in, kinematics, tables, layout, reference, section);
      add_force_point(q, point, tables.force_legendre[q], tangent_force_stiffness(q, tables, section), own_gradient);
      if constexpr (General)
        if (section.is_coupled)
          force_rows_[q] = {point.rotation.exp, point.rotation.tangent, point.p, point.pulled_back};
    }
    for (int q = 0; q <= K; ++q) {
      const MomentPoint<K, Real> point(q, in, kinematics, tables, layout, reference);
      const double *P = tables.moment_legendre[q], *slope = tables.moment_slope[q];
      if (own_gradient) add_moment_gradient(point, P, slope, kinematics.length, gradient);
      add_moment_tangent(q, point, tables, kinematics.length, moment_rows, system);
    }
    if (own_gradient) add_moment_compliance(in, kinematics, tables, layout, section, gradient);
    for (int end = 0; end < 2; ++end) {
      const EndRotation<K, Real> end_rotation(end, in, kinematics, layout, reference);
      if (own_gradient) add_end_gradient(end, end_rotation, gradient);
      add_end_tangent(end, end_rotation, moment_rows, system);
    }
    if constexpr (General)
      condense_moments(moment_rows, gradient, force_rows_,
                       GeneralStiffness<K, Real>(section, tables, kinematics.length), system);
    else
      condense_moments(moment_rows, gradient.moment_row, section, kinematics.length, system);
    add_gradient();
  }

  /// Stores the numbers that recovery needs, ResponseLayout, by store(first, count, numbers).
  template <class Store>
  KOKKOS_FORCEINLINE_FUNCTION void store_response(const Store& store) const {
    for (int b = 0; b < Blocks::kInterior; ++b) store_rows(response.by[b], 3 * b, store);
  }
  /// Writes the part that does not depend on the vertices, in the layout of increments.
  KOKKOS_FORCEINLINE_FUNCTION void constants(const InteriorLayout& layout, Real* out) const {
    for (int q = 0; q < layout.force_points; ++q) store_vector(gradient.strain_error[q], out + layout.force(q));
    for (int m = 0; m <= K; ++m) store_vector(gradient.moment_row[m], out + layout.moment(m));
    for (int j = 1; j < K; ++j) {
      store_vector(response.constant[Blocks::psi(j)], out + layout.relative_rotation(j));
      store_vector(response.constant[Blocks::slope(j)], out + layout.bubble(j));
    }
    store_vector(response.constant[Blocks::spin()], out + layout.spin());
  }

 private:
  /// Eliminates N, theory (26): the corrected force replaces N, or C error alone for a given right-hand side.
  KOKKOS_FORCEINLINE_FUNCTION void add_force_point(int q, const ForcePoint<K, Real>& point, const double* P,
                                                   const Stiffness& stiffness, bool own_gradient) {
    if (own_gradient) gradient.strain_error[q] += point.strain_error;
    Vec3<Real> force = stress(stiffness, gradient.strain_error[q]);
    if (own_gradient) force += point.force;
    add_force_gradient(point, force, P, gradient);
    add_force_tangent(point, stiffness, P, system);
  }
  KOKKOS_FORCEINLINE_FUNCTION void add_gradient() {
    system.rhs[Blocks::spin()] += gradient.spin;
    for (int j = 0; j < K; ++j) system.rhs[Blocks::slope(j)] += gradient.slope[j];
    for (int j = 1; j < K; ++j) system.rhs[Blocks::psi(j)] += gradient.psi[j];
    for (int end = 0; end < 2; ++end) system.rhs[Blocks::vertex(end)] += gradient.vertex_spin[end];
  }
  /// Stores three rows of the response from their blocks by slope_0, spin a and spin b.
  template <class Store>
  KOKKOS_FORCEINLINE_FUNCTION static void store_rows(const Mat3<Real>* by, int first_row, const Store& store) {
    Real numbers[3 * kVertexColumns];
    for (int i = 0; i < 3; ++i)
      for (int c = 0; c < 3; ++c)
        for (int j = 0; j < 3; ++j) numbers[kVertexColumns * i + 3 * c + j] = by[c](i, j);
    store(kVertexColumns * first_row, 3 * kVertexColumns, numbers);
  }
};

/// Increments of the reduced unknowns, in the element frame.
template <int K, class Real>
struct ReducedIncrement {
  using Blocks = ReducedBlocks<K>;
  Vec3<Real> slope_0, vertex_spin[2];
  Vec3<Real> interior[Blocks::kInterior];

  /// Reduces displacements and spins of both vertices (u_a, theta_a and u_b, theta_b; spatial).
  KOKKOS_FORCEINLINE_FUNCTION ReducedIncrement(const ElementKinematics<K, Real>& kinematics, const Real* a,
                                               const Real* b)
      : slope_0(Real(1.0 / kinematics.length) * transpose_times(kinematics.triad, load_vector(b) - load_vector(a))),
        vertex_spin{transpose_times(kinematics.triad, load_vector(a + 3)),
                    transpose_times(kinematics.triad, load_vector(b + 3))} {}
  /// `rows`: ResponseLayout; `constants`: in the layout of increments.
  KOKKOS_FORCEINLINE_FUNCTION void respond(const Real* rows, const InteriorLayout& layout, const Real* constants) {
    interior[Blocks::spin()] = load_vector(constants + layout.spin());
    for (int j = 1; j < K; ++j) {
      interior[Blocks::psi(j)] = load_vector(constants + layout.relative_rotation(j));
      interior[Blocks::slope(j)] = load_vector(constants + layout.bubble(j));
    }
    for (int b = 0; b < Blocks::kInterior; ++b)
      for (int i = 0; i < 3; ++i, rows += kVertexColumns)
        interior[b][i] = interior[b][i] + dot(load_vector(rows), slope_0) + dot(load_vector(rows + 3), vertex_spin[0]) +
                         dot(load_vector(rows + 6), vertex_spin[1]);
  }
  KOKKOS_FORCEINLINE_FUNCTION const Vec3<Real>& spin() const { return interior[Blocks::spin()]; }
  KOKKOS_FORCEINLINE_FUNCTION const Vec3<Real>& psi(int j) const { return interior[Blocks::psi(j)]; }
  KOKKOS_FORCEINLINE_FUNCTION const Vec3<Real>& slope(int j) const {
    return j == 0 ? slope_0 : interior[Blocks::slope(j)];
  }
};

/// R_N + change of gamma at a force point, theory (26).
template <int K, class Real>
KOKKOS_FORCEINLINE_FUNCTION Vec3<Real> force_strain(int q, const ElementInput<Real>& in,
                                                    const ElementKinematics<K, Real>& kinematics,
                                                    const ElementTables<K>& tables, const ReferenceLayout& reference,
                                                    const ReducedIncrement<K, Real>& d, const Real* strain_error) {
  const double* P = tables.force_legendre[q];
  const PointRotation<K, Real> rotation(kinematics.relative_rotation(P));
  const Vec3<Real> p = kinematics.centerline_slope(load_vector(in.reference + reference.tangent(q)), P);
  const Vec3<Real> pulled_back = K > 1 ? transpose_times(rotation.exp, p) : p;
  Vec3<Real> slope = d.slope_0, psi{{Real(0.0), Real(0.0), Real(0.0)}};
  for (int j = 1; j < K; ++j) {
    slope += P[j] * d.slope(j);
    psi += P[j] * d.psi(j);
  }
  return load_vector(strain_error) +
         strain_change<K>(rotation.exp, rotation.tangent, p, pulled_back, slope, d.spin(), psi);
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
    const EndRotation<K, Real> end_rotation(end, in, kinematics, layout, reference);
    Vec3<Real> turn = d.vertex_spin[end] - d.spin();
    if constexpr (K > 1) {
      Vec3<Real> psi{{Real(0.0), Real(0.0), Real(0.0)}};
      for (int j = 1; j < K; ++j) psi += end_value(end, j) * d.psi(j);
      turn = transpose_times(end_rotation.rotation.exp, turn - end_rotation.rotation.tangent * psi);
    }
    const Vec3<Real> change = end_rotation.inverse_tangent * turn;
    for (int j = 0; j <= K; ++j) row[j] += signed_end_value(end, j) * change;
  }
}

/// Turns strains into increments of N and of the modes of M by the section, theory (26) and theory (27): from R_N +
/// change of gamma at the force points and from R_M + D dx.
template <int K, class Real>
KOKKOS_FORCEINLINE_FUNCTION void answer_strains(const SectionNumbers<Real>& section, const ElementTables<K>& tables,
                                                const Real& length, Vec3<Real>* strain, Vec3<Real>* row) {
  const Real* const force_stiffness = section.tangent_force_stiffness;
  for (int q = 0; q < tables.force_points; ++q)
    strain[q] = {{tables.axial[q] * force_stiffness[0] * strain[q][0],
                  tables.shear[q] * force_stiffness[1] * strain[q][1],
                  tables.shear[q] * force_stiffness[2] * strain[q][2]}};
  const Real inverse = 1.0 / length;
  const Vec3<Real> stiffness = inverse * load_vector(section.moment_stiffness);
  for (int j = 0; j <= K; ++j) row[j] = stress(Real(2 * j + 1) * stiffness, row[j]);
}
/// Same for a general section, theory (28).
template <int K, class Real>
KOKKOS_INLINE_FUNCTION void answer_strains(const GeneralSection<Real>& section, const ElementTables<K>& tables,
                                           const Real& length, Vec3<Real>* strain, Vec3<Real>* row) {
  GeneralStiffness<K, Real>(section, tables, length).answer(length, strain, row);
}

/// All increments of an element, InteriorLayout; on entry `out` holds their parts that are independent of the vertices.
template <int K, class Real, class Section>
KOKKOS_FORCEINLINE_FUNCTION void recover_element(const ElementInput<Real>& in,
                                                 const ElementKinematics<K, Real>& kinematics,
                                                 const ElementTables<K>& tables, const InteriorLayout& layout,
                                                 const ReferenceLayout& reference, const Section& section,
                                                 ReducedIncrement<K, Real>& d, const Real* response, Real* out) {
  d.respond(response, layout, out);
  Vec3<Real> strain[ElementTables<K>::kMaximumForcePoints], row[K + 1];
  for (int q = 0; q < tables.force_points; ++q)
    strain[q] = force_strain(q, in, kinematics, tables, reference, d, out + layout.force(q));
  for (int j = 0; j <= K; ++j) row[j] = load_vector(out + layout.moment(j));
  add_moment_row_change(in, kinematics, tables, layout, reference, d, row);
  answer_strains(section, tables, kinematics.length, strain, row);
  for (int q = 0; q < tables.force_points; ++q) store_vector(strain[q], out + layout.force(q));
  for (int j = 0; j <= K; ++j) store_vector(row[j], out + layout.moment(j));
  for (int j = 1; j < K; ++j) {
    store_vector(d.psi(j), out + layout.relative_rotation(j));
    store_vector(kinematics.triad * d.slope(j), out + layout.bubble(j));
  }
  store_vector(d.spin(), out + layout.spin());
}

}  // namespace mixbeam
