/// Condensed tangent of one element: second variation of the functional, theory (21) to theory (24), eliminated in the
/// cheap order N (pointwise), M (diagonal, unless the section is general), rotations and bubbles: theory (26) to theory
/// (30).
#pragma once

#include "kernels/condensation/reduced_system.hpp"
#include "kernels/element/element.hpp"

namespace mixbeam {

/// Rows of gamma at a force point, theory (15), for a section that couples N and M.
template <int K, class Real>
struct ForceRows {
  Mat3<Real> exp, tangent;
  Vec3<Real> p, pulled_back;

  /// Expands the rows over the blocks of the reduced system.
  KOKKOS_INLINE_FUNCTION void expand(const double* P, Mat3<Real>* row) const {
    using Blocks = ReducedBlocks<K>;
    const Mat3<Real> by_slope = transpose(exp);
    const Mat3<Real> by_psi = hat(pulled_back) * transpose(tangent);
    row[Blocks::spin()] = times_hat(by_slope, p);
    row[Blocks::vertex(0)] = row[Blocks::vertex(1)] = zero_matrix<Real>();
    for (int i = 0; i < K; ++i) row[Blocks::slope(i)] = P[i] * by_slope;
    for (int i = 1; i < K; ++i) row[Blocks::psi(i)] = P[i] * by_psi;
  }
};

/// Sign of the boundary term at an end times P_j there.
KOKKOS_INLINE_FUNCTION double signed_end_value(int end, int j) { return (end == 0 ? -1.0 : 1.0) * end_value(end, j); }

/// Derivatives D_j of the moment rows, theory (23) and theory (24), by psi_i and the vertex spins. A spin w of the
/// element acts as the opposite spin of both vertices.
template <int K, class Real = double>
struct MomentRows {
  Mat3<Real> psi[K + 1][K];  ///< psi_i, i >= 1
  Mat3<Real> end[2];         ///< row j: sign * (+-1)^j times this
  KOKKOS_FORCEINLINE_FUNCTION void clear(const ElementTables<K>&) {
    for (int j = 0; j <= K; ++j)
      for (int i = 1; i < K; ++i) psi[j][i] = zero_matrix<Real>();
  }
  /// Adds the contribution of moment point q; add_psi_at_end: of an end, where psi_i has the given value.
  KOKKOS_FORCEINLINE_FUNCTION void add_psi(int q, const ElementTables<K>& tables, int i, const Mat3<Real>& m) {
    for (int j = 0; j <= K; ++j) psi[j][i] += Real(tables.moment_legendre[q][j]) * m;
  }
  KOKKOS_FORCEINLINE_FUNCTION void add_psi_at_end(int which, int i, double value, const Mat3<Real>& m) {
    for (int j = 0; j <= K; ++j) psi[j][i] += Real(-signed_end_value(which, j) * value) * m;
  }
  KOKKOS_FORCEINLINE_FUNCTION void add_end(int which, const Mat3<Real>& m) { end[which] = m; }
};

/// diag(d) m
template <class Real>
KOKKOS_FORCEINLINE_FUNCTION Mat3<Real> scaled_rows(const Vec3<Real>& d, const Mat3<Real>& m) {
  return {{{d[0] * m(0, 0), d[0] * m(0, 1), d[0] * m(0, 2)},
           {d[1] * m(1, 0), d[1] * m(1, 1), d[1] * m(1, 2)},
           {d[2] * m(2, 0), d[2] * m(2, 1), d[2] * m(2, 2)}}};
}
/// m C for a diagonal and for a symmetric C
template <class Real>
KOKKOS_FORCEINLINE_FUNCTION Mat3<Real> times_stiffness(const Mat3<Real>& m, const Vec3<Real>& c) {
  return {{{m(0, 0) * c[0], m(0, 1) * c[1], m(0, 2) * c[2]},
           {m(1, 0) * c[0], m(1, 1) * c[1], m(1, 2) * c[2]},
           {m(2, 0) * c[0], m(2, 1) * c[1], m(2, 2) * c[2]}}};
}
template <class Real>
KOKKOS_FORCEINLINE_FUNCTION Mat3<Real> times_stiffness(const Mat3<Real>& m, const Mat3<Real>& c) {
  return m * c;
}
/// hat(a) C
template <class Real>
KOKKOS_FORCEINLINE_FUNCTION Mat3<Real> hat_times_stiffness(const Vec3<Real>& a, const Vec3<Real>& c) {
  return {{{Real(0.0), -a[2] * c[1], a[1] * c[2]},
           {a[2] * c[0], Real(0.0), -a[0] * c[2]},
           {-a[1] * c[0], a[0] * c[1], Real(0.0)}}};
}
template <class Real>
KOKKOS_FORCEINLINE_FUNCTION Mat3<Real> hat_times_stiffness(const Vec3<Real>& a, const Mat3<Real>& c) {
  return hat(a) * c;
}
template <class Real>
KOKKOS_FORCEINLINE_FUNCTION Mat3<Real> stiffness_matrix(const Vec3<Real>& c) {
  return {{{c[0], Real(0.0), Real(0.0)}, {Real(0.0), c[1], Real(0.0)}, {Real(0.0), Real(0.0), c[2]}}};
}
template <class Real>
KOKKOS_FORCEINLINE_FUNCTION Mat3<Real> stiffness_matrix(const Mat3<Real>& c) {
  return c;
}
template <class Real>
KOKKOS_FORCEINLINE_FUNCTION Vec3<Real> stress(const Vec3<Real>& c, const Vec3<Real>& e) {
  return {{c[0] * e[0], c[1] * e[1], c[2] * e[2]}};
}
template <class Real>
KOKKOS_FORCEINLINE_FUNCTION Vec3<Real> stress(const Mat3<Real>& c, const Vec3<Real>& e) {
  return c * e;
}

template <int K, class Real>
KOKKOS_FORCEINLINE_FUNCTION Vec3<Real> tangent_force_stiffness(int q, const ElementTables<K>& tables,
                                                               const SectionNumbers<Real>& section) {
  const Real* stiffness = section.tangent_force_stiffness;
  return {{tables.axial[q] * stiffness[0], tables.shear[q] * stiffness[1], tables.shear[q] * stiffness[2]}};
}
/// Zero for coupled sections, whose material part is added by the elimination of moments.
template <int K, class Real>
KOKKOS_INLINE_FUNCTION Mat3<Real> tangent_force_stiffness(int q, const ElementTables<K>&,
                                                          const GeneralSection<Real>& section) {
  if (section.is_coupled) return zero_matrix<Real>();
  return inverse_of_symmetric(capped_compliance(section.force_force(q), section.force_stiffness_limit));
}

/// Adds material and geometric part (with the stored N) of a force point, expanded into Legendre modes: theory (22).
template <int K, class Real, class Stiffness>
KOKKOS_FORCEINLINE_FUNCTION void add_force_tangent(const ForcePoint<K, Real>& point, const Stiffness& stiffness,
                                                   const double* P, ReducedSystem<K, Real>& system) {
  using Blocks = ReducedBlocks<K>;
  const Mat3<Real>&exp = point.rotation.exp, &tangent = point.rotation.tangent;
  const Vec3<Real> nu = K > 1 ? exp * point.force : point.force;
  Mat3<Real> slope_slope, stiffness_spin;
  if constexpr (K > 1) {
    slope_slope = symmetric_times_transpose(times_stiffness(exp, stiffness), exp);
    stiffness_spin = times_hat(slope_slope, point.p);
  } else {
    slope_slope = stiffness_matrix(stiffness);
    stiffness_spin = -1.0 * transpose(hat_times_stiffness(point.p, stiffness));  // C hat(p)
  }
  const Mat3<Real> slope_spin = stiffness_spin - hat(nu);
  Mat3<Real> spin_spin = hat_transpose_times(point.p, stiffness_spin) + symmetric_part(outer(nu, point.p));
  const Real along = dot(nu, point.p);
  for (int i = 0; i < 3; ++i) spin_spin(i, i) -= along;
  const Real w = point.weight;
  system.add(Blocks::spin(), Blocks::spin(), w, spin_spin);
  for (int i = 0; i < K; ++i) {
    const Real wi = w * P[i];
    system.add(Blocks::slope(i), Blocks::spin(), wi, slope_spin);
    for (int j = 0; j < K; ++j)
      if (Blocks::slope(i) >= Blocks::slope(j)) system.add(Blocks::slope(i), Blocks::slope(j), wi * P[j], slope_slope);
  }
  if constexpr (K > 1) {
    const Vec3<Real>& pulled_back = point.pulled_back;
    const Mat3<Real> by_strain = hat_times_stiffness(pulled_back, stiffness);
    const Mat3<Real> psi_slope = tangent * (hat(point.force) - by_strain) * transpose(exp);
    const Mat3<Real> psi_spin = times_hat(psi_slope, point.p);
    const Mat3<Real> psi_psi =
        symmetric_times_transpose(tangent * (-1.0 * times_hat(by_strain, pulled_back)), tangent) +
        rotation_form_hessian(1, point.force, point.p, point.rotation.psi, point.rotation.c);
    const Mat3<Real> slope_psi = transpose(psi_slope);
    for (int i = 1; i < K; ++i) {
      const Real wi = w * P[i];
      system.add(Blocks::psi(i), Blocks::spin(), wi, psi_spin);
      for (int j = 1; j <= i; ++j) system.add(Blocks::psi(i), Blocks::psi(j), wi * P[j], psi_psi);
      for (int j = 0; j < K; ++j) system.add(Blocks::slope(j), Blocks::psi(i), wi * P[j], slope_psi);
    }
  }
}

/// Adds the part of one moment point, theory (23). `rows`: MomentRows or GeneralMomentRows.
template <int K, class Real, class Rows>
KOKKOS_FORCEINLINE_FUNCTION void add_moment_tangent(int q, const MomentPoint<K, Real>& point,
                                                    const ElementTables<K>& tables, const Real& length, Rows& rows,
                                                    ReducedSystem<K, Real>& system) {
  if constexpr (K > 1) {
    const double *P = tables.moment_legendre[q], *slope = tables.moment_slope[q];
    const Vec3<Real>& psi = point.rotation.psi;
    const Mat3<Real> strain_slope = transpose(point.rotation.tangent);
    const Mat3<Real> strain_psi = -1.0 * tangent_map_derivative(-psi, point.slope, point.rotation.c);
    const Mat3<Real> slope_psi = tangent_map_derivative(psi, point.moment, point.rotation.c);
    const Mat3<Real> psi_slope = transpose(slope_psi);
    const Mat3<Real> psi_psi = rotation_form_hessian(2, point.moment, point.slope, psi, point.rotation.c);
    const Real w = point.weight, along = w * (2.0 / length);
    for (int i = 1; i < K; ++i) {
      const Real slope_i = along * slope[i], value_i = w * P[i], along_i = along * P[i];
      const Mat3<Real> strain_i = slope_i * strain_slope + value_i * strain_psi;
      rows.add_psi(q, tables, i, strain_i);
      for (int j = 1; j <= i; ++j)
        system.add(
            i, j,
            Real(value_i * P[j]) * psi_psi + Real(slope_i * P[j]) * slope_psi + Real(along_i * slope[j]) * psi_slope);
    }
  }
}

/// Adds the boundary term at one end, theory (24). The perturbed relative rotation is exp(-tau) exp(-w~) exp(v~) B with
/// tau = T^T dpsi and tildes pulled back by exp(psi)^T; its second-order expansion gives the antisymmetric parts beside
/// the Hessian of the log. The psi blocks follow from those of the spins by T exp^T = T^T.
template <int K, class Real, class Rows>
KOKKOS_FORCEINLINE_FUNCTION void add_end_tangent(int end, const EndRotation<K, Real>& end_rotation, Rows& rows,
                                                 ReducedSystem<K, Real>& system) {
  using Blocks = ReducedBlocks<K>;
  const Mat3<Real> slope =
      inverse_tangent_transpose_derivative(end_rotation.phi, end_rotation.moment, end_rotation.coefficient);
  const Mat3<Real> hessian = symmetric_part(slope * end_rotation.inverse_tangent);
  const Mat3<Real>& exp = end_rotation.rotation.exp;
  const Mat3<Real> spun = K > 1 ? symmetric_times_transpose(exp * hessian, exp) : hessian;
  const Vec3<Real> moment = K > 1 ? exp * end_rotation.spin_moment : end_rotation.spin_moment;
  const Mat3<Real> coupling = spun - hat(Real(0.5) * moment);
  system.add(Blocks::spin(), Blocks::spin(), spun);
  system.add(Blocks::vertex(end), Blocks::vertex(end), spun);
  system.add(Blocks::vertex(end), Blocks::spin(), -1.0 * transpose(coupling));
  const Mat3<Real> row_vertex =
      K > 1 ? times_transpose(end_rotation.inverse_tangent, exp) : end_rotation.inverse_tangent;
  rows.add_end(end, row_vertex);
  if constexpr (K > 1) {
    const Mat3<Real>& tangent = end_rotation.rotation.tangent;
    const Mat3<Real> tangent_transposed = transpose(tangent);
    const Mat3<Real> psi_spin = tangent_transposed * coupling, vertex_psi = -1.0 * transpose(psi_spin);
    const Mat3<Real> psi_psi = symmetric_times_transpose(tangent_transposed * spun, tangent_transposed) -
                               symmetric_part(tangent_map_derivative(
                                   end_rotation.rotation.psi, end_rotation.spin_moment, end_rotation.rotation.c));
    const Mat3<Real> row_psi = row_vertex * tangent;
    for (int i = 1; i < K; ++i) {
      const double value = end_value(end, i);
      system.add(Blocks::psi(i), Blocks::spin(), value, psi_spin);
      system.add(Blocks::vertex(end), Blocks::psi(i), value, vertex_psi);
      for (int j = 1; j <= i; ++j) system.add(Blocks::psi(i), Blocks::psi(j), value * end_value(end, j), psi_psi);
      rows.add_psi_at_end(end, i, value, row_psi);
    }
  }
}

/// Adds sum_j (2j + 1) s_j m_j over the moment rows, s_j their signed values at one end: the row that acts on a vertex
/// spin.
template <int K, class Sum, class Row>
KOKKOS_FORCEINLINE_FUNCTION void sum_at_end(int end, const Row& row, Sum& sum) {
  for (int j = 0; j <= K; ++j) sum += ((2 * j + 1) * signed_end_value(end, j)) * row(j);
}

/// Eliminates M of a constant section, theory (27): its block is diagonal, and sums over j between ends are known.
template <int K, class Real>
KOKKOS_FORCEINLINE_FUNCTION void condense_moments(const MomentRows<K, Real>& rows, const Vec3<Real>* moment_row,
                                                  const SectionNumbers<Real>& section, const Real& length,
                                                  ReducedSystem<K, Real>& system) {
  using Blocks = ReducedBlocks<K>;
  const int w = Blocks::spin(), a = Blocks::vertex(0), b = Blocks::vertex(1);
  const Real inverse = 1.0 / length;
  const Vec3<Real> stiffness = inverse * load_vector(section.moment_stiffness);
  const Mat3<Real> scaled[2] = {scaled_rows(stiffness, rows.end[0]), scaled_rows(stiffness, rows.end[1])};
  constexpr double same_end = (K + 1) * (K + 1), other_end = K % 2 == 0 ? -(K + 1) : K + 1;
  const Mat3<Real> aa = same_end * symmetric_times_transpose(transpose(rows.end[0]), transpose(scaled[0]));
  const Mat3<Real> bb = same_end * symmetric_times_transpose(transpose(rows.end[1]), transpose(scaled[1]));
  const Mat3<Real> ba = other_end * (transpose(rows.end[1]) * scaled[0]), ab = transpose(ba);
  system.add(a, a, aa);
  system.add(b, b, bb);
  system.add(b, a, ba);
  system.add(a, w, -1.0, aa + ab);
  system.add(b, w, -1.0, bb + ba);
  system.add(w, w, (aa + ab) + (bb + ba));
  for (int end = 0; end < 2; ++end) {
    Vec3<Real> moment{{Real(0.0), Real(0.0), Real(0.0)}};
    sum_at_end<K>(
        end, [&](int j) { return moment_row[j]; }, moment);
    const Vec3<Real> spin = transpose_times(scaled[end], moment);
    system.rhs[Blocks::vertex(end)] += spin;
    system.rhs[w] += -spin;
  }
  if constexpr (K > 1) condense_psi_rows(rows, moment_row, stiffness, scaled, system);
}
/// The blocks of psi in condense_moments. `scaled`: stiffness times the rows of the ends.
template <int K, class Real>
KOKKOS_FORCEINLINE_FUNCTION void condense_psi_rows(const MomentRows<K, Real>& rows, const Vec3<Real>* moment_row,
                                                   const Vec3<Real>& stiffness, const Mat3<Real>* scaled,
                                                   ReducedSystem<K, Real>& system) {
  using Blocks = ReducedBlocks<K>;
  for (int i = 1; i < K; ++i) {
    Mat3<Real> scaled_i[K + 1];
    for (int j = 0; j <= K; ++j) scaled_i[j] = scaled_rows(Real(2 * j + 1) * stiffness, rows.psi[j][i]);
    for (int end = 0; end < 2; ++end) {
      Mat3<Real> sum = zero_matrix<Real>();
      sum_at_end<K>(
          end, [&](int j) -> const Mat3<Real>& { return rows.psi[j][i]; }, sum);
      const Mat3<Real> block = transpose(scaled[end]) * sum;
      system.add(Blocks::vertex(end), Blocks::psi(i), block);
      system.add(Blocks::psi(i), Blocks::spin(), -1.0, transpose(block));
    }
    for (int l = 1; l <= i; ++l) {
      Mat3<Real> sum = system(Blocks::psi(i), Blocks::psi(l));
      for (int j = 0; j <= K; ++j) sum += transpose(scaled_i[j]) * rows.psi[j][l];
      system(Blocks::psi(i), Blocks::psi(l)) = sum;
    }
    for (int j = 0; j <= K; ++j) system.rhs[Blocks::psi(i)] += transpose_times(scaled_i[j], moment_row[j]);
  }
}

/// Writes a block of the 12 x 12 tangent.
template <class Real>
KOKKOS_FORCEINLINE_FUNCTION void store_block(int row, int column, const Mat3<Real>& m, Real* tangent) {
  Real* first = tangent + 36 * row + 3 * column;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) first[12 * i + j] = m(i, j);
}

/// Block of the condensed tangent in the spatial frame. Symmetric: from the lower triangle.
template <bool Symmetric, class Real>
KOKKOS_FORCEINLINE_FUNCTION Mat3<Real> turned_block(const Mat3<Real> (*local)[3], const Mat3<Real>& triad, int I,
                                                    int J) {
  const Mat3<Real> half = triad * local[I][J];
  return Symmetric && I == J ? symmetric_times_transpose(half, triad) : times_transpose(half, triad);
}

/// Condensed tangent in the spatial frame, theory (30), kSymmetricTangent numbers; from the lower triangle.
template <class Real>
KOKKOS_FORCEINLINE_FUNCTION void symmetric_tangent(const Mat3<Real> (*local)[3], const Mat3<Real>& triad,
                                                   const Real& length, Real* tangent) {
  const Real inverse = 1.0 / length;
  for (int I = 0; I < 3; ++I)
    for (int J = 0; J <= I; ++J) {
      Mat3<Real> block = turned_block<true>(local, triad, I, J);
      if (J == 0) block = (I == 0 ? Real(inverse * inverse) : inverse) * block;
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < (I == J ? i + 1 : 3); ++j) tangent[triangle(3 * I + i, 3 * J + j)] = block(i, j);
    }
}

/// Writes the tangent as a 12 x 12 matrix that need not be symmetric.
template <class Real>
KOKKOS_INLINE_FUNCTION void full_tangent(const Mat3<Real> (*local)[3], const Mat3<Real>& triad, const Real& length,
                                         Real* tangent) {
  const Real inverse = 1.0 / length;
  const Mat3<Real> uu = Real(inverse * inverse) * turned_block<false>(local, triad, 0, 0), minus_uu = -1.0 * uu;
  store_block(0, 0, uu, tangent);
  store_block(0, 2, minus_uu, tangent);
  store_block(2, 0, minus_uu, tangent);
  store_block(2, 2, uu, tangent);
  for (int end = 0; end < 2; ++end) {
    const int theta = 1 + 2 * end;
    const Mat3<Real> by_u = inverse * turned_block<false>(local, triad, 1 + end, 0);
    const Mat3<Real> of_u = inverse * turned_block<false>(local, triad, 0, 1 + end);
    store_block(theta, 0, -1.0 * by_u, tangent);
    store_block(theta, 2, by_u, tangent);
    store_block(0, theta, -1.0 * of_u, tangent);
    store_block(2, theta, of_u, tangent);
    store_block(theta, theta, turned_block<false>(local, triad, 1 + end, 1 + end), tangent);
  }
  store_block(3, 1, turned_block<false>(local, triad, 2, 1), tangent);
  store_block(1, 3, turned_block<false>(local, triad, 1, 2), tangent);
}

}  // namespace mixbeam
