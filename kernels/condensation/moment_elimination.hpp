/// Elimination of the moments of an element with a general section, theory (28): with N eliminated at each force point
/// M is left with a dense matrix A, and its rows D reach the slopes too.
#pragma once

#include "kernels/condensation/tangent.hpp"

namespace mixbeam {

/// Rows of M against every block of the reduced system; as MomentRows, and what replaces its diagonal compliance.
template <int K, class Real>
struct GeneralMomentRows {
  using Blocks = ReducedBlocks<K>;
  static constexpr int kRows = 3 * (K + 1);
  static constexpr int kColumns = FullSystem<K>::kSize;
  Real row[kRows][kColumns];         ///< D
  Real rhs[kRows];                   ///< correction of the right-hand side by the eliminated N
  Real compliance[kRows][kRows];     ///< A
  Real solved[kRows][kColumns + 1];  ///< A^-1 [D | right-hand side]

  KOKKOS_INLINE_FUNCTION void clear() {
    for (int r = 0; r < kRows; ++r) {
      rhs[r] = 0.0;
      for (int c = 0; c < kColumns; ++c) row[r][c] = 0.0;
      for (int c = 0; c < kRows; ++c) compliance[r][c] = 0.0;
    }
  }
  KOKKOS_INLINE_FUNCTION void add_psi(int j, int i, const Real& factor, const Mat3<Real>& m) {
    add_block(row, j, Blocks::psi(i), factor, m);
  }
  KOKKOS_INLINE_FUNCTION void add_end(int end, const Mat3<Real>& m) {
    for (int j = 0; j <= K; ++j) {
      add_block(row, j, Blocks::spin(), -signed_end_value(end, j), m);
      add_block(row, j, Blocks::vertex(end), signed_end_value(end, j), m);
    }
  }

  /// Adds the coupling of N of one force point to the rows of M. P: degrees 0..k-1, of which alone it sees M.
  KOKKOS_INLINE_FUNCTION void couple(const ForcePoint<K, Real>& point, const Vec3<Real>& strain_error,
                                     const ForceRows<Real, Mat3<Real>>& force, const Mat3<Real>& force_moment,
                                     const double* P) {
    const Mat3<Real> coupling = transpose(force_moment) * force.stiffness;
    const Mat3<Real> by_moment = coupling * force_moment, by_slope = coupling * transpose(force.exp);
    const Mat3<Real> by_spin = times_hat(by_slope, force.p);
    const Mat3<Real> by_psi = times_hat(coupling, force.pulled_back) * transpose(force.tangent);
    const Vec3<Real> by_error = coupling * strain_error;
    for (int j = 0; j < K; ++j) {
      const Real w = -P[j] * point.weight;
      for (int i = 0; i < 3; ++i) rhs[3 * j + i] += w * by_error[i];
      add_block(row, j, Blocks::spin(), w, by_spin);
      for (int i = 0; i < K; ++i) add_block(row, j, Blocks::slope(i), P[i] * w, by_slope);
      for (int i = 1; i < K; ++i) add_block(row, j, Blocks::psi(i), P[i] * w, by_psi);
      for (int l = 0; l < K; ++l) add_block(compliance, j, l, P[l] * w, by_moment);
    }
  }

  /// Compliance S_MM of the moment points.
  KOKKOS_INLINE_FUNCTION void add_compliance(const GeneralSection<Real>& section, const ElementTables<K>& tables,
                                             const Real& length) {
    for (int q = 0; q <= K; ++q) {
      const Mat3<Real> capped = capped_compliance(section.moment_moment(q), section.moment_stiffness_limit);
      const double* P = tables.moment_legendre[q];
      const Real w = (0.5 * tables.moment_weight[q]) * length;
      for (int j = 0; j <= K; ++j)
        for (int l = 0; l <= K; ++l) add_block(compliance, j, l, (P[j] * P[l]) * w, capped);
    }
  }

  /// solved = A^-1 [D | given + rhs]. A is positive definite, so that no rows are exchanged.
  KOKKOS_INLINE_FUNCTION void solve(const Vec3<Real>* given) {
    Real inverse[kRows];
    for (int r = 0; r < kRows; ++r) {
      for (int c = 0; c < kColumns; ++c) solved[r][c] = row[r][c];
      solved[r][kColumns] = given[r / 3][r % 3] + rhs[r];
    }
    for (int k = 0; k < kRows; ++k) {
      inverse[k] = 1.0 / compliance[k][k];
      for (int i = k + 1; i < kRows; ++i) {
        const Real factor = compliance[i][k] * inverse[k];
        for (int j = k + 1; j < kRows; ++j) compliance[i][j] -= factor * compliance[k][j];
        for (int c = 0; c <= kColumns; ++c) solved[i][c] -= factor * solved[k][c];
      }
    }
    for (int r = kRows - 1; r >= 0; --r)
      for (int c = 0; c <= kColumns; ++c) {
        for (int j = r + 1; j < kRows; ++j) solved[r][c] -= compliance[r][j] * solved[j][c];
        solved[r][c] *= inverse[r];
      }
  }

  /// Response of one component of M: A^-1 (right-hand side + D dx), dx the response of the reduced unknowns, the last
  /// three blocks of which (slope_0 and the vertex spins) are columns 0..8 themselves.
  KOKKOS_INLINE_FUNCTION void response_row(int r, const InteriorResponse<K, Real>& response, Real* out) const {
    constexpr int interior = FullSystem<K>::kInteriorSize;
    for (int c = 0; c < kResponseColumns; ++c) out[c] = solved[r][interior + c];  // 9: the right-hand side
    for (int b = 0; b < interior; ++b)
      for (int c = 0; c < kResponseColumns; ++c) out[c] += solved[r][b] * response(b, c);
  }

 private:
  template <int Columns>
  KOKKOS_INLINE_FUNCTION static void add_block(Real (*rows)[Columns], int row_block, int column_block,
                                               const Real& factor, const Mat3<Real>& m) {
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) rows[3 * row_block + r][3 * column_block + c] += factor * m(r, c);
  }
};

/// M eliminated from the reduced system: + D^T A^-1 D, in its lower triangle of blocks.
template <int K, class Real>
KOKKOS_INLINE_FUNCTION void condense_moments(GeneralMomentRows<K, Real>& rows, const Vec3<Real>* moment_row,
                                             const GeneralSection<Real>&, const Real&, ReducedSystem<K, Real>& system) {
  rows.solve(moment_row);
  for (int r = 0; r < rows.kRows; ++r)
    for (int a = 0; a < rows.kColumns; ++a) {
      const Real factor = rows.row[r][a];
      for (int b = 0; b < 3 * (a / 3 + 1); ++b) system(a / 3, b / 3)(a % 3, b % 3) += factor * rows.solved[r][b];
      system.rhs[a / 3][a % 3] += factor * rows.solved[r][rows.kColumns];
    }
}

}  // namespace mixbeam
