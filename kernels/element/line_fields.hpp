/// Line loads and eigenstrains of an element, theory (14), and their part of its gradient, theory (19). Points are
/// independent, so fields may vary arbitrarily; k + 1 points integrate polynomial loads of degree k + 1 exactly.
#pragma once

#include "kernels/element/element.hpp"

namespace mixbeam {

/// Sums of a force over the points, weighted by the shape functions.
template <int K, class Real>
struct ForceSums {
  int first_bubble;
  Vec3<Real> whole{{Real(0.0), Real(0.0), Real(0.0)}}, tilted = whole;  ///< by weight and weight * xi
  Vec3<Real> bubble[K];                                                 ///< by weight * B_j

  KOKKOS_FORCEINLINE_FUNCTION explicit ForceSums(int first) : first_bubble(first) {
    for (int j = 0; j < K; ++j) bubble[j] = whole;
  }
  KOKKOS_FORCEINLINE_FUNCTION void add(int q, const ElementTables<K>& tables, const Vec3<Real>& force) {
    const double weight = tables.moment_weight[q];
    whole += weight * force;
    tilted += (weight * tables.moment_xi[q]) * force;
    for (int j = first_bubble; j < K; ++j) bubble[j] += (weight * tables.moment_bubble[q][j]) * force;
  }
};

/// Virtual work f . du of a dead force f (spatial), u = mean of both vertices + h/2 sum_{j >= 0} slope_j B_j; the term
/// of B_0 belongs to the vertices.
template <int K, class Real>
KOKKOS_INLINE_FUNCTION void add_dead_force(const Real* values, const ElementKinematics<K, Real>& kinematics,
                                           const ElementTables<K>& tables, ElementGradient<K, Real>& g) {
  ForceSums<K, Real> sums(1);
  for (int q = 0; q <= K; ++q) sums.add(q, tables, load_vector(values + 3 * q));
  const Real half = 0.5 * kinematics.length;
  g.vertex_force[0] += (-0.5 * half) * (sums.whole - sums.tilted);
  g.vertex_force[1] += (-0.5 * half) * (sums.whole + sums.tilted);
  for (int j = 1; j < K; ++j) g.slope[j] += (-half * half) * transpose_times(kinematics.triad, sums.bubble[j]);
}

/// Virtual work f . du of f = Lambda_E F, F material.
template <int K, class Real>
KOKKOS_INLINE_FUNCTION void add_follower_force(const Real* values, const ElementKinematics<K, Real>& kinematics,
                                               const ElementTables<K>& tables, ElementGradient<K, Real>& g) {
  ForceSums<K, Real> sums(0);
  for (int q = 0; q <= K; ++q) {
    const PointRotation<K, Real> rotation(kinematics.relative_rotation(tables.moment_legendre[q]));
    sums.add(q, tables, rotation.exp * load_vector(values + 3 * q));
  }
  const Real half = 0.5 * kinematics.length;
  const Vec3<Real> on_each_end = (-0.5 * half) * (kinematics.triad * sums.whole);
  for (int end = 0; end < 2; ++end) g.vertex_force[end] += on_each_end;
  for (int j = 0; j < K; ++j) g.slope[j] += (-half * half) * sums.bubble[j];
}

/// Virtual work c . dtheta_E of a dead couple c (spatial), dtheta_E = w + T(psi) dpsi in the element frame.
template <int K, class Real>
KOKKOS_INLINE_FUNCTION void add_dead_couple(const Real* values, const ElementKinematics<K, Real>& kinematics,
                                            const ElementTables<K>& tables, ElementGradient<K, Real>& g) {
  for (int q = 0; q <= K; ++q) {
    const double* P = tables.moment_legendre[q];
    const Vec3<Real> couple = (-0.5 * kinematics.length * tables.moment_weight[q]) *
                              transpose_times(kinematics.triad, load_vector(values + 3 * q));
    g.spin += couple;
    if constexpr (K > 1) {
      const Vec3<Real> turned = transpose_times(tangent_map(kinematics.relative_rotation(P)), couple);
      for (int j = 1; j < K; ++j) g.psi[j] += P[j] * turned;
    }
  }
}

/// Virtual work of the couple c = Lambda_E C, C material: T(psi)^T exp(psi) C = T(psi) C.
template <int K, class Real>
KOKKOS_INLINE_FUNCTION void add_follower_couple(const Real* values, const ElementKinematics<K, Real>& kinematics,
                                                const ElementTables<K>& tables, ElementGradient<K, Real>& g) {
  for (int q = 0; q <= K; ++q) {
    const double* P = tables.moment_legendre[q];
    const PointRotation<K, Real> rotation(kinematics.relative_rotation(P));
    const Vec3<Real> couple = (-0.5 * kinematics.length * tables.moment_weight[q]) * load_vector(values + 3 * q);
    g.spin += rotation.exp * couple;
    if constexpr (K > 1) {
      const Vec3<Real> turned = rotation.tangent * couple;
      for (int j = 1; j < K; ++j) g.psi[j] += P[j] * turned;
    }
  }
}

/// N . (gamma - gamma_e): N is conjugate to the strain in excess of the eigenstrain.
template <int K, class Real>
KOKKOS_INLINE_FUNCTION void subtract_eigenstrain(const Real* values, const ElementTables<K>& tables,
                                                 ElementGradient<K, Real>& g) {
  for (int q = 0; q < tables.force_points; ++q) {
    const double mask[3] = {tables.axial[q], tables.shear[q], tables.shear[q]};
    for (int i = 0; i < 3; ++i) g.strain_error[q][i] -= mask[i] * values[3 * q + i];
  }
}

/// M . (kappa - kappa_e)
template <int K, class Real>
KOKKOS_INLINE_FUNCTION void subtract_eigencurvature(const Real* values, const Real& length,
                                                    const ElementTables<K>& tables, ElementGradient<K, Real>& g) {
  for (int q = 0; q <= K; ++q) {
    const Vec3<Real> curvature = (-0.5 * length * tables.moment_weight[q]) * load_vector(values + 3 * q);
    for (int j = 0; j <= K; ++j) g.moment_row[j] += tables.moment_legendre[q][j] * curvature;
  }
}

template <int K, class Real>
KOKKOS_INLINE_FUNCTION void add_field_gradient(const ElementFields<Real>& fields,
                                               const ElementKinematics<K, Real>& kinematics,
                                               const ElementTables<K>& tables, ElementGradient<K, Real>& g) {
  if (const Real* values = fields[LineField::dead_force]) add_dead_force(values, kinematics, tables, g);
  if (const Real* values = fields[LineField::dead_couple]) add_dead_couple(values, kinematics, tables, g);
  if (const Real* values = fields[LineField::follower_force]) add_follower_force(values, kinematics, tables, g);
  if (const Real* values = fields[LineField::follower_couple]) add_follower_couple(values, kinematics, tables, g);
  if (const Real* values = fields[LineField::eigenstrain]) subtract_eigenstrain(values, tables, g);
  if (const Real* values = fields[LineField::eigencurvature])
    subtract_eigencurvature(values, kinematics.length, tables, g);
}

}  // namespace mixbeam
