/// Rotations: exponential and logarithm, tangent map T, its inverse and their derivatives, unit quaternions: theory (1)
/// to theory (7). Angles in radians.
///
/// Every coefficient is a Stumpff function c_k of the squared angle. These and their derivatives are entire, so there
/// is no special case for small angles.
#pragma once

#include "kernels/execution/pack.hpp"
#include "kernels/math/small_algebra.hpp"

#include <cmath>

namespace mixbeam {

/// c_0 .. c_7 at one argument, theory (1).
template <class Scalar>
struct StumpffValues {
  Scalar c[8];
  KOKKOS_FORCEINLINE_FUNCTION const Scalar& operator[](int k) const { return c[k]; }
  /// d c_k / dx, k <= 5
  KOKKOS_FORCEINLINE_FUNCTION Scalar first_derivative(int k) const { return 0.5 * (k * c[k + 2] - c[k + 1]); }
  /// d^2 c_k / dx^2, k <= 3
  KOKKOS_FORCEINLINE_FUNCTION Scalar second_derivative(int k) const {
    return 0.25 * (k * (k + 2) * c[k + 4] - (2 * k + 1) * c[k + 3] + c[k + 2]);
  }
};

/// Above this squared angle (about pi^2) the closed forms lose less than a digit; below it 14 terms of the series of
/// c_6 and c_7 leave a relative truncation error under 1e-19 and the downward recurrence c_k = 1/k! - x c_{k+2} is
/// stable.
constexpr double kStumpffSeriesLimit = 10.0;

/// Coefficients (-1)^j k! / (2j + k)! of the series of k! c_k.
template <int K, int Terms>
struct StumpffSeries {
  double coefficient[Terms];
  constexpr StumpffSeries() : coefficient() {
    coefficient[0] = 1.0;
    for (int j = 1; j < Terms; ++j) coefficient[j] = -coefficient[j - 1] / ((2.0 * j + K - 1.0) * (2.0 * j + K));
  }
  template <class Scalar>
  KOKKOS_FORCEINLINE_FUNCTION Scalar operator()(const Scalar& x) const {
    Scalar sum = coefficient[Terms - 1];
    for (int j = Terms - 2; j >= 0; --j) sum = coefficient[j] + x * sum;
    return sum;
  }
};
constexpr double kInverseFactorial[8] = {1.0, 1.0, 1.0 / 2, 1.0 / 6, 1.0 / 24, 1.0 / 120, 1.0 / 720, 1.0 / 5040};

/// 0 <= x <= kStumpffSeriesLimit
template <class Scalar>
KOKKOS_FORCEINLINE_FUNCTION StumpffValues<Scalar> stumpff_series(const Scalar& x) {
  constexpr int terms = 14;
  constexpr StumpffSeries<6, terms> six;
  constexpr StumpffSeries<7, terms> seven;
  StumpffValues<Scalar> s;
  s.c[6] = kInverseFactorial[6] * six(x);
  s.c[7] = kInverseFactorial[7] * seven(x);
  s.c[5] = kInverseFactorial[5] - x * s.c[7];
  s.c[4] = kInverseFactorial[4] - x * s.c[6];
  s.c[3] = kInverseFactorial[3] - x * s.c[5];
  s.c[2] = kInverseFactorial[2] - x * s.c[4];
  s.c[1] = kInverseFactorial[1] - x * s.c[3];
  s.c[0] = kInverseFactorial[0] - x * s.c[2];
  return s;
}

/// x > kStumpffSeriesLimit
template <class Scalar>
KOKKOS_INLINE_FUNCTION StumpffValues<Scalar> stumpff_closed_form(const Scalar& x) {
  using std::cos;
  using std::sin;
  using std::sqrt;
  const Scalar angle = sqrt(x);
  StumpffValues<Scalar> s;
  s.c[0] = cos(angle);
  s.c[1] = sin(angle) / angle;
  for (int k = 2; k < 8; ++k) s.c[k] = (kInverseFactorial[k - 2] - s.c[k - 2]) / x;
  return s;
}

/// c_0 .. c_7 for x = |psi|^2 >= 0. Absolute error of each c_k below 1e-15 / k! up to the limit, and below 5e-16 (1 +
/// |psi|) / k! above it, where the rounding of x shifts the argument of cosine and sine.
template <class Scalar>
KOKKOS_INLINE_FUNCTION StumpffValues<Scalar> stumpff(const Scalar& x) {
  return x <= kStumpffSeriesLimit ? stumpff_series(x) : stumpff_closed_form(x);
}

/// Replaces the rare lanes beyond the limit one by one.
template <int W>
void replace_by_closed_form(const Pack<W>& x, StumpffValues<Pack<W>>& s) {
  for (int lane = 0; lane < W; ++lane) {
    if (x[lane] <= kStumpffSeriesLimit) continue;
    const StumpffValues<double> one = stumpff_closed_form(x[lane]);
    for (int k = 0; k < 8; ++k) s.c[k].set(lane, one.c[k]);
  }
}
template <int W>
KOKKOS_FORCEINLINE_FUNCTION StumpffValues<Pack<W>> stumpff(const Pack<W>& x) {
  StumpffValues<Pack<W>> s = stumpff_series(x);
  if (any<W>(x > kStumpffSeriesLimit)) {
    StumpffValues<Pack<W>> replaced = s;  // s itself never has its address taken and stays in registers
    replace_by_closed_form(x, replaced);
    s = replaced;
  }
  return s;
}

/// Unit quaternion (scalar first).
template <class Scalar>
struct Quaternion {
  Scalar w, x, y, z;
};

template <class S>
KOKKOS_FORCEINLINE_FUNCTION Quaternion<S> identity_quaternion() {
  return {S(1), S(0), S(0), S(0)};
}
/// Rotation b followed by rotation a (matrix product a b).
template <class S>
KOKKOS_FORCEINLINE_FUNCTION Quaternion<S> operator*(const Quaternion<S>& a, const Quaternion<S>& b) {
  return {a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z, a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
          a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x, a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w};
}
/// Inverse rotation.
template <class S>
KOKKOS_FORCEINLINE_FUNCTION Quaternion<S> conjugate(const Quaternion<S>& q) {
  return {q.w, -q.x, -q.y, -q.z};
}
template <class S>
KOKKOS_FORCEINLINE_FUNCTION Quaternion<S> normalized(const Quaternion<S>& q) {
  using std::sqrt;
  const S inverse = 1.0 / sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
  return {q.w * inverse, q.x * inverse, q.y * inverse, q.z * inverse};
}
/// Rotation matrix of a unit quaternion.
template <class S>
KOKKOS_FORCEINLINE_FUNCTION Mat3<S> rotation_matrix(const Quaternion<S>& q) {
  return {{{1.0 - 2.0 * (q.y * q.y + q.z * q.z), 2.0 * (q.x * q.y - q.w * q.z), 2.0 * (q.x * q.z + q.w * q.y)},
           {2.0 * (q.x * q.y + q.w * q.z), 1.0 - 2.0 * (q.x * q.x + q.z * q.z), 2.0 * (q.y * q.z - q.w * q.x)},
           {2.0 * (q.x * q.z - q.w * q.y), 2.0 * (q.y * q.z + q.w * q.x), 1.0 - 2.0 * (q.x * q.x + q.y * q.y)}}};
}
/// Unit quaternion of a rotation matrix with columns g1, g2, g3 (branch of the largest component: no cancellation).
template <class S>
KOKKOS_INLINE_FUNCTION Quaternion<S> quaternion_of(const Mat3<S>& m) {
  using std::sqrt;
  const S four_ww = 1.0 + m(0, 0) + m(1, 1) + m(2, 2), four_xx = 1.0 + m(0, 0) - m(1, 1) - m(2, 2);
  const S four_yy = 1.0 - m(0, 0) + m(1, 1) - m(2, 2), four_zz = 1.0 - m(0, 0) - m(1, 1) + m(2, 2);
  Quaternion<S> q;
  if (four_ww >= four_xx && four_ww >= four_yy && four_ww >= four_zz)
    q = {four_ww, m(2, 1) - m(1, 2), m(0, 2) - m(2, 0), m(1, 0) - m(0, 1)};
  else if (four_xx >= four_yy && four_xx >= four_zz)
    q = {m(2, 1) - m(1, 2), four_xx, m(1, 0) + m(0, 1), m(0, 2) + m(2, 0)};
  else if (four_yy >= four_zz)
    q = {m(0, 2) - m(2, 0), m(1, 0) + m(0, 1), four_yy, m(2, 1) + m(1, 2)};
  else
    q = {m(1, 0) - m(0, 1), m(0, 2) + m(2, 0), m(2, 1) + m(1, 2), four_zz};
  return normalized(q);
}

/// exp(hat psi) as a unit quaternion, any angle: theory (2).
template <class S>
KOKKOS_FORCEINLINE_FUNCTION Quaternion<S> exp_quaternion(const Vec3<S>& psi) {
  const StumpffValues<S> half = stumpff(S(0.25 * dot(psi, psi)));
  const S f = 0.5 * half[1];
  return normalized(Quaternion<S>{half[0], f * psi[0], f * psi[1], f * psi[2]});
}

/// Below this squared tangent of the half angle the logarithm uses eight terms of the arctan series (truncation error
/// below 1e-19).
constexpr double kLogSeriesLimit = 2.5e-3;

/// Half the angle over its sine, for a quaternion with scalar part w >= 0 and squared vector part nn: by series.
template <class S>
KOKKOS_FORCEINLINE_FUNCTION S log_factor_series(const S& nn, const S& w) {
  const S t = nn / (w * w);
  S sum = 1.0 / 15;
  sum = 1.0 / 13 - t * sum;
  sum = 1.0 / 11 - t * sum;
  sum = 1.0 / 9 - t * sum;
  sum = 1.0 / 7 - t * sum;
  sum = 1.0 / 5 - t * sum;
  sum = 1.0 / 3 - t * sum;
  sum = 1.0 - t * sum;
  return sum / w;
}
template <class S>
KOKKOS_INLINE_FUNCTION S log_factor_closed_form(const S& nn, const S& w) {
  using std::atan2;
  using std::sqrt;
  const S n = sqrt(nn);
  return atan2(n, w) / n;
}
template <class S>
KOKKOS_FORCEINLINE_FUNCTION S log_factor(const S& nn, const S& w) {
  return nn < kLogSeriesLimit * w * w ? log_factor_series(nn, w) : log_factor_closed_form(nn, w);
}
/// Uses the closed form lane by lane, only where a lane needs it.
template <int W>
KOKKOS_FORCEINLINE_FUNCTION Pack<W> log_factor(const Pack<W>& nn, const Pack<W>& w) {
  Pack<W> factor = log_factor_series(nn, w);
  const Pack<W> limit = kLogSeriesLimit * w * w;
  if (any<W>(nn >= limit))
    for (int lane = 0; lane < W; ++lane)
      if (nn[lane] >= limit[lane]) factor.set(lane, log_factor_closed_form(nn[lane], w[lane]));
  return factor;
}

/// Rotation vector of a unit quaternion, norm in [0, pi]: theory (5). The atan2 form is accurate at every angle, also
/// near pi, where acos of a trace loses half of the digits.
template <class S>
KOKKOS_INLINE_FUNCTION Vec3<S> log_quaternion(const Quaternion<S>& q) {
  const S sign = select(q.w < 0.0, S(-1.0), S(1.0));  // q and -q are the same rotation: take the shorter way
  const Vec3<S> v{{q.x, q.y, q.z}};
  const S factor = log_factor(dot(v, v), S(sign * q.w));  // (angle / 2) / |v|
  return S(2.0 * sign * factor) * v;
}

/// I + first hat(psi) + second hat(psi)^2, hat(psi)^2 = psi psi^T - |psi|^2 I. The diagonal sums two squares each:
/// |psi|^2 minus the third would cancel.
template <class S>
KOKKOS_FORCEINLINE_FUNCTION Mat3<S> rotation_series(const S& first, const S& second, const Vec3<S>& psi) {
  const Vec3<S> linear = first * psi, quadratic = second * psi;
  const S xx = psi[0] * quadratic[0], yy = psi[1] * quadratic[1], zz = psi[2] * quadratic[2];
  const S xy = psi[0] * quadratic[1], xz = psi[0] * quadratic[2], yz = psi[1] * quadratic[2];
  return {{{1.0 - (yy + zz), xy - linear[2], xz + linear[1]},
           {xy + linear[2], 1.0 - (xx + zz), yz - linear[0]},
           {xz - linear[1], yz + linear[0], 1.0 - (xx + yy)}}};
}

/// exp(hat psi) as a matrix from values of the Stumpff functions at |psi|^2: theory (2).
template <class S>
KOKKOS_FORCEINLINE_FUNCTION Mat3<S> exp_matrix(const Vec3<S>& psi, const StumpffValues<S>& c) {
  return rotation_series(c[1], c[2], psi);
}
template <class S>
KOKKOS_FORCEINLINE_FUNCTION Mat3<S> exp_matrix(const Vec3<S>& psi) {
  return exp_matrix(psi, stumpff(dot(psi, psi)));
}

/// T(psi), theory (3): spatial spin of an additive change of the rotation vector; the material spin is T(psi)^T dpsi.
template <class S>
KOKKOS_FORCEINLINE_FUNCTION Mat3<S> tangent_map(const Vec3<S>& psi, const StumpffValues<S>& c) {
  return rotation_series(c[2], c[3], psi);
}
template <class S>
KOKKOS_FORCEINLINE_FUNCTION Mat3<S> tangent_map(const Vec3<S>& psi) {
  return tangent_map(psi, stumpff(dot(psi, psi)));
}

/// Returns slope psi^T - linear hat(a) - quadratic (hat(psi x a) + hat(psi) hat(a)); the last bracket is 2 a psi^T -
/// psi a^T - (psi . a) I.
template <class S>
KOKKOS_FORCEINLINE_FUNCTION Mat3<S> rotation_series_derivative(const Vec3<S>& slope, const S& linear,
                                                               const S& quadratic, const Vec3<S>& psi,
                                                               const Vec3<S>& a) {
  const Vec3<S> before_psi = slope - S(2.0 * quadratic) * a, before_a = quadratic * psi, turn = linear * a;
  const S isotropic = dot(before_a, a);
  const auto entry = [&](int i, int j) { return S(before_psi[i] * psi[j] + before_a[i] * a[j]); };
  return {{{entry(0, 0) + isotropic, entry(0, 1) + turn[2], entry(0, 2) - turn[1]},
           {entry(1, 0) - turn[2], entry(1, 1) + isotropic, entry(1, 2) + turn[0]},
           {entry(2, 0) + turn[1], entry(2, 1) - turn[0], entry(2, 2) + isotropic}}};
}

/// d(T(psi) a)/dpsi for a constant vector a: theory (6).
template <class S>
KOKKOS_FORCEINLINE_FUNCTION Mat3<S> tangent_map_derivative(const Vec3<S>& psi, const Vec3<S>& a,
                                                           const StumpffValues<S>& c) {
  const Vec3<S> pa = cross(psi, a);
  const Vec3<S> slope = S(2.0 * c.first_derivative(2)) * pa + S(2.0 * c.first_derivative(3)) * cross(psi, pa);
  return rotation_series_derivative(slope, c[2], c[3], psi, a);
}

/// Coefficient d of the inverse tangent map, theory (4), and its derivative with respect to |phi|^2. Stumpff functions
/// of (|phi|/2)^2 replace the cotangent: no cancellation at 0, regular at pi.
template <class S>
struct InverseTangentCoefficient {
  S value, derivative;
};
template <class S>
KOKKOS_FORCEINLINE_FUNCTION InverseTangentCoefficient<S> inverse_tangent_coefficient(const S& squared_angle) {
  const StumpffValues<S> half = stumpff(S(0.25 * squared_angle));
  const S value = (half[2] - half[3]) / (4.0 * half[1]);
  const S numerator_slope = half.first_derivative(2) - half.first_derivative(3);
  const S derivative = 0.25 * (numerator_slope - 4.0 * value * half.first_derivative(1)) / (4.0 * half[1]);
  return {value, derivative};
}

/// T^-1(phi), |phi| < 2 pi: theory (4).
template <class S>
KOKKOS_FORCEINLINE_FUNCTION Mat3<S> inverse_tangent_map(const Vec3<S>& phi, const InverseTangentCoefficient<S>& d) {
  return rotation_series(S(-0.5), d.value, phi);
}
template <class S>
KOKKOS_FORCEINLINE_FUNCTION Mat3<S> inverse_tangent_map(const Vec3<S>& phi) {
  return inverse_tangent_map(phi, inverse_tangent_coefficient(dot(phi, phi)));
}

/// d(T^-T(phi) a)/dphi for a constant vector a: theory (6).
template <class S>
KOKKOS_FORCEINLINE_FUNCTION Mat3<S> inverse_tangent_transpose_derivative(const Vec3<S>& phi, const Vec3<S>& a,
                                                                         const InverseTangentCoefficient<S>& d) {
  const Vec3<S> pa = cross(phi, a);
  return rotation_series_derivative(S(2.0 * d.derivative) * cross(phi, pa), S(0.5), d.value, phi, a);
}

/// Gradient and Hessian of the scalar a . F(psi) b of theory (7) with respect to psi, F = exp(-hat psi) (first = 1) or
/// T(psi)^T (first = 2).
template <class S>
KOKKOS_FORCEINLINE_FUNCTION Vec3<S> rotation_form_gradient(int first, const Vec3<S>& a, const Vec3<S>& b,
                                                           const Vec3<S>& psi, const StumpffValues<S>& c) {
  const Vec3<S> q = cross(a, b);
  const S ab = dot(a, b), ap = dot(a, psi), bp = dot(b, psi), xx = dot(psi, psi);
  const Vec3<S> s_psi = (0.5 * bp) * a + (0.5 * ap) * b - ab * psi;
  const S quadratic = ap * bp - ab * xx;
  const S along = 2.0 * (c.first_derivative(first) * dot(q, psi) + c.first_derivative(first + 1) * quadratic);
  return along * psi + c[first] * q + (2.0 * c[first + 1]) * s_psi;
}
template <class S>
KOKKOS_FORCEINLINE_FUNCTION Mat3<S> rotation_form_hessian(int first, const Vec3<S>& a, const Vec3<S>& b,
                                                          const Vec3<S>& psi, const StumpffValues<S>& c) {
  const Vec3<S> q = cross(a, b);
  const S ab = dot(a, b), ap = dot(a, psi), bp = dot(b, psi), xx = dot(psi, psi), qp = dot(q, psi);
  const Vec3<S> s_psi = (0.5 * bp) * a + (0.5 * ap) * b - ab * psi;
  const S quadratic = ap * bp - ab * xx;
  const S f1 = c.first_derivative(first), g1 = c.first_derivative(first + 1);
  const S along = 4.0 * (c.second_derivative(first) * qp + c.second_derivative(first + 1) * quadratic);
  const S isotropic = 2.0 * (f1 * qp + g1 * quadratic) - 2.0 * c[first + 1] * ab;
  // every product pairs a vector with a or psi, symmetrised
  const Vec3<S> beside_psi = (0.5 * along) * psi + (2.0 * f1) * q + (4.0 * g1) * s_psi, beside_a = c[first + 1] * b;
  const auto entry = [&](int i, int j) {
    return S(psi[i] * beside_psi[j] + beside_psi[i] * psi[j] + a[i] * beside_a[j] + beside_a[i] * a[j]);
  };
  const S h10 = entry(1, 0), h20 = entry(2, 0), h21 = entry(2, 1);
  return {
      {{entry(0, 0) + isotropic, h10, h20}, {h10, entry(1, 1) + isotropic, h21}, {h20, h21, entry(2, 2) + isotropic}}};
}

}  // namespace mixbeam
