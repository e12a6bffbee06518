/// Vectors and matrices of three components, templated on the scalar for automatic differentiation and packs. Written
/// out without loops and always inlined: components stay in registers only if every index is a constant before the
/// optimiser splits structures into their members.
#pragma once

#include <Kokkos_Core.hpp>

namespace mixbeam {

template <class Scalar>
struct Vec3 {
  Scalar x[3];
  KOKKOS_FORCEINLINE_FUNCTION Scalar& operator[](int i) { return x[i]; }
  KOKKOS_FORCEINLINE_FUNCTION const Scalar& operator[](int i) const { return x[i]; }
};

/// Row-major 3 x 3 matrix.
template <class Scalar>
struct Mat3 {
  Scalar a[3][3];
  KOKKOS_FORCEINLINE_FUNCTION Scalar& operator()(int i, int j) { return a[i][j]; }
  KOKKOS_FORCEINLINE_FUNCTION const Scalar& operator()(int i, int j) const { return a[i][j]; }
};

template <class S>
KOKKOS_FORCEINLINE_FUNCTION Vec3<S> operator+(const Vec3<S>& a, const Vec3<S>& b) {
  return {{a[0] + b[0], a[1] + b[1], a[2] + b[2]}};
}
template <class S>
KOKKOS_FORCEINLINE_FUNCTION Vec3<S> operator-(const Vec3<S>& a, const Vec3<S>& b) {
  return {{a[0] - b[0], a[1] - b[1], a[2] - b[2]}};
}
template <class S>
KOKKOS_FORCEINLINE_FUNCTION Vec3<S> operator-(const Vec3<S>& a) {
  return {{-a[0], -a[1], -a[2]}};
}
template <class S, class T>
KOKKOS_FORCEINLINE_FUNCTION Vec3<S> operator*(const T& f, const Vec3<S>& a) {
  return {{S(f * a[0]), S(f * a[1]), S(f * a[2])}};
}
template <class S>
KOKKOS_FORCEINLINE_FUNCTION Vec3<S>& operator+=(Vec3<S>& a, const Vec3<S>& b) {
  a[0] += b[0];
  a[1] += b[1];
  a[2] += b[2];
  return a;
}
template <class S>
KOKKOS_FORCEINLINE_FUNCTION S dot(const Vec3<S>& a, const Vec3<S>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
template <class S>
KOKKOS_FORCEINLINE_FUNCTION Vec3<S> cross(const Vec3<S>& a, const Vec3<S>& b) {
  return {{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]}};
}

template <class S>
KOKKOS_FORCEINLINE_FUNCTION Mat3<S> zero_matrix() {
  return {{{S(0), S(0), S(0)}, {S(0), S(0), S(0)}, {S(0), S(0), S(0)}}};
}
template <class S>
KOKKOS_FORCEINLINE_FUNCTION Mat3<S> identity_matrix() {
  return {{{S(1), S(0), S(0)}, {S(0), S(1), S(0)}, {S(0), S(0), S(1)}}};
}
/// hat(a) with hat(a) b = a x b.
template <class S>
KOKKOS_FORCEINLINE_FUNCTION Mat3<S> hat(const Vec3<S>& a) {
  return {{{S(0), -a[2], a[1]}, {a[2], S(0), -a[0]}, {-a[1], a[0], S(0)}}};
}
/// m hat(a), without the zeros of hat(a).
template <class S>
KOKKOS_FORCEINLINE_FUNCTION Mat3<S> times_hat(const Mat3<S>& m, const Vec3<S>& a) {
  return {{{m(0, 1) * a[2] - m(0, 2) * a[1], m(0, 2) * a[0] - m(0, 0) * a[2], m(0, 0) * a[1] - m(0, 1) * a[0]},
           {m(1, 1) * a[2] - m(1, 2) * a[1], m(1, 2) * a[0] - m(1, 0) * a[2], m(1, 0) * a[1] - m(1, 1) * a[0]},
           {m(2, 1) * a[2] - m(2, 2) * a[1], m(2, 2) * a[0] - m(2, 0) * a[2], m(2, 0) * a[1] - m(2, 1) * a[0]}}};
}
/// hat(a)^T m = - hat(a) m
template <class S>
KOKKOS_FORCEINLINE_FUNCTION Mat3<S> hat_transpose_times(const Vec3<S>& a, const Mat3<S>& m) {
  return {{{a[2] * m(1, 0) - a[1] * m(2, 0), a[2] * m(1, 1) - a[1] * m(2, 1), a[2] * m(1, 2) - a[1] * m(2, 2)},
           {a[0] * m(2, 0) - a[2] * m(0, 0), a[0] * m(2, 1) - a[2] * m(0, 1), a[0] * m(2, 2) - a[2] * m(0, 2)},
           {a[1] * m(0, 0) - a[0] * m(1, 0), a[1] * m(0, 1) - a[0] * m(1, 1), a[1] * m(0, 2) - a[0] * m(1, 2)}}};
}
/// a b^T
template <class S>
KOKKOS_FORCEINLINE_FUNCTION Mat3<S> outer(const Vec3<S>& a, const Vec3<S>& b) {
  return {{{a[0] * b[0], a[0] * b[1], a[0] * b[2]},
           {a[1] * b[0], a[1] * b[1], a[1] * b[2]},
           {a[2] * b[0], a[2] * b[1], a[2] * b[2]}}};
}
template <class S>
KOKKOS_FORCEINLINE_FUNCTION Mat3<S> transpose(const Mat3<S>& m) {
  return {{{m(0, 0), m(1, 0), m(2, 0)}, {m(0, 1), m(1, 1), m(2, 1)}, {m(0, 2), m(1, 2), m(2, 2)}}};
}
template <class S>
KOKKOS_FORCEINLINE_FUNCTION Mat3<S> operator+(const Mat3<S>& a, const Mat3<S>& b) {
  return {{{a(0, 0) + b(0, 0), a(0, 1) + b(0, 1), a(0, 2) + b(0, 2)},
           {a(1, 0) + b(1, 0), a(1, 1) + b(1, 1), a(1, 2) + b(1, 2)},
           {a(2, 0) + b(2, 0), a(2, 1) + b(2, 1), a(2, 2) + b(2, 2)}}};
}
template <class S>
KOKKOS_FORCEINLINE_FUNCTION Mat3<S> operator-(const Mat3<S>& a, const Mat3<S>& b) {
  return {{{a(0, 0) - b(0, 0), a(0, 1) - b(0, 1), a(0, 2) - b(0, 2)},
           {a(1, 0) - b(1, 0), a(1, 1) - b(1, 1), a(1, 2) - b(1, 2)},
           {a(2, 0) - b(2, 0), a(2, 1) - b(2, 1), a(2, 2) - b(2, 2)}}};
}
template <class S, class T>
KOKKOS_FORCEINLINE_FUNCTION Mat3<S> operator*(const T& f, const Mat3<S>& a) {
  return {{{S(f * a(0, 0)), S(f * a(0, 1)), S(f * a(0, 2))},
           {S(f * a(1, 0)), S(f * a(1, 1)), S(f * a(1, 2))},
           {S(f * a(2, 0)), S(f * a(2, 1)), S(f * a(2, 2))}}};
}
template <class S>
KOKKOS_FORCEINLINE_FUNCTION Mat3<S>& operator+=(Mat3<S>& a, const Mat3<S>& b) {
  return a = a + b;
}
template <class S>
KOKKOS_FORCEINLINE_FUNCTION Vec3<S> operator*(const Mat3<S>& m, const Vec3<S>& v) {
  return {{m(0, 0) * v[0] + m(0, 1) * v[1] + m(0, 2) * v[2], m(1, 0) * v[0] + m(1, 1) * v[1] + m(1, 2) * v[2],
           m(2, 0) * v[0] + m(2, 1) * v[1] + m(2, 2) * v[2]}};
}
template <class S>
KOKKOS_FORCEINLINE_FUNCTION S product_entry(const Mat3<S>& a, const Mat3<S>& b, int i, int j) {
  return a(i, 0) * b(0, j) + a(i, 1) * b(1, j) + a(i, 2) * b(2, j);
}
template <class S>
KOKKOS_FORCEINLINE_FUNCTION Mat3<S> operator*(const Mat3<S>& a, const Mat3<S>& b) {
  return {{{product_entry(a, b, 0, 0), product_entry(a, b, 0, 1), product_entry(a, b, 0, 2)},
           {product_entry(a, b, 1, 0), product_entry(a, b, 1, 1), product_entry(a, b, 1, 2)},
           {product_entry(a, b, 2, 0), product_entry(a, b, 2, 1), product_entry(a, b, 2, 2)}}};
}
/// m^T v
template <class S>
KOKKOS_FORCEINLINE_FUNCTION Vec3<S> transpose_times(const Mat3<S>& m, const Vec3<S>& v) {
  return {{m(0, 0) * v[0] + m(1, 0) * v[1] + m(2, 0) * v[2], m(0, 1) * v[0] + m(1, 1) * v[1] + m(2, 1) * v[2],
           m(0, 2) * v[0] + m(1, 2) * v[1] + m(2, 2) * v[2]}};
}
/// a b^T for matrices.
template <class S>
KOKKOS_FORCEINLINE_FUNCTION Mat3<S> times_transpose(const Mat3<S>& a, const Mat3<S>& b) {
  return a * transpose(b);
}
/// a b^T if it is symmetric.
template <class S>
KOKKOS_FORCEINLINE_FUNCTION Mat3<S> symmetric_times_transpose(const Mat3<S>& a, const Mat3<S>& b) {
  const Mat3<S> t = transpose(b);
  const S s10 = product_entry(a, t, 1, 0), s20 = product_entry(a, t, 2, 0), s21 = product_entry(a, t, 2, 1);
  return {{{product_entry(a, t, 0, 0), s10, s20},
           {s10, product_entry(a, t, 1, 1), s21},
           {s20, s21, product_entry(a, t, 2, 2)}}};
}
template <class S>
KOKKOS_FORCEINLINE_FUNCTION Mat3<S> symmetric_part(const Mat3<S>& m) {
  const S s10 = 0.5 * (m(1, 0) + m(0, 1)), s20 = 0.5 * (m(2, 0) + m(0, 2)), s21 = 0.5 * (m(2, 1) + m(1, 2));
  return {{{m(0, 0), s10, s20}, {s10, m(1, 1), s21}, {s20, s21, m(2, 2)}}};
}
template <class S>
KOKKOS_FORCEINLINE_FUNCTION S norm(const Vec3<S>& a) {
  using std::sqrt;
  return sqrt(dot(a, a));
}

/// Extracts one lane of vectors and matrices of packs.
template <class Real>
KOKKOS_INLINE_FUNCTION Vec3<double> in_lane(const Vec3<Real>& v, int lane) {
  return {{v[0][lane], v[1][lane], v[2][lane]}};
}
template <class Real>
KOKKOS_INLINE_FUNCTION Mat3<double> in_lane(const Mat3<Real>& m, int lane) {
  Mat3<double> one;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) one(i, j) = m(i, j)[lane];
  return one;
}

}  // namespace mixbeam
