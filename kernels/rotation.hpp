/// Rotations: exponential and logarithm, tangent map T (left Jacobian: dtheta = T(psi) dpsi, paper eq. (tangent map)),
/// its inverse and their derivatives, unit quaternions. Angles in radians.
///
/// Every coefficient is one of the Stumpff functions  c_k(x) = sum_j (-x)^j / (2j + k)!,  x = |psi|^2:
///   exp(hat psi) = I + c_1 hat(psi) + c_2 hat(psi)^2,     T(psi) = I + c_2 hat(psi) + c_3 hat(psi)^2.
/// They are entire functions of the squared angle, so no small-angle special case exists, and their derivatives with
/// respect to x are again combinations of them:  c_k' = (k c_{k+2} - c_{k+1}) / 2.
#pragma once

#include "kernels/small_algebra.hpp"

#include <cmath>

namespace mixbeam {

/// c_0 .. c_7 at one argument.
template <class Scalar>
struct StumpffValues {
  Scalar c[8];
  KOKKOS_INLINE_FUNCTION const Scalar& operator[](int k) const { return c[k]; }
  /// d c_k / dx, k <= 5
  KOKKOS_INLINE_FUNCTION Scalar first_derivative(int k) const { return 0.5 * (k * c[k + 2] - c[k + 1]); }
  /// d^2 c_k / dx^2, k <= 3
  KOKKOS_INLINE_FUNCTION Scalar second_derivative(int k) const {
    return 0.25 * (k * (k + 2) * c[k + 4] - (2 * k + 1) * c[k + 3] + c[k + 2]);
  }
};

/// Above this squared angle (about pi^2) the closed forms lose less than a digit; below it 14 terms of the series of
/// c_6 and c_7 leave a relative truncation error under 1e-19 and the downward recurrence c_k = 1/k! - x c_{k+2} is
/// stable.
constexpr double kStumpffSeriesLimit = 10.0;

/// c_0 .. c_7 for x = |psi|^2 >= 0; absolute error of each c_k below 1e-15 / k! up to the limit, above it below
/// 5e-16 (1 + |psi|) / k!, because the rounding of x turns cosine and sine.
template <class Scalar>
KOKKOS_INLINE_FUNCTION StumpffValues<Scalar> stumpff(const Scalar& x) {
  constexpr double inverse_factorial[8] = {1.0, 1.0, 1.0 / 2, 1.0 / 6, 1.0 / 24, 1.0 / 120, 1.0 / 720, 1.0 / 5040};
  StumpffValues<Scalar> s;
  if (x <= kStumpffSeriesLimit) {
    constexpr int terms = 14;
    Scalar c6 = 1.0, c7 = 1.0;
    for (int j = terms - 1; j > 0; --j) {  // nested form of sum (-x)^j k!/(2j+k)!
      c6 = 1.0 - x * c6 * (1.0 / ((2.0 * j + 5.0) * (2.0 * j + 6.0)));
      c7 = 1.0 - x * c7 * (1.0 / ((2.0 * j + 6.0) * (2.0 * j + 7.0)));
    }
    s.c[6] = inverse_factorial[6] * c6;
    s.c[7] = inverse_factorial[7] * c7;
    for (int k = 5; k >= 0; --k) s.c[k] = inverse_factorial[k] - x * s.c[k + 2];
  } else {
    using std::cos;
    using std::sin;
    using std::sqrt;
    const Scalar angle = sqrt(x);
    s.c[0] = cos(angle);
    s.c[1] = sin(angle) / angle;
    for (int k = 2; k < 8; ++k) s.c[k] = (inverse_factorial[k - 2] - s.c[k - 2]) / x;
  }
  return s;
}

/// Unit quaternion (scalar first).
template <class Scalar>
struct Quaternion {
  Scalar w, x, y, z;
};

template <class S>
KOKKOS_INLINE_FUNCTION Quaternion<S> identity_quaternion() {
  return {S(1), S(0), S(0), S(0)};
}
/// Rotation b followed by rotation a (matrix product a b).
template <class S>
KOKKOS_INLINE_FUNCTION Quaternion<S> operator*(const Quaternion<S>& a, const Quaternion<S>& b) {
  return {a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z, a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
          a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x, a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w};
}
/// Inverse rotation.
template <class S>
KOKKOS_INLINE_FUNCTION Quaternion<S> conjugate(const Quaternion<S>& q) {
  return {q.w, -q.x, -q.y, -q.z};
}
template <class S>
KOKKOS_INLINE_FUNCTION Quaternion<S> normalized(const Quaternion<S>& q) {
  using std::sqrt;
  const S inverse = 1.0 / sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
  return {q.w * inverse, q.x * inverse, q.y * inverse, q.z * inverse};
}
/// Rotation matrix of a unit quaternion.
template <class S>
KOKKOS_INLINE_FUNCTION Mat3<S> rotation_matrix(const Quaternion<S>& q) {
  return {{{1.0 - 2.0 * (q.y * q.y + q.z * q.z), 2.0 * (q.x * q.y - q.w * q.z), 2.0 * (q.x * q.z + q.w * q.y)},
           {2.0 * (q.x * q.y + q.w * q.z), 1.0 - 2.0 * (q.x * q.x + q.z * q.z), 2.0 * (q.y * q.z - q.w * q.x)},
           {2.0 * (q.x * q.z - q.w * q.y), 2.0 * (q.y * q.z + q.w * q.x), 1.0 - 2.0 * (q.x * q.x + q.y * q.y)}}};
}
/// Unit quaternion of a rotation matrix with columns g1, g2, g3 (largest-component branch: no loss of digits anywhere).
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

/// exp(hat psi) as a unit quaternion, any angle.
template <class S>
KOKKOS_INLINE_FUNCTION Quaternion<S> exp_quaternion(const Vec3<S>& psi) {
  const StumpffValues<S> half = stumpff(S(0.25 * dot(psi, psi)));
  const S f = 0.5 * half[1];
  return normalized(Quaternion<S>{half[0], f * psi[0], f * psi[1], f * psi[2]});
}

/// Below this squared tangent of the half angle the logarithm uses eight terms of arctan's series (truncation under
/// 1e-19).
constexpr double kLogSeriesLimit = 2.5e-3;

/// Rotation vector of a unit quaternion, norm in [0, pi] (the paper's angle symbol). atan2 form: full accuracy at every
/// angle, also next to pi, where acos of a trace loses half of the digits.
template <class S>
KOKKOS_INLINE_FUNCTION Vec3<S> log_quaternion(const Quaternion<S>& q) {
  using std::atan2;
  using std::sqrt;
  const S sign = q.w < 0.0 ? S(-1.0) : S(1.0);  // q and -q are the same rotation: take the shorter way
  const S w = sign * q.w;
  const Vec3<S> v{{sign * q.x, sign * q.y, sign * q.z}};
  const S nn = dot(v, v);
  S factor;  // (angle / 2) / |v|
  if (nn < kLogSeriesLimit * w * w) {
    const S t = nn / (w * w);
    S sum = 1.0 / 15;
    for (int j = 6; j >= 0; --j) sum = 1.0 / (2 * j + 1) - t * sum;
    factor = sum / w;
  } else {
    const S n = sqrt(nn);
    factor = atan2(n, w) / n;
  }
  return S(2.0 * factor) * v;
}

/// exp(hat psi) as a matrix from values of the Stumpff functions at |psi|^2 (Rodrigues' formula).
template <class S>
KOKKOS_INLINE_FUNCTION Mat3<S> exp_matrix(const Vec3<S>& psi, const StumpffValues<S>& c) {
  const Mat3<S> h = hat(psi);
  return identity_matrix<S>() + c[1] * h + c[2] * (h * h);
}
template <class S>
KOKKOS_INLINE_FUNCTION Mat3<S> exp_matrix(const Vec3<S>& psi) {
  return exp_matrix(psi, stumpff(dot(psi, psi)));
}

/// T(psi): spatial spin of an additive change of the rotation vector, dtheta = T(psi) dpsi; the material spin is
/// T(psi)^T dpsi.
template <class S>
KOKKOS_INLINE_FUNCTION Mat3<S> tangent_map(const Vec3<S>& psi, const StumpffValues<S>& c) {
  const Mat3<S> h = hat(psi);
  return identity_matrix<S>() + c[2] * h + c[3] * (h * h);
}
template <class S>
KOKKOS_INLINE_FUNCTION Mat3<S> tangent_map(const Vec3<S>& psi) {
  return tangent_map(psi, stumpff(dot(psi, psi)));
}

/// d(T(psi) a)/dpsi for a constant vector a.
template <class S>
KOKKOS_INLINE_FUNCTION Mat3<S> tangent_map_derivative(const Vec3<S>& psi, const Vec3<S>& a, const StumpffValues<S>& c) {
  const Vec3<S> pa = cross(psi, a);
  const Vec3<S> slope = (2.0 * c.first_derivative(2)) * pa + (2.0 * c.first_derivative(3)) * cross(psi, pa);
  return outer(slope, psi) - c[2] * hat(a) - c[3] * (hat(pa) + hat(psi) * hat(a));
}

/// Coefficient of the inverse tangent map, T^-1 = I - hat(phi)/2 + d hat(phi)^2, and its derivative with respect to
/// |phi|^2. d = (1 - (|phi|/2) cot(|phi|/2)) / |phi|^2 written with Stumpff functions of (|phi|/2)^2: no cancellation
/// at 0, regular at pi.
template <class S>
struct InverseTangentCoefficient {
  S value, derivative;
};
template <class S>
KOKKOS_INLINE_FUNCTION InverseTangentCoefficient<S> inverse_tangent_coefficient(const S& squared_angle) {
  const StumpffValues<S> half = stumpff(S(0.25 * squared_angle));
  const S value = (half[2] - half[3]) / (4.0 * half[1]);
  const S numerator_slope = half.first_derivative(2) - half.first_derivative(3);
  const S derivative = 0.25 * (numerator_slope - 4.0 * value * half.first_derivative(1)) / (4.0 * half[1]);
  return {value, derivative};
}

/// T^-1(phi), |phi| < 2 pi.
template <class S>
KOKKOS_INLINE_FUNCTION Mat3<S> inverse_tangent_map(const Vec3<S>& phi, const InverseTangentCoefficient<S>& d) {
  const Mat3<S> h = hat(phi);
  return identity_matrix<S>() - 0.5 * h + d.value * (h * h);
}
template <class S>
KOKKOS_INLINE_FUNCTION Mat3<S> inverse_tangent_map(const Vec3<S>& phi) {
  return inverse_tangent_map(phi, inverse_tangent_coefficient(dot(phi, phi)));
}

/// d(T^-T(phi) a)/dphi for a constant vector a.
template <class S>
KOKKOS_INLINE_FUNCTION Mat3<S> inverse_tangent_transpose_derivative(const Vec3<S>& phi, const Vec3<S>& a,
                                                                    const InverseTangentCoefficient<S>& d) {
  const Vec3<S> pa = cross(phi, a);
  return outer((2.0 * d.derivative) * cross(phi, pa), phi) - 0.5 * hat(a) - d.value * (hat(pa) + hat(phi) * hat(a));
}

/// Value-free derivatives of the scalar  a^T F(psi) b  with respect to psi, where F is exp(-hat psi) (first = 1) or
/// T(psi)^T (first = 2). Both are  a.b + c_first q.psi + c_{first+1} psi.S psi  with q = a x b, S = sym(a b^T) - (a.b)
/// I.
template <class S>
KOKKOS_INLINE_FUNCTION Vec3<S> rotation_form_gradient(int first, const Vec3<S>& a, const Vec3<S>& b, const Vec3<S>& psi,
                                                      const StumpffValues<S>& c) {
  const Vec3<S> q = cross(a, b);
  const S ab = dot(a, b), ap = dot(a, psi), bp = dot(b, psi), xx = dot(psi, psi);
  const Vec3<S> s_psi = (0.5 * bp) * a + (0.5 * ap) * b - ab * psi;
  const S quadratic = ap * bp - ab * xx;
  const S along = 2.0 * (c.first_derivative(first) * dot(q, psi) + c.first_derivative(first + 1) * quadratic);
  return along * psi + c[first] * q + (2.0 * c[first + 1]) * s_psi;
}
template <class S>
KOKKOS_INLINE_FUNCTION Mat3<S> rotation_form_hessian(int first, const Vec3<S>& a, const Vec3<S>& b, const Vec3<S>& psi,
                                                     const StumpffValues<S>& c) {
  const Vec3<S> q = cross(a, b);
  const S ab = dot(a, b), ap = dot(a, psi), bp = dot(b, psi), xx = dot(psi, psi), qp = dot(q, psi);
  const Vec3<S> s_psi = (0.5 * bp) * a + (0.5 * ap) * b - ab * psi;
  const S quadratic = ap * bp - ab * xx;
  const S f1 = c.first_derivative(first), g1 = c.first_derivative(first + 1);
  const S along = 4.0 * (c.second_derivative(first) * qp + c.second_derivative(first + 1) * quadratic);
  const S isotropic = 2.0 * (f1 * qp + g1 * quadratic) - 2.0 * c[first + 1] * ab;
  Mat3<S> h;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j)
      h(i, j) = along * psi[i] * psi[j] + 2.0 * f1 * (psi[i] * q[j] + q[i] * psi[j]) +
                4.0 * g1 * (psi[i] * s_psi[j] + s_psi[i] * psi[j]) + c[first + 1] * (a[i] * b[j] + b[i] * a[j]);
    h(i, i) += isotropic;
  }
  return h;
}

}  // namespace mixbeam
