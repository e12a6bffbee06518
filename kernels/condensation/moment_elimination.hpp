/// Elimination of the forces and moments of an element with a general section, theory (28). In values of M at the k + 1
/// moment points, S_MM is block diagonal, so a varying section costs no more than a constant one; the coupling of M and
/// N leaves one small matrix over the force points.
#pragma once

#include "kernels/condensation/tangent.hpp"

namespace mixbeam {

/// Factor of mode j of M in the value at moment point q, up to the quadrature weight.
template <int K>
KOKKOS_INLINE_FUNCTION double mode_at_point(const ElementTables<K>& tables, int q, int j) {
  return (j + 0.5) * tables.moment_legendre[q][j];
}

/// Stiffness of the section of one element, including the compliance of the cap.
template <int K, class Real>
struct GeneralStiffness {
  const GeneralSection<Real>& section;
  const ElementTables<K>& tables;
  double at_force[K][K + 1];  ///< M at a force point from its values at moment points; P_k is zero there
  Mat3<Real> moment[K + 1];   ///< C_m of theory (28)
  Mat3<Real> force[K];        ///< D^-1 of L D L^T, the matrix that remains for N, theory (28)
  Mat3<Real> lower[K][K];     ///< L, coupled sections only

  KOKKOS_INLINE_FUNCTION GeneralStiffness(const GeneralSection<Real>& law, const ElementTables<K>& points,
                                          const Real& length)
      : section(law), tables(points) {
    for (int q = 0; law.is_coupled && q < K; ++q)
      for (int m = 0; m <= K; ++m) {
        at_force[q][m] = 0.0;
        for (int j = 0; j < K; ++j) at_force[q][m] += mode_at_point(tables, m, j) * tables.force_legendre[q][j];
      }
    for (int q = 0; q <= K; ++q)
      moment[q] = Real(2.0 * tables.moment_weight[q] / length) *
                  inverse_of_symmetric(capped_compliance(law.moment_moment(q), law.moment_stiffness_limit));
    for (int q = 0; q < K; ++q) {
      Mat3<Real> unscaled[K];  // row q of L D
      for (int p = law.is_coupled ? 0 : q; p <= q; ++p) {
        Mat3<Real> rest = zero_matrix<Real>();
        if (p == q)
          rest = Real(2.0 / (tables.force_weight[q] * length)) *
                 capped_compliance(law.force_force(q), law.force_stiffness_limit);
        if (law.is_coupled) rest = rest - law.force_moment(q) * (moment_between(q, p) * transpose(law.force_moment(p)));
        for (int r = 0; law.is_coupled && r < p; ++r) rest = rest - unscaled[r] * transpose(lower[p][r]);
        if (p == q) {
          force[q] = inverse_of_symmetric(rest);
        } else {
          unscaled[p] = rest;
          lower[q][p] = rest * force[p];
        }
      }
    }
  }

  /// Overwrites the strains and moment rows by the increments of N at the force points and of the modes of M.
  KOKKOS_INLINE_FUNCTION void answer(const Real& length, Vec3<Real>* strain, Vec3<Real>* moment_row) const {
    Vec3<Real> at[K + 1];
    for (int q = 0; q <= K; ++q) at[q] = moment[q] * value_at_point(q, moment_row);
    for (int q = 0; q < K; ++q) {
      if (section.is_coupled) strain[q] = strain[q] - section.force_moment(q) * moment_at_force(q, at);
      for (int p = 0; section.is_coupled && p < q; ++p) strain[q] = strain[q] - lower[q][p] * strain[p];
    }
    for (int q = K - 1; q >= 0; --q) {
      strain[q] = force[q] * strain[q];
      if (!section.is_coupled) continue;
      for (int p = q + 1; p < K; ++p) strain[q] = strain[q] - transpose_times(lower[p][q], strain[p]);
      const Vec3<Real> curvature = transpose_times(section.force_moment(q), strain[q]);
      for (int m = 0; m <= K; ++m) at[m] = at[m] - at_force[q][m] * (moment[m] * curvature);
    }
    for (int q = 0; q < K; ++q) strain[q] = Real(2.0 / (tables.force_weight[q] * length)) * strain[q];
    for (int j = 0; j <= K; ++j) {
      moment_row[j] = mode_at_point(tables, 0, j) * at[0];
      for (int q = 1; q <= K; ++q) moment_row[j] += mode_at_point(tables, q, j) * at[q];
    }
  }

  KOKKOS_INLINE_FUNCTION Vec3<Real> value_at_point(int q, const Vec3<Real>* modes) const {
    Vec3<Real> sum = mode_at_point(tables, q, 0) * modes[0];
    for (int j = 1; j <= K; ++j) sum += mode_at_point(tables, q, j) * modes[j];
    return sum;
  }
  /// `at`: vectors or matrices at the K + 1 moment points, `stride` apart.
  template <class Value>
  KOKKOS_INLINE_FUNCTION Value moment_at_force(int q, const Value* at, int stride = 1) const {
    Value sum = at_force[q][0] * at[0];
    for (int m = 1; m <= K; ++m) sum += at_force[q][m] * at[m * stride];
    return sum;
  }

 private:
  /// G: M at one force point due to curvatures at another one.
  KOKKOS_INLINE_FUNCTION Mat3<Real> moment_between(int q, int p) const {
    Mat3<Real> sum = zero_matrix<Real>();
    for (int m = 0; m <= K; ++m) sum += (at_force[q][m] * at_force[p][m]) * moment[m];
    return sum;
  }
};

/// Rows of M like MomentRows, but at the moment points instead of by modes.
template <int K, class Real>
struct GeneralMomentRows {
  using Blocks = ReducedBlocks<K>;
  static constexpr int kColumns = K + 2;  ///< w, psi_i, spins of both vertices
  KOKKOS_INLINE_FUNCTION static constexpr int block_of(int column) { return column < K ? column : column + K; }
  double end_value_at[2][K + 1];  ///< sum of (2j + 1)/2 P_j s_j, s_j the signed values at one end
  Mat3<Real> row[K + 1][kColumns];

  KOKKOS_INLINE_FUNCTION void clear(const ElementTables<K>& tables) {
    for (int q = 0; q <= K; ++q) {
      for (Mat3<Real>& block : row[q]) block = zero_matrix<Real>();
      for (int end = 0; end < 2; ++end) {
        end_value_at[end][q] = 0.0;
        for (int j = 0; j <= K; ++j) end_value_at[end][q] += mode_at_point(tables, q, j) * signed_end_value(end, j);
      }
    }
  }
  KOKKOS_INLINE_FUNCTION void add_psi(int q, const ElementTables<K>& tables, int i, const Mat3<Real>& m) {
    row[q][Blocks::psi(i)] += Real(1.0 / tables.moment_weight[q]) * m;
  }
  KOKKOS_INLINE_FUNCTION void add_psi_at_end(int end, int i, double value, const Mat3<Real>& m) {
    for (int q = 0; q <= K; ++q) row[q][Blocks::psi(i)] += Real(-end_value_at[end][q] * value) * m;
  }
  KOKKOS_INLINE_FUNCTION void add_end(int end, const Mat3<Real>& m) {
    for (int q = 0; q <= K; ++q) {
      row[q][K + end] = Real(end_value_at[end][q]) * m;
      row[q][Blocks::spin()] += Real(-end_value_at[end][q]) * m;
    }
  }
};

/// Adds R^T S R to the blocks of a system and R^T S times the right-hand side; `row`: R, `scaled` becomes S R.
template <int Columns, int K, class Real, class BlockOf>
KOKKOS_INLINE_FUNCTION void add_square(const Mat3<Real>* row, const Vec3<Real>& rhs, const Mat3<Real>& stiffness,
                                       const BlockOf& block_of, Mat3<Real>* scaled, ReducedSystem<K, Real>& system) {
  for (int c = 0; c < Columns; ++c) {
    scaled[c] = stiffness * row[c];
    const Mat3<Real> transposed = transpose(scaled[c]);
    for (int d = 0; d <= c; ++d) system.add(block_of(c), block_of(d), transposed * row[d]);
    system.rhs[block_of(c)] += transposed * rhs;
  }
}

/// Eliminates M from the reduced system; for coupled sections also N, whose rows are `forces`.
template <int K, class Real>
KOKKOS_INLINE_FUNCTION void condense_moments(const GeneralMomentRows<K, Real>& rows,
                                             const ElementGradient<K, Real>& gradient, const ForceRows<K, Real>* forces,
                                             const GeneralStiffness<K, Real>& stiffness,
                                             ReducedSystem<K, Real>& system) {
  using Blocks = ReducedBlocks<K>;
  using Rows = GeneralMomentRows<K, Real>;
  constexpr int columns = Rows::kColumns, all = Blocks::kCount;
  Mat3<Real> scaled[K + 1][columns];
  Vec3<Real> moment[K + 1];
  for (int q = 0; q <= K; ++q) {
    const Vec3<Real> rhs = stiffness.value_at_point(q, gradient.moment_row);
    add_square<columns>(rows.row[q], rhs, stiffness.moment[q], Rows::block_of, scaled[q], system);
    moment[q] = stiffness.moment[q] * rhs;
  }
  if (!stiffness.section.is_coupled) return;
  Mat3<Real> row[K][all], unused[all];
  Vec3<Real> rhs[K];
  for (int q = 0; q < K; ++q) {
    forces[q].expand(stiffness.tables.force_legendre[q], row[q]);
    const Mat3<Real> coupling = stiffness.section.force_moment(q);
    for (int c = 0; c < columns; ++c) {
      Mat3<Real>& block = row[q][Rows::block_of(c)];
      block = block - coupling * stiffness.moment_at_force(q, &scaled[0][c], columns);
    }
    rhs[q] = gradient.strain_error[q] - coupling * stiffness.moment_at_force(q, moment);
    for (int p = 0; p < q; ++p) {
      const Mat3<Real>& lower = stiffness.lower[q][p];
      for (int b = 0; b < all; ++b) row[q][b] = row[q][b] - lower * row[p][b];
      rhs[q] = rhs[q] - lower * rhs[p];
    }
    add_square<all>(
        row[q], rhs[q], stiffness.force[q], [](int b) { return b; }, unused, system);
  }
}

}  // namespace mixbeam
