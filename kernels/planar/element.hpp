/// One element of order k that moves in a plane, with k Gauss points for its force strain: the equations of
/// element/gradient.hpp and element/tangent.hpp with numbers in place of rotation vectors, theory (31) and theory (32).
/// `Real` is double, or a Pack of elements side by side.
///
/// The angle of a section is that of Lambda_lo plus psi = sum_{j >= 1} psi_j P_j; its increment is alpha = sum_{j >= 0}
/// alpha_j P_j with alpha_0 the spin w ("angle modes"). Vectors have the components along g1 and n x g1 of Lambda_lo
/// ("element frame") or of Lambda_E (N, gamma), n being the normal of the plane, and angles turn about n. kappa = psi'
/// - kappa0 and phi are linear in the angles. The force f is constant along the element, which carries no line loads;
/// it has components in the element frame, and a right-hand side from outside may take the place of the residuals in
/// it.
#pragma once

#include "kernels/element/layout.hpp"
#include "kernels/element/reduced_system.hpp"
#include "kernels/math/rotation.hpp"

#include <cmath>

namespace mixbeam {

/// A vector in the plane.
template <class Real>
struct Vec2 {
  Real x, y;
};
template <class Real>
KOKKOS_FORCEINLINE_FUNCTION Vec2<Real> operator+(const Vec2<Real>& a, const Vec2<Real>& b) {
  return {a.x + b.x, a.y + b.y};
}
template <class Real>
KOKKOS_FORCEINLINE_FUNCTION Vec2<Real> operator-(const Vec2<Real>& a, const Vec2<Real>& b) {
  return {a.x - b.x, a.y - b.y};
}
template <class Real, class Factor>
KOKKOS_FORCEINLINE_FUNCTION Vec2<Real> operator*(const Factor& f, const Vec2<Real>& a) {
  return {f * a.x, f * a.y};
}
template <class Real>
KOKKOS_FORCEINLINE_FUNCTION Real dot(const Vec2<Real>& a, const Vec2<Real>& b) {
  return a.x * b.x + a.y * b.y;
}
/// J a: a quarter turn.
template <class Real>
KOKKOS_FORCEINLINE_FUNCTION Vec2<Real> quarter_turn(const Vec2<Real>& a) {
  return {-a.y, a.x};
}
/// diag(d) a
template <class Real>
KOKKOS_FORCEINLINE_FUNCTION Vec2<Real> scaled_by(const Vec2<Real>& d, const Vec2<Real>& a) {
  return {d.x * a.x, d.y * a.y};
}

/// Rotation in the plane: cosine and sine of its angle, perhaps times a factor.
template <class Real>
struct PlaneTurn {
  Real c, s;
  friend KOKKOS_FORCEINLINE_FUNCTION PlaneTurn operator*(const Real& f, const PlaneTurn& a) {
    return {f * a.c, f * a.s};
  }
  KOKKOS_FORCEINLINE_FUNCTION Vec2<Real> operator*(const Vec2<Real>& a) const {
    return {c * a.x - s * a.y, s * a.x + c * a.y};
  }
  KOKKOS_FORCEINLINE_FUNCTION Vec2<Real> back(const Vec2<Real>& a) const {
    return {c * a.x + s * a.y, c * a.y - s * a.x};
  }
};

/// Below this squared angle eight terms of the series leave a truncation error under 1e-18.
constexpr double kTurnSeriesLimit = 0.25;

/// Cosine and sine as the Stumpff functions c_0(x) and angle c_1(x) of x = angle^2 <= kTurnSeriesLimit.
template <class Real>
KOKKOS_FORCEINLINE_FUNCTION PlaneTurn<Real> turn_by_series(const Real& angle) {
  constexpr int terms = 8;
  const Real x = angle * angle;
  Real c0 = 1.0, c1 = 1.0;
#pragma GCC unroll 8
  for (int j = terms - 1; j > 0; --j) {  // nested form of sum (-x)^j k!/(2j+k)!
    c0 = 1.0 - x * c0 * (1.0 / ((2.0 * j - 1.0) * (2.0 * j)));
    c1 = 1.0 - x * c1 * (1.0 / ((2.0 * j) * (2.0 * j + 1.0)));
  }
  return {c0, angle * c1};
}
KOKKOS_INLINE_FUNCTION PlaneTurn<double> turn_by(double angle) {
  if (angle * angle <= kTurnSeriesLimit) return turn_by_series(angle);
  return {std::cos(angle), std::sin(angle)};
}
/// Lanes beyond the series, which are rare, one by one.
template <int W>
KOKKOS_FORCEINLINE_FUNCTION PlaneTurn<Pack<W>> turn_by(const Pack<W>& angle) {
  PlaneTurn<Pack<W>> turn = turn_by_series(angle);
  if (any<W>(angle * angle > Pack<W>(kTurnSeriesLimit)))
    for (int lane = 0; lane < W; ++lane) {
      const PlaneTurn<double> one = turn_by(angle[lane]);
      turn.c.set(lane, one.c);
      turn.s.set(lane, one.s);
    }
  return turn;
}

/// A unit quaternion w + z n: cosine and sine of half an angle about n. Products are those of complex numbers.
template <class Real>
struct PlaneRotor {
  Real w, z;
};
template <class Real>
KOKKOS_FORCEINLINE_FUNCTION PlaneRotor<Real> operator*(const PlaneRotor<Real>& a, const PlaneRotor<Real>& b) {
  return {a.w * b.w - a.z * b.z, a.w * b.z + a.z * b.w};
}
template <class Real>
KOKKOS_FORCEINLINE_FUNCTION PlaneRotor<Real> conjugate(const PlaneRotor<Real>& a) {
  return {a.w, -a.z};
}
template <class Real>
KOKKOS_FORCEINLINE_FUNCTION PlaneTurn<Real> turn_of(const PlaneRotor<Real>& a) {
  return {1.0 - 2.0 * (a.z * a.z), 2.0 * (a.w * a.z)};
}

/// Angle for |z/w| below the root of kLogSeriesLimit (rotation.hpp): eight terms of arctan's series.
template <class Real>
KOKKOS_FORCEINLINE_FUNCTION Real angle_by_series(const PlaneRotor<Real>& a) {
  const Real tangent = a.z / a.w, t = tangent * tangent;
  Real sum = 1.0 / 15;
#pragma GCC unroll 8
  for (int j = 6; j >= 0; --j) sum = 1.0 / (2 * j + 1) - t * sum;
  return 2.0 * (tangent * sum);
}
/// Angle of a rotor in [-pi, pi], with full accuracy also next to the ends.
KOKKOS_INLINE_FUNCTION double angle_of(const PlaneRotor<double>& a) {
  if (a.z * a.z < kLogSeriesLimit * (a.w * a.w)) return angle_by_series(a);
  return 2.0 * (a.w < 0.0 ? std::atan2(-a.z, -a.w) : std::atan2(a.z, a.w));
}
template <int W>
KOKKOS_FORCEINLINE_FUNCTION Pack<W> angle_of(const PlaneRotor<Pack<W>>& a) {
  Pack<W> angle = angle_by_series(a);
  if (any<W>(a.z * a.z >= kLogSeriesLimit * (a.w * a.w)))
    for (int lane = 0; lane < W; ++lane) angle.set(lane, angle_of(PlaneRotor<double>{a.w[lane], a.z[lane]}));
  return angle;
}

/// The same angle in [-pi, pi], for |angle| < 3 pi.
template <class Real>
KOKKOS_FORCEINLINE_FUNCTION Real shorter_way(const Real& angle) {
  constexpr double pi = 3.14159265358979323846;
  return angle - select(angle > Real(pi), Real(2.0 * pi), Real(0.0)) +
         select(angle < Real(-pi), Real(2.0 * pi), Real(0.0));
}

/// O_ji = int P_j' P_i dxi over [-1, 1] of theory (32).
constexpr double slope_overlap(int j, int i) { return j > i && (j - i) % 2 == 1 ? 2.0 : 0.0; }
/// P_j(-1)
constexpr double sign_of_mode(int j) { return j % 2 == 1 ? -1.0 : 1.0; }

/// Quadrature with k points and the angle and slope modes there.
template <int K>
struct PlanarTables {
  double weight[K];
  double legendre[K][K];  ///< (point, mode)

  PlanarTables() {
    const ElementTables<K> tables(ForceIntegration::both_reduced);
    for (int q = 0; q < K; ++q) {
      weight[q] = tables.force_weight[q];
      for (int j = 0; j < K; ++j) legendre[q][j] = tables.force_legendre[q][j];
    }
  }
};

/// Compliances and stiffnesses in the plane: along g1, along n x g1, bending about n.
template <class Real>
struct PlanarSection {
  Vec2<Real> force_compliance;          ///< 1/EA, 1/GA: the residual
  Vec2<Real> tangent_force_compliance;  ///< of the capped stiffness: the tangent only
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

/// What follows from the ends: `element`, `vertex`, `reference`: Lambda_lo, Lambda_V and Lambda_0; displacements of the
/// vertices in the plane.
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

/// Gradient of the energy, as ElementGradient.
template <int K, class Real>
struct PlanarGradient {
  Vec2<Real> strain_error[K];
  Real moment_row[K + 1];
  Real angle[K];        ///< conjugate to the angle modes
  Vec2<Real> slope[K];  ///< conjugate to the slope modes, element frame
  Real end_moment[2];   ///< conjugate to the spins of the vertices
  Real largest_end_angle;
};

/// The rows of M, theory (17), which are linear in the plane.
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

/// Moments of M in the angle modes, theory (18) with O_ji of theory (32), and at the vertices.
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

/// Theory (16) to theory (18) in the plane.
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

/// Right-hand side given from outside, in place of the gradient of the state; rows of the angle modes, of the slope
/// modes from 1 on (element frame), of N and of M.
template <int K, class Real>
struct PlanarRightHandSide {
  Vec2<Real> strain_error[K];
  Real moment_row[K + 1];
  Real angle[K];
  Vec2<Real> slope[K];
};

/// slope_0 in the plane (two columns), spins of vertices a and b, constant part.
constexpr int kPlanarColumns = 5;

/// The reduced system of theory (32). Columns: G (2), H_a, H_b, r.
template <int K, class Real>
struct PlanarSystem {
  Real matrix[triangle_size(K)];  ///< H, lower triangle
  Real bending[K];                ///< what bending adds to its diagonal
  Real columns[K][kPlanarColumns];
  Real compliance[3];  ///< F: xx, xy, yy
  Vec2<Real> shift;    ///< z
};

/// Change of angle modes and of the force f for unit slope_0 (element frame), spins of the vertices, and the
/// constant part.
template <int K, class Real>
struct PlanarSolution {
  Real angle[K][kPlanarColumns];
  Real force[2][kPlanarColumns];
  Real end_moment[2][kPlanarColumns];
};

/// What one element needs of its points between building and recovery.
template <int K, class Real>
struct PlanarPoints {
  PlanarPoint<Real> point[K];
  Vec2<Real> given_force[K];  ///< N, or what is given in its place
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

/// Bending in theory (32) and the moment rows: constant but for EI/h.
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

/// One Gauss point of theory (32).
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
  // what the work of N + C R_N leaves when slopes and N are eliminated; own residual: -J g . N - l . N = -S J N . N
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

/// `rhs` null: the gradient of the state.
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

/// A pivot below this fraction of the bending stiffness in it loses too many digits without exchange of rows: the
/// geometric stiffness of a compressed element has cancelled it.
constexpr double kPlanarPivot = 1e-3;
/// The same for the determinant of the compliance of f, where stiffnesses that differ by the cap (1e5) leave a
/// ratio of their size.
constexpr double kPlanarCompliancePivot = 1e-9;

/// H = L D L^T without exchange of rows, then f. Returns the smallest ratio of pivots to their limits; below one
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

/// The same for one element with exchange of rows, angle modes and f together.
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

/// Rows of the interior increments and their order in the response of an element.
template <int K>
struct PlanarRows {
  static constexpr int kCount = 6 * K - 1;
  KOKKOS_FORCEINLINE_FUNCTION static constexpr int force(int q) { return 2 * q; }
  KOKKOS_FORCEINLINE_FUNCTION static constexpr int moment(int j) { return 2 * K + j; }
  KOKKOS_FORCEINLINE_FUNCTION static constexpr int angle(int j) { return 3 * K + 1 + j; }             ///< 0: the spin w
  KOKKOS_FORCEINLINE_FUNCTION static constexpr int bubble(int j) { return 4 * K + 1 + 2 * (j - 1); }  ///< in the plane
};

/// All increments of the interior from f and the angle modes, theory (31), and the moments on the vertices, in the
/// columns that the solution has.
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

/// Columns of slope_0 become those of u_b - u_a in the plane, (u_b - u_a)/h = Lambda_lo slope_0.
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
/// and planar_response(); `own_end_moment`: that of the state, null for a given right-hand side.
template <int K, class Real>
KOKKOS_FORCEINLINE_FUNCTION void planar_condensed(const PlanarState<K, Real>& state,
                                                  const PlanarSolution<K, Real>& solution, const Real* own_end_moment,
                                                  Real* tangent, Real* gradient) {
  // slope_0 = (u_b - u_a)/h: its row is h f, so that of u_b is f itself
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
