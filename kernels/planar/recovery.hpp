/// Increments of the interior of an element in a plane from the solution of its reduced system: theory (27), (31).
#pragma once

#include "kernels/planar/condensation.hpp"

namespace mixbeam {

/// dM_j, theory (27)
template <int K, class Real>
KOKKOS_FORCEINLINE_FUNCTION void planar_moment_response(int j, const PlanarState<K, Real>& state,
                                                        const Real* moment_row, const PlanarSolution<K, Real>& solution,
                                                        Real* response) {
  const Real stiffness = (2 * j + 1) * state.section.moment_stiffness / state.length;
  Real row[kPlanarColumns] = {0.0, 0.0, -sign_of_mode(j), 1.0, moment_row[j]};
  for (int c = 0; c < kPlanarColumns; ++c) {
    for (int i = (j + 1) % 2; i < j && i < K; i += 2) row[c] -= slope_overlap(j, i) * solution.angle[i][c];
    response[c] = stiffness * row[c];
  }
}

/// Rows of the interior increments in the response of an element.
template <int K>
struct PlanarRows {
  static constexpr int kCount = 6 * K - 1;
  KOKKOS_FORCEINLINE_FUNCTION static constexpr int force(int q) { return 2 * q; }
  KOKKOS_FORCEINLINE_FUNCTION static constexpr int moment(int j) { return 2 * K + j; }
  KOKKOS_FORCEINLINE_FUNCTION static constexpr int angle(int j) { return 3 * K + 1 + j; }             ///< 0: the spin w
  KOKKOS_FORCEINLINE_FUNCTION static constexpr int bubble(int j) { return 4 * K + 1 + 2 * (j - 1); }  ///< in the plane
};

/// All increments of the interior from f and the angle modes, theory (31), and the moments on the vertices, in the
/// columns of the solution.
template <int K, class Real>
KOKKOS_FORCEINLINE_FUNCTION void planar_response(const PlanarState<K, Real>& state, const PlanarTables<K>& tables,
                                                 const PlanarPoints<K, Real>& points, const Real* moment_row,
                                                 PlanarSolution<K, Real>& solution, Real (*response)[kPlanarColumns]) {
  using Rows = PlanarRows<K>;
  for (int end = 0; end < 2; ++end)
    for (int c = 0; c < kPlanarColumns; ++c) solution.end_moment[end][c] = 0.0;
  for (int j = 0; j <= K; ++j) {
    Real* row = response[Rows::moment(j)];
    planar_moment_response(j, state, moment_row, solution, row);
    for (int c = 0; c < kPlanarColumns; ++c) {
      solution.end_moment[0][c] -= sign_of_mode(j) * row[c];
      solution.end_moment[1][c] += row[c];
    }
  }
  for (int i = 0; i < K; ++i)
    for (int c = 0; c < kPlanarColumns; ++c) response[Rows::angle(i)][c] = solution.angle[i][c];
  for (int row = Rows::bubble(1); row < Rows::kCount; ++row)
    for (int c = 0; c < kPlanarColumns; ++c) response[row][c] = 0.0;
  for (int q = 0; q < K; ++q) {
    const double* P = tables.legendre[q];
    const PlanarPoint<Real>& point = points.point[q];
    const Vec2<Real> across = quarter_turn(state.force[q]);
    for (int c = 0; c < kPlanarColumns; ++c) {
      Real angle = solution.angle[0][c];
      for (int j = 1; j < K; ++j) angle += P[j] * solution.angle[j][c];
      Vec2<Real> force = point.turn.back(Vec2<Real>{solution.force[0][c], solution.force[1][c]});
      if (c == kPlanarColumns - 1) force = force - points.given_force[q];
      const Vec2<Real> change = force - angle * across;
      response[Rows::force(q)][c] = change.x;
      response[Rows::force(q) + 1][c] = change.y;
      if constexpr (K > 1) {
        Vec2<Real> slope = scaled_by(state.section.tangent_force_compliance, force) - angle * points.lever[q];
        if (c == kPlanarColumns - 1) slope = slope - point.strain_error;
        const Vec2<Real> turned = (0.5 * tables.weight[q]) * (point.turn * slope);
        for (int j = 1; j < K; ++j) {
          response[Rows::bubble(j)][c] += ((2 * j + 1) * P[j]) * turned.x;
          response[Rows::bubble(j) + 1][c] += ((2 * j + 1) * P[j]) * turned.y;
        }
      }
    }
  }
  for (int j = 1; j < K; ++j)
    for (int c = 0; c < kPlanarColumns; ++c) {
      Real *x = &response[Rows::bubble(j)][c], *y = &response[Rows::bubble(j) + 1][c];
      const Vec2<Real> turned = state.triad * Vec2<Real>{*x, *y};
      *x = turned.x;
      *y = turned.y;
    }
}

}  // namespace mixbeam
