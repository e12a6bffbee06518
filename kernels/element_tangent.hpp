/// Condensed tangent of one element: second variation of the energy (with the second-order expansion of exp in each
/// spin, so conservative terms are symmetric), eliminated in the cheap order N (pointwise) - M (diagonal, unless the
/// section is general) - rotations and bubbles.
#pragma once

#include "kernels/element_block.hpp"
#include "kernels/element_residual.hpp"

namespace mixbeam {

/// What remains after N and M are eliminated, in blocks of three, all in the element frame:
///   w | psi_1 .. psi_{k-1} | slope_1 .. slope_{k-1} || slope_0 | spin of vertex a | spin of vertex b.
/// The first 2k - 1 blocks are interior; slope_0 = Lambda_lo^T (u_b - u_a)/h carries both vertex displacements.
template <int K>
struct ReducedBlocks {
  static constexpr int kInterior = 2 * K - 1;
  static constexpr int kCount = 2 * K + 2;
  KOKKOS_INLINE_FUNCTION static constexpr int spin() { return 0; }
  KOKKOS_INLINE_FUNCTION static constexpr int psi(int j) { return j; }
  KOKKOS_INLINE_FUNCTION static constexpr int slope(int j) { return j == 0 ? 2 * K - 1 : K - 1 + j; }
  KOKKOS_INLINE_FUNCTION static constexpr int vertex(int end) { return 2 * K + end; }
};

template <int K>
struct ReducedSystem {
  static constexpr int kSize = 3 * ReducedBlocks<K>::kCount;
  static constexpr int kInteriorSize = 3 * ReducedBlocks<K>::kInterior;
  double matrix[kSize][kSize];  ///< block lower triangle while it is being built
  double rhs[kSize];            ///< reduced gradient

  KOKKOS_INLINE_FUNCTION void add(int row, int column, double factor, const Mat& m) {
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) matrix[3 * row + i][3 * column + j] += factor * m(i, j);
  }
  KOKKOS_INLINE_FUNCTION void add(int row, double factor, const Vec& v) {
    for (int i = 0; i < 3; ++i) rhs[3 * row + i] += factor * v[i];
  }
  KOKKOS_INLINE_FUNCTION void mirror() {
    for (int i = 0; i < kSize; ++i)
      for (int j = i + 1; j < kSize; ++j) matrix[i][j] = matrix[j][i];
  }
};

/// d gamma / d(p, w, psi) at a force point, kept for the recovery of N.
template <class Stiffness>
struct ForceRows {
  Mat slope, spin, psi;
  Stiffness stiffness;  ///< capped tangent stiffness: diagonal and masked (Vec), or (S_NN capped)^-1 (Mat)
};

/// d(moment row j) / d(w, psi_1 .., vertex spins): block columns w, psi_1 .. psi_{k-1}, a, b.
template <int K>
struct MomentRows {
  double row[K + 1][3][3 * (K + 2)];
  KOKKOS_INLINE_FUNCTION void add(int j, int block, double factor, const Mat& m) {
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) row[j][r][3 * block + c] += factor * m(r, c);
  }
  KOKKOS_INLINE_FUNCTION void clear() {
    for (int j = 0; j <= K; ++j)
      for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3 * (K + 2); ++c) row[j][r][c] = 0.0;
  }
  /// Block of the reduced system behind a block column.
  KOKKOS_INLINE_FUNCTION static constexpr int reduced(int block) {
    return block < K ? block : ReducedBlocks<K>::vertex(block - K);
  }
};

/// m^T diag(d) n
KOKKOS_INLINE_FUNCTION Mat weighted_product(const Mat& m, const Vec& d, const Mat& n) {
  Mat r;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      r(i, j) = m(0, i) * d[0] * n(0, j) + m(1, i) * d[1] * n(1, j) + m(2, i) * d[2] * n(2, j);
  return r;
}

/// m^T c n
KOKKOS_INLINE_FUNCTION Mat weighted_product(const Mat& m, const Mat& c, const Mat& n) { return transpose(m) * (c * n); }

/// w C e
KOKKOS_INLINE_FUNCTION Vec weighted_stress(double w, const Vec& c, const Vec& e) {
  return {{w * c[0] * e[0], w * c[1] * e[1], w * c[2] * e[2]}};
}
KOKKOS_INLINE_FUNCTION Vec weighted_stress(double w, const Mat& c, const Vec& e) { return w * (c * e); }

template <int K>
KOKKOS_INLINE_FUNCTION Vec tangent_force_stiffness(int q, const ElementTables<K>& tables,
                                                   const SectionConstants& section) {
  const double* stiffness = section.tangent_force_stiffness;
  return {{tables.axial[q] * stiffness[0], tables.shear[q] * stiffness[1], tables.shear[q] * stiffness[2]}};
}
template <int K>
KOKKOS_INLINE_FUNCTION Mat tangent_force_stiffness(int q, const ElementTables<K>&, const GeneralSection& section) {
  return inverse_of_symmetric(capped_compliance(section.force_force(q), section.force_stiffness_limit));
}

template <int K, class Stiffness>
KOKKOS_INLINE_FUNCTION ForceRows<Stiffness> force_rows(const ForcePoint<K>& point, const Stiffness& stiffness) {
  ForceRows<Stiffness> rows;
  rows.slope = transpose(point.rotation.exp);
  rows.spin = K > 1 ? rows.slope * hat(point.p) : hat(point.p);
  rows.psi = K > 1 ? hat(point.pulled_back) * transpose(point.rotation.tangent) : zero_matrix<double>();
  rows.stiffness = stiffness;
  return rows;
}

/// Material part B^T C B and geometric part (with the stored N) of one force point, expanded into the Legendre modes.
template <int K, class Stiffness>
KOKKOS_INLINE_FUNCTION void add_force_tangent(const ForcePoint<K>& point, const ForceRows<Stiffness>& rows,
                                              const double* P, ReducedSystem<K>& system) {
  using Blocks = ReducedBlocks<K>;
  const Vec nu = K > 1 ? point.rotation.exp * point.force : point.force;
  const Mat slope_slope = weighted_product(rows.slope, rows.stiffness, rows.slope);
  const Mat slope_spin = weighted_product(rows.slope, rows.stiffness, rows.spin) - hat(nu);
  Mat spin_spin = weighted_product(rows.spin, rows.stiffness, rows.spin) + symmetric_part(outer(nu, point.p));
  const double along = dot(nu, point.p);
  for (int i = 0; i < 3; ++i) spin_spin(i, i) -= along;
  const double w = point.weight;
  system.add(Blocks::spin(), Blocks::spin(), w, spin_spin);
  for (int i = 0; i < K; ++i) {
    system.add(Blocks::slope(i), Blocks::spin(), w * P[i], slope_spin);
    for (int j = 0; j < K; ++j)
      if (Blocks::slope(i) >= Blocks::slope(j))
        system.add(Blocks::slope(i), Blocks::slope(j), w * P[i] * P[j], slope_slope);
  }
  if constexpr (K > 1) {
    // T hat(N): turns a change of the pulled-back slope into the psi equation
    const Mat turned = point.rotation.tangent * hat(point.force);
    const Mat psi_slope = weighted_product(rows.psi, rows.stiffness, rows.slope) + turned * rows.slope;
    const Mat psi_spin = weighted_product(rows.psi, rows.stiffness, rows.spin) + turned * rows.spin;
    const Mat psi_psi = weighted_product(rows.psi, rows.stiffness, rows.psi) +
                        rotation_form_hessian(1, point.force, point.p, point.rotation.psi, point.rotation.c);
    const Mat slope_psi = transpose(psi_slope);
    for (int i = 1; i < K; ++i) {
      system.add(Blocks::psi(i), Blocks::spin(), w * P[i], psi_spin);
      for (int j = 1; j <= i; ++j) system.add(Blocks::psi(i), Blocks::psi(j), w * P[i] * P[j], psi_psi);
      for (int j = 0; j < K; ++j) system.add(Blocks::slope(j), Blocks::psi(i), w * P[i] * P[j], slope_psi);
    }
  }
}

/// Reduced gradient of one force point: B^T C (gamma - C^-1 N), on top of the gradient with the stored N.
template <int K, class Stiffness>
KOKKOS_INLINE_FUNCTION void add_force_correction(const ForcePoint<K>& point, const ForceRows<Stiffness>& rows,
                                                 const double* P, ReducedSystem<K>& system) {
  using Blocks = ReducedBlocks<K>;
  const Vec correction = weighted_stress(point.weight, rows.stiffness, point.strain_error);
  system.add(Blocks::spin(), 1.0, transpose_times(rows.spin, correction));
  const Vec slope = transpose_times(rows.slope, correction);
  for (int j = 0; j < K; ++j) system.add(Blocks::slope(j), P[j], slope);
  if constexpr (K > 1) {
    const Vec psi = transpose_times(rows.psi, correction);
    for (int j = 1; j < K; ++j) system.add(Blocks::psi(j), P[j], psi);
  }
}

/// `rows`: MomentRows or GeneralMomentRows.
template <int K, class Rows>
KOKKOS_INLINE_FUNCTION void add_moment_tangent(const MomentPoint<K>& point, const double* P, const double* slope,
                                               double length, Rows& rows, ReducedSystem<K>& system) {
  if constexpr (K > 1) {
    const Vec& psi = point.rotation.psi;
    const Mat strain_slope = transpose(point.rotation.tangent);
    const Mat strain_psi = -1.0 * tangent_map_derivative(-psi, point.slope, point.rotation.c);
    const Mat slope_psi = tangent_map_derivative(psi, point.moment, point.rotation.c);
    const Mat psi_psi = rotation_form_hessian(2, point.moment, point.slope, psi, point.rotation.c);
    const double w = point.weight, to_s = 2.0 / length;
    for (int i = 1; i < K; ++i) {
      const Mat strain_i = (w * to_s * slope[i]) * strain_slope + (w * P[i]) * strain_psi;
      for (int j = 0; j <= K; ++j) rows.add(j, i, P[j], strain_i);
      for (int j = 1; j <= i; ++j) {
        system.add(i, j, w * P[i] * P[j], psi_psi);
        system.add(i, j, w * to_s * slope[i] * P[j], slope_psi);
        system.add(i, j, w * to_s * P[i] * slope[j], transpose(slope_psi));
      }
    }
  }
}

/// Boundary term at one end. The perturbed relative rotation is exp(-tau) exp(-w~) exp(v~) B with tau = T^T dpsi and
/// tildes pulled back by exp(psi)^T; its second-order expansion gives the antisymmetric parts beside the Hessian of the
/// log.
template <int K, class Rows>
KOKKOS_INLINE_FUNCTION void add_end_tangent(int end, const EndRotation<K>& joint, Rows& rows,
                                            ReducedSystem<K>& system) {
  using Blocks = ReducedBlocks<K>;
  const Mat slope = inverse_tangent_transpose_derivative(joint.phi, joint.moment, joint.coefficient);
  const Mat hessian = symmetric_part(slope * joint.inverse_tangent);
  const Mat mixed = hessian - 0.5 * hat(joint.spin_moment);
  const Mat& exp = joint.rotation.exp;
  const Mat exp_transposed = transpose(exp);
  const Mat spun = K > 1 ? exp * hessian * exp_transposed : hessian;
  const Mat spun_mixed = K > 1 ? exp * mixed * exp_transposed : mixed;
  system.add(Blocks::spin(), Blocks::spin(), 1.0, spun);
  system.add(Blocks::vertex(end), Blocks::vertex(end), 1.0, spun);
  system.add(Blocks::vertex(end), Blocks::spin(), -1.0, transpose(spun_mixed));
  const Mat row_vertex = K > 1 ? joint.inverse_tangent * exp_transposed : joint.inverse_tangent;
  for (int j = 0; j <= K; ++j) {
    const double value = joint.sign * end_value(end, j);
    rows.add(j, 0, -value, row_vertex);
    rows.add(j, K + end, value, row_vertex);
  }
  if constexpr (K > 1) {
    const Mat& tangent = joint.rotation.tangent;
    const Mat psi_spin = tangent * mixed * exp_transposed;
    const Mat psi_psi = tangent * hessian * transpose(tangent) -
                        symmetric_part(tangent_map_derivative(joint.rotation.psi, joint.spin_moment, joint.rotation.c));
    const Mat row_psi = joint.inverse_tangent * transpose(tangent);
    for (int i = 1; i < K; ++i) {
      const double value = end_value(end, i);
      system.add(Blocks::psi(i), Blocks::spin(), value, psi_spin);
      system.add(Blocks::vertex(end), Blocks::psi(i), -value, transpose(psi_spin));
      for (int j = 1; j <= i; ++j) system.add(Blocks::psi(i), Blocks::psi(j), value * end_value(end, j), psi_psi);
      for (int j = 0; j <= K; ++j) rows.add(j, i, -joint.sign * end_value(end, j) * value, row_psi);
    }
  }
}

/// M eliminated: for a constant section its block is -h/(2j + 1) C_kappa^-1, diagonal.
template <int K>
KOKKOS_INLINE_FUNCTION void condense_moments(const MomentRows<K>& rows, const Vec* moment_row,
                                             const SectionConstants& section, double length, ReducedSystem<K>& system) {
  constexpr int columns = 3 * (K + 2);
  for (int j = 0; j <= K; ++j) {
    for (int r = 0; r < 3; ++r) {
      const double stiffness = (2 * j + 1) / length * section.moment_stiffness[r];
      const double* row = rows.row[j][r];
      for (int a = 0; a < columns; ++a) {
        const int ra = 3 * MomentRows<K>::reduced(a / 3) + a % 3;
        const double scaled = stiffness * row[a];
        system.rhs[ra] += scaled * moment_row[j][r];
        for (int b = 0; b <= a; ++b) system.matrix[ra][3 * MomentRows<K>::reduced(b / 3) + b % 3] += scaled * row[b];
      }
    }
  }
}

/// Gaussian elimination with row pivoting of N rows and M columns: the first N columns become upper triangular. A zero
/// pivot leaves non-finite numbers, which the residual test of the same iteration reports.
template <int N, int M>
KOKKOS_INLINE_FUNCTION void eliminate_rows(double (*a)[M]) {
  for (int k = 0; k < N; ++k) {
    int pivot = k;
    double largest = a[k][k] < 0 ? -a[k][k] : a[k][k];
    for (int i = k + 1; i < N; ++i) {
      const double size = a[i][k] < 0 ? -a[i][k] : a[i][k];
      if (size > largest) {
        largest = size;
        pivot = i;
      }
    }
    if (pivot != k)
      for (int j = k; j < M; ++j) {
        const double swap = a[k][j];
        a[k][j] = a[pivot][j];
        a[pivot][j] = swap;
      }
    const double inverse = 1.0 / a[k][k];
    for (int i = k + 1; i < N; ++i) {
      const double factor = a[i][k] * inverse;
      for (int j = k + 1; j < M; ++j) a[i][j] -= factor * a[k][j];
    }
  }
}

/// Solves the interior blocks for the response of w, psi, slope_1.. : elimination of [H_ii | H_ir, R_i]; on return
/// `response` holds -H_ii^-1 [H_ir | R_i].
template <int K>
KOKKOS_INLINE_FUNCTION void solve_interior(const ReducedSystem<K>& system, double (*response)[kResponseColumns]) {
  constexpr int n = ReducedSystem<K>::kInteriorSize, m = n + kResponseColumns;
  double a[n][m];
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n + 9; ++j) a[i][j] = system.matrix[i][j];
    a[i][n + 9] = system.rhs[i];
  }
  eliminate_rows<n, m>(a);
  for (int i = n - 1; i >= 0; --i) {
    const double inverse = 1.0 / a[i][i];
    for (int c = 0; c < kResponseColumns; ++c) {
      double sum = -a[i][n + c];
      for (int j = i + 1; j < n; ++j) sum -= a[i][j] * response[j][c];
      response[i][c] = sum * inverse;
    }
  }
}

/// Condensed 9 x 9 tangent and gradient of slope_0 and the vertex spins (element frame).
template <int K>
KOKKOS_INLINE_FUNCTION void condense_interior(const ReducedSystem<K>& system,
                                              const double (*response)[kResponseColumns], double (*tangent)[9],
                                              double* gradient) {
  constexpr int n = ReducedSystem<K>::kInteriorSize;
  for (int r = 0; r < 9; ++r) {
    double sum[kResponseColumns];
    for (int c = 0; c < 9; ++c) sum[c] = system.matrix[n + r][n + c];
    sum[9] = system.rhs[n + r];
    for (int i = 0; i < n; ++i)
      for (int c = 0; c < kResponseColumns; ++c) sum[c] += system.matrix[n + r][i] * response[i][c];
    for (int c = 0; c < 9; ++c) tangent[r][c] = sum[c];
    gradient[r] = sum[9];
  }
}

/// Rotates the 9 x 9 tangent to space and expands slope_0 to both vertex displacements: rows and columns u_a, theta_a,
/// u_b, theta_b.
KOKKOS_INLINE_FUNCTION void expand_tangent(const double (*local)[9], const Mat& triad, double length, double* tangent) {
  const int first[3] = {0, 3, 9};
  for (int I = 0; I < 3; ++I) {
    for (int J = 0; J < 3; ++J) {
      Mat block;
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) block(i, j) = local[3 * I + i][3 * J + j];
      block = triad * block * transpose(triad);
      const double scale = (I == 0 ? 1.0 / length : 1.0) * (J == 0 ? 1.0 / length : 1.0);
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
          const double value = scale * block(i, j);
          // slope_0 = (u_b - u_a)/h: minus for vertex a, plus for vertex b
          tangent[12 * (first[I] + i) + first[J] + j] = (I == 0 && J > 0) || (I > 0 && J == 0) ? -value : value;
          if (I == 0) tangent[12 * (6 + i) + first[J] + j] = J == 0 ? -value : value;
          if (J == 0) tangent[12 * (first[I] + i) + 6 + j] = I == 0 ? -value : value;
          if (I == 0 && J == 0) tangent[12 * (6 + i) + 6 + j] = value;
        }
    }
  }
}

}  // namespace mixbeam
