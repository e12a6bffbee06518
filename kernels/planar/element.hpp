/// Element of order k that moves in a plane, with k Gauss points for its force strain: the equations of
/// element/element.hpp and condensation/tangent.hpp with angles in place of rotation vectors, theory (31) and theory
/// (32). `Real` is double, or a Pack of elements side by side.
///
/// The angle of a section is that of Lambda_lo plus psi = sum_{j >= 1} psi_j P_j; its increment is alpha = sum_{j >= 0}
/// alpha_j P_j with alpha_0 the spin w ("angle modes"). Vectors have components along g1 and n x g1 of Lambda_lo
/// ("element frame") or of Lambda_E (N, gamma), n being the normal of the plane; angles are about n. kappa = psi' -
/// kappa0 and phi are linear in the angles. One unknown force f remains, constant along the element, with components in
/// the element frame. A given right-hand side may replace the residuals.
#pragma once

#include "kernels/element/layout.hpp"
#include "kernels/math/plane.hpp"

namespace mixbeam {

/// O_ji = int P_j' P_i dxi over [-1, 1] of theory (32).
constexpr double slope_overlap(int j, int i) { return j > i && (j - i) % 2 == 1 ? 2.0 : 0.0; }
/// P_j(-1)
constexpr double sign_of_mode(int j) { return j % 2 == 1 ? -1.0 : 1.0; }

/// Quadrature with k points and the angle and slope modes there.
template <int K>
struct PlanarTables {
  double weight[K];
  double legendre[K][K];     ///< (point, mode)
  ElementTables<K> element;  ///< for line fields, which have values at the k + 1 moment points

  PlanarTables() : element(ForceIntegration::both_reduced) {
    for (int q = 0; q < K; ++q) {
      weight[q] = element.force_weight[q];
      for (int j = 0; j < K; ++j) legendre[q][j] = element.force_legendre[q][j];
    }
  }
};

/// Compliances and stiffnesses in the plane: along g1, along n x g1, bending about n.
template <class Real>
struct PlanarSection {
  Vec2<Real> force_compliance;          ///< 1/EA, 1/GA: the residual
  Vec2<Real> tangent_force_compliance;  ///< inverse of the capped stiffness: the tangent only
  Real moment_compliance;               ///< 1/EI: the residual
  Real moment_stiffness;                ///< EI capped: the tangent only
};

/// State and reference of one element.
template <int K, class Real>
struct PlanarState {
  Real length;
  PlaneTurn<Real> triad;            ///< Lambda_lo: direction of its g1 in the plane
  Real end_angle[2];                ///< rotation from Lambda_lo to Lambda_V Lambda_0 at the ends, in [-pi, pi]
  Vec2<Real> slope[K];              ///< Lambda_lo^T u' = sum_j slope_j P_j
  Vec2<Real> reference_tangent[K];  ///< r0' at the force points, in the plane
  Real psi[K];                      ///< psi_0 unused
  Vec2<Real> force[K];              ///< N at the force points
  Real moment[K + 1];               ///< Legendre coefficients of M
  Real curvature[K + 1];            ///< int P_j kappa0 ds
  PlanarSection<Real> section;
};

/// Sets what follows from the ends: `element`, `vertex`, `reference` are Lambda_lo, Lambda_V and Lambda_0;
/// displacements of the vertices in the plane.
template <int K, class Real>
KOKKOS_FORCEINLINE_FUNCTION void set_planar_ends(const PlaneRotor<Real>& element, const PlaneRotor<Real>* vertex,
                                                 const PlaneRotor<Real>* reference, const Vec2<Real>* displacement,
                                                 PlanarState<K, Real>& state) {
  state.triad = turn_of(element);
  for (int end = 0; end < 2; ++end) state.end_angle[end] = angle_of(vertex[end] * reference[end] * conjugate(element));
  state.slope[0] = (1.0 / state.length) * state.triad.back(displacement[1] - displacement[0]);
}

/// One Gauss point of the force strain.
template <class Real>
struct PlanarPoint {
  PlaneTurn<Real> turn;     ///< rho of theory (31)
  Vec2<Real> pulled_back;   ///< rho^T p = gamma + e1
  Vec2<Real> strain_error;  ///< gamma - C^-1 N
  Real weight;
};

template <int K, class Real>
KOKKOS_FORCEINLINE_FUNCTION PlanarPoint<Real> planar_point(int q, const PlanarState<K, Real>& state,
                                                           const PlanarTables<K>& tables) {
  const double* P = tables.legendre[q];
  PlanarPoint<Real> point;
  Vec2<Real> p = state.triad.back(state.reference_tangent[q]) + state.slope[0];
  Real psi = 0.0;
  for (int j = 1; j < K; ++j) {
    p = p + P[j] * state.slope[j];
    psi += P[j] * state.psi[j];
  }
  point.turn = K > 1 ? turn_by(psi) : PlaneTurn<Real>{1.0, 0.0};
  point.pulled_back = K > 1 ? point.turn.back(p) : p;
  const Vec2<Real> elastic = scaled_by(state.section.force_compliance, state.force[q]);
  point.strain_error = {point.pulled_back.x - 1.0 - elastic.x, point.pulled_back.y - elastic.y};
  point.weight = 0.5 * tables.weight[q] * state.length;
  return point;
}

/// Gradient of the energy, like ElementGradient.
template <int K, class Real>
struct PlanarGradient {
  Vec2<Real> strain_error[K];
  Real moment_row[K + 1];
  Real angle[K];        ///< conjugate to the angle modes
  Vec2<Real> slope[K];  ///< conjugate to the slope modes, element frame
  Real end_moment[2];   ///< conjugate to the spins of the vertices
  Real largest_end_angle;
};

/// Computes the rows of M, theory (17), which are linear in the plane.
template <int K, class Real>
KOKKOS_FORCEINLINE_FUNCTION void planar_moment_rows(const PlanarState<K, Real>& state, Real* rows,
                                                    Real& largest_angle) {
  using std::fabs;
  Real phi[2] = {state.end_angle[0], state.end_angle[1]};
  for (int j = 1; j < K; ++j) {
    phi[0] -= sign_of_mode(j) * state.psi[j];
    phi[1] -= state.psi[j];
  }
  for (int end = 0; end < 2; ++end) phi[end] = shorter_way(phi[end]);
  const Real size[2] = {fabs(phi[0]), fabs(phi[1])};
  largest_angle = select(size[0] > size[1], size[0], size[1]);
  for (int j = 0; j <= K; ++j) {
    Real row = phi[1] - sign_of_mode(j) * phi[0] - state.curvature[j];
    for (int i = j + 1; i < K; ++i)
      if (slope_overlap(i, j) != 0.0) row += slope_overlap(i, j) * state.psi[i];
    rows[j] = row - (1.0 / (2 * j + 1)) * state.length * state.section.moment_compliance * state.moment[j];
  }
}

/// Contributions of M to the rows of the angle modes, theory (18) with O_ji of theory (32), and of the vertex spins.
template <int K, class Real>
KOKKOS_FORCEINLINE_FUNCTION void planar_moment_gradient(const Real* moment, Real* angle, Real* end_moment) {
  for (int i = 0; i < K; ++i) {
    angle[i] = 0.0;
    for (int j = i + 1; j <= K; j += 2) angle[i] -= slope_overlap(j, i) * moment[j];
  }
  end_moment[0] = end_moment[1] = 0.0;
  for (int j = 0; j <= K; ++j) {
    end_moment[0] -= sign_of_mode(j) * moment[j];
    end_moment[1] += moment[j];
  }
}

/// Gradient by theory (16) to theory (18) in the plane.
template <int K, class Real>
KOKKOS_FORCEINLINE_FUNCTION void planar_gradient(const PlanarState<K, Real>& state, const PlanarTables<K>& tables,
                                                 PlanarGradient<K, Real>& g) {
  planar_moment_rows(state, g.moment_row, g.largest_end_angle);
  planar_moment_gradient<K>(state.moment, g.angle, g.end_moment);
  for (int j = 0; j < K; ++j) g.slope[j] = {0.0, 0.0};
  for (int q = 0; q < K; ++q) {
    const double* P = tables.legendre[q];
    const PlanarPoint<Real> point = planar_point(q, state, tables);
    g.strain_error[q] = point.strain_error;
    const Vec2<Real> nu = point.weight * (point.turn * state.force[q]);
    const Real turning = -point.weight * dot(state.force[q], quarter_turn(point.pulled_back));
    for (int j = 0; j < K; ++j) {
      g.slope[j] = g.slope[j] + P[j] * nu;
      g.angle[j] += P[j] * turning;
    }
  }
}

/// Virtual work of a dead force per length (k + 1 moment points) in the plane: same as add_dead_force() of
/// element/line_fields.hpp, except that the part equal on both ends is returned.
template <int K, class Real>
KOKKOS_INLINE_FUNCTION Vec2<Real> add_planar_force(const Vec2<Real>* force, const PlanarState<K, Real>& state,
                                                   const PlanarTables<K>& tables, PlanarGradient<K, Real>& g) {
  Vec2<Real> on_each_end{0.0, 0.0};
  for (int q = 0; q <= K; ++q) {
    const Vec2<Real> half = (-0.25 * tables.element.moment_weight[q]) * (state.length * force[q]);
    on_each_end = on_each_end + half;
    const Vec2<Real> work = state.length * state.triad.back(half);
    for (int j = 0; j < K; ++j) g.slope[j] = g.slope[j] + tables.element.moment_bubble[q][j] * work;
  }
  return on_each_end;
}
/// Subtracts kappa_e, about the normal at the k + 1 moment points, in M . (kappa - kappa_e).
template <int K, class Real>
KOKKOS_INLINE_FUNCTION void subtract_planar_curvature(const Real* curvature, const Real& length,
                                                      const PlanarTables<K>& tables, PlanarGradient<K, Real>& g) {
  for (int q = 0; q <= K; ++q) {
    const Real weighted = (0.5 * tables.element.moment_weight[q]) * length * curvature[q];
    for (int j = 0; j <= K; ++j) g.moment_row[j] -= tables.element.moment_legendre[q][j] * weighted;
  }
}

/// Right-hand side given in place of the gradient of the state: rows of the angle modes, of the slope modes from 1 on
/// (element frame), of N and of M.
template <int K, class Real>
struct PlanarRightHandSide {
  Vec2<Real> strain_error[K];
  Real moment_row[K + 1];
  Real angle[K];
  Vec2<Real> slope[K];
};

}  // namespace mixbeam
