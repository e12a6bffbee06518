/// Elimination of the moments of an element with a general section. With N eliminated at each force point,
///   dN = C (gamma error + d gamma - S_NM dM),   C = S_NN^-1 (capped),
/// M is left with a dense matrix A, and its rows reach the slopes too:
///   A_jl = sum w P_j P_l S_MM - sum w P_j P_l S_MN C S_NM,   D_j <- D_j - sum w P_j S_MN C (d gamma / d x).
#pragma once

#include "kernels/element/tangent.hpp"

namespace mixbeam {

/// Rows of M against every block of the reduced system; as MomentRows, and what replaces its diagonal compliance.
template <int K>
struct GeneralMomentRows {
  static constexpr int kRows = 3 * (K + 1);
  static constexpr int kColumns = FullSystem<K>::kSize;
  double row[kRows][kColumns];         ///< D
  double rhs[kRows];                   ///< correction of the right-hand side by the eliminated N
  double compliance[kRows][kRows];     ///< A
  double solved[kRows][kColumns + 1];  ///< A^-1 [D | right-hand side]

  KOKKOS_INLINE_FUNCTION void clear() {
    for (int r = 0; r < kRows; ++r) {
      rhs[r] = 0.0;
      for (int c = 0; c < kColumns; ++c) row[r][c] = 0.0;
      for (int c = 0; c < kRows; ++c) compliance[r][c] = 0.0;
    }
  }
  KOKKOS_INLINE_FUNCTION void add_psi(int j, int i, double factor, const Mat& m) {
    add_reduced(j, ReducedBlocks<K>::psi(i), factor, m);
  }
  KOKKOS_INLINE_FUNCTION void add_end(int end, const Mat& m) {
    for (int j = 0; j <= K; ++j) {
      add_reduced(j, ReducedBlocks<K>::spin(), -signed_end_value(end, j), m);
      add_reduced(j, ReducedBlocks<K>::vertex(end), signed_end_value(end, j), m);
    }
  }
  KOKKOS_INLINE_FUNCTION void add_reduced(int j, int reduced_block, double factor, const Mat& m) {
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) row[3 * j + r][3 * reduced_block + c] += factor * m(r, c);
  }
  KOKKOS_INLINE_FUNCTION void add_compliance_block(int j, int l, double factor, const Mat& m) {
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) compliance[3 * j + r][3 * l + c] += factor * m(r, c);
  }

  /// What N of one force point leaves in the rows of M. P: degrees 0..k-1, of which alone it sees M.
  KOKKOS_INLINE_FUNCTION void couple(const ForcePoint<K>& point, const Vec& strain_error,
                                     const ForceRows<double, Mat>& force, const Mat& force_moment, const double* P) {
    using Blocks = ReducedBlocks<K>;
    const Mat coupling = transpose(force_moment) * force.stiffness;
    const Mat by_moment = coupling * force_moment, by_slope = coupling * transpose(force.exp);
    const Mat by_spin = times_hat(by_slope, force.p);
    const Mat by_psi = times_hat(coupling, force.pulled_back) * transpose(force.tangent);
    const Vec by_error = coupling * strain_error;
    for (int j = 0; j < K; ++j) {
      const double w = -point.weight * P[j];
      for (int i = 0; i < 3; ++i) rhs[3 * j + i] += w * by_error[i];
      add_reduced(j, Blocks::spin(), w, by_spin);
      for (int i = 0; i < K; ++i) add_reduced(j, Blocks::slope(i), w * P[i], by_slope);
      for (int i = 1; i < K; ++i) add_reduced(j, Blocks::psi(i), w * P[i], by_psi);
      for (int l = 0; l < K; ++l) add_compliance_block(j, l, w * P[l], by_moment);
    }
  }

  /// Compliance S_MM of the moment points.
  KOKKOS_INLINE_FUNCTION void add_compliance(const GeneralSection& section, const ElementTables<K>& tables,
                                             double length) {
    for (int q = 0; q <= K; ++q) {
      const Mat capped = capped_compliance(section.moment_moment(q), section.moment_stiffness_limit);
      const double* P = tables.moment_legendre[q];
      const double w = 0.5 * length * tables.moment_weight[q];
      for (int j = 0; j <= K; ++j)
        for (int l = 0; l <= K; ++l) add_compliance_block(j, l, w * P[j] * P[l], capped);
    }
  }

  /// solved = A^-1 [D | given + rhs]
  KOKKOS_INLINE_FUNCTION void solve(const Vec* given) {
    constexpr int m = kRows + kColumns + 1;
    double a[kRows][m];
    for (int r = 0; r < kRows; ++r) {
      for (int c = 0; c < kRows; ++c) a[r][c] = compliance[r][c];
      for (int c = 0; c < kColumns; ++c) a[r][kRows + c] = row[r][c];
      a[r][m - 1] = given[r / 3][r % 3] + rhs[r];
    }
    eliminate_rows<kRows, m>(a);
    for (int r = kRows - 1; r >= 0; --r) {
      for (int c = 0; c <= kColumns; ++c) solved[r][c] = a[r][kRows + c];
      for (int j = r + 1; j < kRows; ++j)
        for (int c = 0; c <= kColumns; ++c) solved[r][c] -= a[r][j] * solved[j][c];
      const double inverse = 1.0 / a[r][r];
      for (int c = 0; c <= kColumns; ++c) solved[r][c] *= inverse;
    }
  }

  /// Response of one component of M: A^-1 (right-hand side + D dx), dx the response of the reduced unknowns, the last
  /// three blocks of which (slope_0 and the vertex spins) are columns 0..8 themselves.
  KOKKOS_INLINE_FUNCTION void response_row(int r, const InteriorResponse<K>& response, double* out) const {
    constexpr int interior = FullSystem<K>::kInteriorSize;
    for (int c = 0; c < kResponseColumns; ++c) out[c] = solved[r][interior + c];  // 9: the right-hand side
    for (int b = 0; b < interior; ++b)
      for (int c = 0; c < kResponseColumns; ++c) out[c] += solved[r][b] * response(b, c);
  }
};

/// M eliminated from the reduced system: + D^T A^-1 D, in its lower triangle.
template <int K>
KOKKOS_INLINE_FUNCTION void condense_moments(GeneralMomentRows<K>& rows, const Vec* moment_row, const GeneralSection&,
                                             double, ReducedSystem<K>& system) {
  rows.solve(moment_row);
  for (int r = 0; r < GeneralMomentRows<K>::kRows; ++r)
    for (int a = 0; a < GeneralMomentRows<K>::kColumns; ++a) {
      const double factor = rows.row[r][a];
      for (int b = 0; b <= a; ++b) system(a / 3, b / 3)(a % 3, b % 3) += factor * rows.solved[r][b];
      system.rhs[a / 3][a % 3] += factor * rows.solved[r][GeneralMomentRows<K>::kColumns];
    }
}

}  // namespace mixbeam
