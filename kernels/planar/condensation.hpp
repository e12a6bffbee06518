/// Condensed tangent of an element in a plane and recovery of its interior: theory (31) and theory (32). Only force
/// compliances appear, no stiffnesses: nothing cancels, however stiff the section is.
#pragma once

#include "kernels/condensation/row_pivoting.hpp"
#include "kernels/planar/element.hpp"

namespace mixbeam {

/// Columns: slope_0 in the plane (two), spins of vertices a and b, constant part.
constexpr int kPlanarColumns = 5;

/// Reduced system of theory (32). Columns: G (2), H_a, H_b, r.
template <int K, class Real>
struct PlanarSystem {
  Real matrix[triangle_size(K)];  ///< H, lower triangle
  Real bending[K];                ///< share of bending in its diagonal
  Real columns[K][kPlanarColumns];
  Real compliance[3];  ///< F: xx, xy, yy
  Vec2<Real> shift;    ///< z
};

/// Changes of the angle modes and of the force f for unit slope_0 (element frame) and vertex spins, and the constant
/// part.
template <int K, class Real>
struct PlanarSolution {
  Real angle[K][kPlanarColumns];
  Real force[2][kPlanarColumns];
  Real end_moment[2][kPlanarColumns];
};

/// Data of the points of one element that both assembly and recovery need.
template <int K, class Real>
struct PlanarPoints {
  PlanarPoint<Real> point[K];
  Vec2<Real> given_force[K];  ///< N, or the force given instead
  Vec2<Real> lever[K];        ///< l of theory (31)
};

template <int K, class Real>
KOKKOS_FORCEINLINE_FUNCTION void clear(PlanarSystem<K, Real>& system) {
  for (Real& entry : system.matrix) entry = 0.0;
  for (auto& row : system.columns)
    for (Real& entry : row) entry = 0.0;
  for (Real& entry : system.compliance) entry = 0.0;
  system.shift = {0.0, 0.0};
}

/// Adds bending in theory (32) and the moment rows; their matrices are constant up to the factor EI/h.
template <int K, class Real>
KOKKOS_FORCEINLINE_FUNCTION void add_planar_bending(const Real& stiffness, const Real* moment_row,
                                                    PlanarSystem<K, Real>& system) {
  for (int i = 0; i < K; ++i) {
    for (int l = i % 2; l <= i; l += 2) {
      double sum = 0.0;
      for (int j = i + 1; j <= K; j += 2) sum += (2 * j + 1) * slope_overlap(j, i) * slope_overlap(j, l);
      system.matrix[triangle(i, l)] += sum * stiffness;
      if (l == i) system.bending[i] = sum * stiffness;
    }
    double at_a = 0.0, at_b = 0.0;
    Real rows = 0.0;
    for (int j = i + 1; j <= K; j += 2) {
      const double weight = (2 * j + 1) * slope_overlap(j, i);
      at_a += sign_of_mode(j) * weight;
      at_b -= weight;
      rows += weight * moment_row[j];
    }
    system.columns[i][2] += at_a * stiffness;
    system.columns[i][3] += at_b * stiffness;
    system.columns[i][4] -= stiffness * rows;
  }
}

/// Adds one Gauss point of theory (32).
template <int K, class Real>
KOKKOS_FORCEINLINE_FUNCTION void add_planar_point(int q, const PlanarState<K, Real>& state,
                                                  const PlanarTables<K>& tables, bool own,
                                                  const PlanarPoints<K, Real>& points, PlanarSystem<K, Real>& system) {
  const double* P = tables.legendre[q];
  const PlanarPoint<Real>& point = points.point[q];
  const Vec2<Real>& compliance = state.section.tangent_force_compliance;
  const Vec2<Real> across = quarter_turn(state.force[q]);  // J N
  const Vec2<Real> soft = scaled_by(compliance, across);   // S J N
  const Vec2<Real> lever = point.weight * (point.turn * points.lever[q]);
  const Real geometric = point.weight * (dot(state.force[q], point.pulled_back) - dot(across, soft));
  // work of N + C R_N that remains after slopes and N are eliminated; own residual: -J g . N - l . N = -S J N . N
  const Vec2<Real>& given = points.given_force[q];
  const Real rest = own ? dot(soft, given) : dot(points.lever[q], given);
  const Real turning = -point.weight * (rest + dot(across, point.strain_error));
  for (int i = 0; i < K; ++i) {
    system.columns[i][0] += P[i] * lever.x;
    system.columns[i][1] += P[i] * lever.y;
    system.columns[i][4] += P[i] * turning;
    for (int l = 0; l <= i; ++l) system.matrix[triangle(i, l)] += (P[i] * P[l]) * geometric;
  }
  const Real c = point.turn.c, s = point.turn.s, along = point.weight * compliance.x,
             shear = point.weight * compliance.y;
  system.compliance[0] += c * c * along + s * s * shear;
  system.compliance[1] += c * s * (along - shear);
  system.compliance[2] += s * s * along + c * c * shear;
  system.shift = system.shift + point.weight * (point.turn * (scaled_by(compliance, given) + point.strain_error));
}

/// `rhs` null: use the gradient of the state.
template <int K, class Real>
KOKKOS_FORCEINLINE_FUNCTION void planar_system(const PlanarState<K, Real>& state, const PlanarTables<K>& tables,
                                               const PlanarRightHandSide<K, Real>* rhs, Real* moment_row,
                                               PlanarPoints<K, Real>& points, PlanarSystem<K, Real>& system) {
  clear(system);
  Real angle[K], unused_end_moment[2], unused_angle;
  if (rhs == nullptr) {
    planar_moment_rows(state, moment_row, unused_angle);
    planar_moment_gradient<K>(state.moment, angle, unused_end_moment);
  } else {
    for (int j = 0; j <= K; ++j) moment_row[j] = rhs->moment_row[j];
    for (int i = 0; i < K; ++i) angle[i] = rhs->angle[i];
  }
  for (int i = 0; i < K; ++i) system.columns[i][4] += angle[i];
  const Real inverse_length = 1.0 / state.length;
  add_planar_bending(inverse_length * state.section.moment_stiffness, moment_row, system);
  for (int q = 0; q < K; ++q) {
    PlanarPoint<Real>& point = points.point[q];
    point = planar_point(q, state, tables);
    points.given_force[q] = state.force[q];
    if (rhs != nullptr) {
      point.strain_error = rhs->strain_error[q];
      Vec2<Real> nu{0.0, 0.0};
      for (int j = 1; j < K; ++j) nu = nu + ((2 * j + 1) * tables.legendre[q][j] * inverse_length) * rhs->slope[j];
      points.given_force[q] = point.turn.back(nu);
    }
    points.lever[q] = scaled_by(state.section.tangent_force_compliance, quarter_turn(state.force[q])) -
                      quarter_turn(point.pulled_back);
    add_planar_point(q, state, tables, rhs == nullptr, points, system);
  }
}

/// A pivot below this fraction of its bending stiffness loses too many digits without row pivoting: the geometric
/// stiffness of a compressed element has cancelled it.
constexpr double kPlanarPivot = 1e-3;
/// Smallest relative determinant of the compliance of f; stiffnesses that differ by the cap (1e5) leave a ratio of that
/// order.
constexpr double kPlanarCompliancePivot = 1e-9;

/// Solves by H = L D L^T without pivoting, then for f. Returns the smallest ratio of pivots to their limits; below one
/// the result is not reliable.
template <int K, class Real>
KOKKOS_FORCEINLINE_FUNCTION Real solve_planar(const Real& length, const PlanarSystem<K, Real>& system,
                                              PlanarSolution<K, Real>& solution) {
  using std::fabs;
  Real factor[triangle_size(K)], x[K][kPlanarColumns], least = 1.0 / kPlanarPivot;
  for (int i = 0; i < triangle_size(K); ++i) factor[i] = system.matrix[i];
  for (int k = 0; k < K; ++k) {
    const Real pivot = factor[triangle(k, k)];
    const Real ratio = fabs(pivot) * (1.0 / kPlanarPivot);
    least = select(ratio >= least * system.bending[k], least, ratio / system.bending[k]);
    const Real inverse = 1.0 / pivot;
    factor[triangle(k, k)] = inverse;
    for (int i = k + 1; i < K; ++i)
      for (int j = k + 1; j <= i; ++j)
        factor[triangle(i, j)] -= factor[triangle(i, k)] * inverse * factor[triangle(j, k)];
    for (int i = k + 1; i < K; ++i) factor[triangle(i, k)] *= inverse;
  }
  for (int c = 0; c < kPlanarColumns; ++c) {
    for (int i = 0; i < K; ++i) {
      x[i][c] = system.columns[i][c];
      for (int j = 0; j < i; ++j) x[i][c] -= factor[triangle(i, j)] * x[j][c];
    }
    for (int i = K - 1; i >= 0; --i) {
      x[i][c] *= factor[triangle(i, i)];
      for (int j = i + 1; j < K; ++j) x[i][c] -= factor[triangle(j, i)] * x[j][c];
    }
  }
  Real xx = system.compliance[0], xy = system.compliance[1], yy = system.compliance[2];
  Real rhs[2][kPlanarColumns] = {{length, 0.0, 0.0, 0.0, system.shift.x}, {0.0, length, 0.0, 0.0, system.shift.y}};
  for (int i = 0; i < K; ++i) {
    xx += system.columns[i][0] * x[i][0];
    xy += system.columns[i][0] * x[i][1];
    yy += system.columns[i][1] * x[i][1];
    for (int r = 0; r < 2; ++r)
      for (int c = 2; c < kPlanarColumns; ++c) rhs[r][c] -= system.columns[i][r] * x[i][c];
  }
  const Real determinant = xx * yy - xy * xy;
  const Real size = (system.compliance[0] + fabs(xx - system.compliance[0])) *
                    (system.compliance[2] + fabs(yy - system.compliance[2]));
  const Real ratio = fabs(determinant) * (1.0 / kPlanarCompliancePivot);
  least = select(ratio >= least * size, least, ratio / size);
  const Real inverse = 1.0 / determinant;
  for (int c = 0; c < kPlanarColumns; ++c) {
    solution.force[0][c] = (yy * rhs[0][c] - xy * rhs[1][c]) * inverse;
    solution.force[1][c] = (xx * rhs[1][c] - xy * rhs[0][c]) * inverse;
    for (int i = 0; i < K; ++i) {
      Real angle = -x[i][0] * solution.force[0][c] - x[i][1] * solution.force[1][c];
      if (c >= 2) angle -= x[i][c];
      solution.angle[i][c] = angle;
    }
  }
  return least;
}

/// Solves one element with row pivoting, angle modes and f together.
template <int K>
KOKKOS_INLINE_FUNCTION void solve_planar_with_pivoting(double length, const PlanarSystem<K, double>& system,
                                                       PlanarSolution<K, double>& solution) {
  constexpr int n = K + 2, m = n + kPlanarColumns;
  double a[n][m];
  for (int i = 0; i < K; ++i) {
    for (int l = 0; l < K; ++l) a[i][l] = system.matrix[i >= l ? triangle(i, l) : triangle(l, i)];
    for (int r = 0; r < 2; ++r) {
      a[i][K + r] = a[K + r][i] = system.columns[i][r];
      a[i][n + r] = 0.0;
    }
    for (int c = 2; c < kPlanarColumns; ++c) a[i][n + c] = -system.columns[i][c];
  }
  const double shift[2] = {system.shift.x, system.shift.y};
  for (int r = 0; r < 2; ++r) {
    for (int s = 0; s < 2; ++s) {
      a[K + r][K + s] = -system.compliance[r + s];
      a[K + r][n + s] = r == s ? -length : 0.0;
    }
    a[K + r][n + 2] = a[K + r][n + 3] = 0.0;
    a[K + r][n + 4] = -shift[r];
  }
  eliminate_rows<n, m>(a);
  for (int c = 0; c < kPlanarColumns; ++c) {
    double x[n];
    for (int i = n - 1; i >= 0; --i) {
      x[i] = a[i][n + c];
      for (int j = i + 1; j < n; ++j) x[i] -= a[i][j] * x[j];
      x[i] /= a[i][i];
    }
    for (int i = 0; i < K; ++i) solution.angle[i][c] = x[i];
    for (int r = 0; r < 2; ++r) solution.force[r][c] = x[K + r];
  }
}

/// Converts columns of slope_0 to those of u_b - u_a in the plane, (u_b - u_a)/h = Lambda_lo slope_0.
template <int K, class Real>
KOKKOS_FORCEINLINE_FUNCTION void columns_to_plane(const PlanarState<K, Real>& state,
                                                  PlanarSolution<K, Real>& solution) {
  const PlaneTurn<Real> turn = (Real(1.0) / state.length) * state.triad;
  const auto turn_columns = [&](Real* row) {
    const Vec2<Real> turned = turn * Vec2<Real>{row[0], row[1]};
    row[0] = turned.x;
    row[1] = turned.y;
  };
  for (int i = 0; i < K; ++i) turn_columns(solution.angle[i]);
  for (int r = 0; r < 2; ++r) turn_columns(solution.force[r]);
}

/// Condensed tangent (TangentLayout) and condensed gradient (ElementEquations::planar_rows), after columns_to_plane()
/// and planar_response(). `own_end_moment`: of the state; null for a given right-hand side.
template <int K, class Real>
KOKKOS_FORCEINLINE_FUNCTION void planar_condensed(const PlanarState<K, Real>& state,
                                                  const PlanarSolution<K, Real>& solution, const Real* own_end_moment,
                                                  Real* tangent, Real* gradient) {
  // slope_0 = (u_b - u_a)/h: its row is h f, and that of u_b is f itself
  Vec2<Real> force[kPlanarColumns];
  for (int c = 0; c < kPlanarColumns; ++c)
    force[c] = state.triad * Vec2<Real>{solution.force[0][c], solution.force[1][c]};
  using Layout = TangentLayout<kPlanarDofs>;
  tangent[Layout::place(0, 0)] = force[0].x;
  tangent[Layout::place(1, 0)] = 0.5 * (force[0].y + force[1].x);
  tangent[Layout::place(1, 1)] = force[1].y;
  for (int end = 0; end < 2; ++end) {
    const int theta = 2 + end;
    tangent[Layout::place(theta, 0)] = force[theta].x;
    tangent[Layout::place(theta, 1)] = force[theta].y;
    tangent[Layout::place(theta, theta)] = solution.end_moment[end][theta];
    gradient[theta] = solution.end_moment[end][4];
    if (own_end_moment != nullptr) gradient[theta] += own_end_moment[end];
  }
  tangent[Layout::place(3, 2)] = 0.5 * (solution.end_moment[0][3] + solution.end_moment[1][2]);
  gradient[0] = force[4].x;
  gradient[1] = force[4].y;
}

}  // namespace mixbeam
