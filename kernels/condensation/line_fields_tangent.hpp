/// Tangent of line loads: theory (25), by the convention of theory (21). They have no potential in general, so these
/// unsymmetric blocks are added after the symmetric part is complete. Eigenstrains and dead forces do not depend on the
/// state and have no tangent.
#pragma once

#include "kernels/condensation/tangent.hpp"
#include "kernels/element/line_fields.hpp"

namespace mixbeam {

/// Rows of the mean displacement (u_a + u_b)/2 of both vertices, in the element frame. Only follower forces contribute:
/// they depend on w and psi, the first K blocks of the reduced system; nothing depends on the mean.
template <int K, class Real>
struct MeanRows {
  bool used;
  Real row[3][3 * K];

  KOKKOS_INLINE_FUNCTION void clear() {
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3 * K; ++c) row[r][c] = 0.0;
  }
  KOKKOS_INLINE_FUNCTION void add(int column, const Real& factor, const Mat3<Real>& m) {
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) row[i][3 * column + j] += factor * m(i, j);
  }
  /// Adds half of the condensed rows to those of each vertex displacement, in space (layout of full_tangent).
  KOKKOS_INLINE_FUNCTION void expand(const InteriorResponse<K, Real>& response,
                                     const ElementKinematics<K, Real>& kinematics, Real* tangent,
                                     Real* residual) const {
    Real condensed[3][kResponseColumns];  // slope_0, spins a and b, constant
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < kResponseColumns; ++c) {
        Real sum = 0.0;
        for (int i = 0; i < 3 * K; ++i) sum += row[r][i] * response(i, c);
        condensed[r][c] = sum;
      }
    const Mat3<Real>& triad = kinematics.triad;
    const Real inverse = Real(1.0) / kinematics.length;
    for (int J = 0; J < 3; ++J) {
      Mat3<Real> block;
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) block(i, j) = 0.5 * condensed[i][3 * J + j];
      block = triad * block * transpose(triad);
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
          for (int end = 0; end < 2; ++end) {
            Real* row_of_end = tangent + 12 * (6 * end + i);
            if (J == 0) {  // slope_0 = (u_b - u_a)/h
              row_of_end[j] -= block(i, j) * inverse;
              row_of_end[6 + j] += block(i, j) * inverse;
            } else {
              row_of_end[(J == 1 ? 3 : 9) + j] += block(i, j);
            }
          }
    }
    const Vec3<Real> constant = Real(0.5) * (triad * Vec3<Real>{{condensed[0][9], condensed[1][9], condensed[2][9]}});
    for (int end = 0; end < 2; ++end)
      for (int i = 0; i < 3; ++i) residual[6 * end + i] += constant[i];
  }
};

/// Dead couple of theory (25): in the element frame it rotates backwards with w.
template <int K, class Real>
KOKKOS_INLINE_FUNCTION void add_dead_couple_tangent(const Real* values, const ElementKinematics<K, Real>& kinematics,
                                                    const ElementTables<K>& tables, FullSystem<K, Real>& system) {
  using Blocks = ReducedBlocks<K>;
  for (int q = 0; q <= K; ++q) {
    const double* P = tables.moment_legendre[q];
    const Real w = 0.5 * kinematics.length * tables.moment_weight[q];
    const Vec3<Real> couple = transpose_times(kinematics.triad, load_vector(values + 3 * q));
    system.add(Blocks::spin(), Blocks::spin(), -0.5 * w, hat(couple));
    if constexpr (K > 1) {
      const Vec3<Real> psi = kinematics.relative_rotation(P);
      const StumpffValues<Real> c = stumpff(dot(psi, psi));
      const Mat3<Real> by_spin = Real(-1.0) * (transpose(tangent_map(psi, c)) * hat(couple));
      const Mat3<Real> by_psi = tangent_map_derivative(-psi, couple, c);
      for (int i = 1; i < K; ++i) {
        system.add(Blocks::psi(i), Blocks::spin(), w * P[i], by_spin);
        for (int j = 1; j < K; ++j) system.add(Blocks::psi(i), Blocks::psi(j), w * P[i] * P[j], by_psi);
      }
    }
  }
}

/// Follower couple of theory (25): in the element frame it does not depend on w.
template <int K, class Real>
KOKKOS_INLINE_FUNCTION void add_follower_couple_tangent(const Real* values,
                                                        const ElementKinematics<K, Real>& kinematics,
                                                        const ElementTables<K>& tables, FullSystem<K, Real>& system) {
  using Blocks = ReducedBlocks<K>;
  for (int q = 0; q <= K; ++q) {
    const double* P = tables.moment_legendre[q];
    const Real w = 0.5 * kinematics.length * tables.moment_weight[q];
    const PointRotation<K, Real> rotation(kinematics.relative_rotation(P));
    const Vec3<Real> couple = load_vector(values + 3 * q);
    const Mat3<Real> turned = hat(rotation.exp * couple);
    system.add(Blocks::spin(), Blocks::spin(), 0.5 * w, turned);
    if constexpr (K > 1) {
      const Mat3<Real> spin_psi = turned * rotation.tangent;  // d(exp(psi) C) = - hat(exp(psi) C) T dpsi
      const Mat3<Real> psi_psi = tangent_map_derivative(rotation.psi, couple, rotation.c);
      for (int i = 1; i < K; ++i) {
        system.add(Blocks::spin(), Blocks::psi(i), w * P[i], spin_psi);
        for (int j = 1; j < K; ++j) system.add(Blocks::psi(i), Blocks::psi(j), -w * P[i] * P[j], psi_psi);
      }
    }
  }
}

/// Follower force of theory (25): rotates with w and psi, in the rows of all displacements.
template <int K, class Real>
KOKKOS_INLINE_FUNCTION void add_follower_force_tangent(const Real* values, const ElementKinematics<K, Real>& kinematics,
                                                       const ElementTables<K>& tables, FullSystem<K, Real>& system,
                                                       MeanRows<K, Real>& mean) {
  using Blocks = ReducedBlocks<K>;
  for (int q = 0; q <= K; ++q) {
    const double* P = tables.moment_legendre[q];
    const double* bubble = tables.moment_bubble[q];
    const Real w = 0.5 * kinematics.length * tables.moment_weight[q], to_slope = 0.5 * kinematics.length * w;
    const PointRotation<K, Real> rotation(kinematics.relative_rotation(P));
    const Mat3<Real> by_spin = hat(rotation.exp * load_vector(values + 3 * q));
    mean.add(Blocks::spin(), w, by_spin);
    for (int j = 0; j < K; ++j) system.add(Blocks::slope(j), Blocks::spin(), to_slope * bubble[j], by_spin);
    if constexpr (K > 1) {
      const Mat3<Real> by_psi = by_spin * rotation.tangent;
      for (int i = 1; i < K; ++i) {
        mean.add(Blocks::psi(i), w * P[i], by_psi);
        for (int j = 0; j < K; ++j) system.add(Blocks::slope(j), Blocks::psi(i), to_slope * bubble[j] * P[i], by_psi);
      }
    }
  }
}

template <int K, class Real>
KOKKOS_INLINE_FUNCTION void add_field_tangent(const ElementFields<Real>& fields,
                                              const ElementKinematics<K, Real>& kinematics,
                                              const ElementTables<K>& tables, FullSystem<K, Real>& system,
                                              MeanRows<K, Real>& mean) {
  if (const Real* values = fields[LineField::dead_couple]) add_dead_couple_tangent(values, kinematics, tables, system);
  if (const Real* values = fields[LineField::follower_couple])
    add_follower_couple_tangent(values, kinematics, tables, system);
  mean.used = fields[LineField::follower_force] != nullptr;
  if (const Real* values = fields[LineField::follower_force]) {
    mean.clear();
    add_follower_force_tangent(values, kinematics, tables, system, mean);
  }
}

}  // namespace mixbeam
