/// Vectors and rotations in a plane: rotations commute and reduce to one angle.
#pragma once

#include "kernels/math/constants.hpp"
#include "kernels/math/rotation.hpp"

#include <cmath>

namespace mixbeam {

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
/// J a: a rotation by 90 degrees.
template <class Real>
KOKKOS_FORCEINLINE_FUNCTION Vec2<Real> quarter_turn(const Vec2<Real>& a) {
  return {-a.y, a.x};
}
/// diag(d) a
template <class Real>
KOKKOS_FORCEINLINE_FUNCTION Vec2<Real> scaled_by(const Vec2<Real>& d, const Vec2<Real>& a) {
  return {d.x * a.x, d.y * a.y};
}

/// Rotation in the plane: cosine and sine of its angle, optionally scaled by a factor.
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
/// Evaluates the rare lanes beyond the series one by one.
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

/// Unit quaternion w + z n: cosine and sine of half the angle about n. Products are those of complex numbers.
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

/// Angle for |z/w| below the root of kLogSeriesLimit (rotation.hpp): eight terms of the arctan series.
template <class Real>
KOKKOS_FORCEINLINE_FUNCTION Real angle_by_series(const PlaneRotor<Real>& a) {
  const Real tangent = a.z / a.w, t = tangent * tangent;
  Real sum = 1.0 / 15;
#pragma GCC unroll 8
  for (int j = 6; j >= 0; --j) sum = 1.0 / (2 * j + 1) - t * sum;
  return 2.0 * (tangent * sum);
}
/// Angle of a rotor in [-pi, pi], with full accuracy up to the ends.
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

/// Angle mapped to [-pi, pi], for |angle| < 3 pi.
template <class Real>
KOKKOS_FORCEINLINE_FUNCTION Real shorter_way(const Real& angle) {
  return angle - select(angle > Real(kPi), Real(2.0 * kPi), Real(0.0)) +
         select(angle < Real(-kPi), Real(2.0 * kPi), Real(0.0));
}

}  // namespace mixbeam
