/// Vectors and matrices of three components, templated on the scalar so that automatic differentiation can run through
/// them.
#pragma once

#include <Kokkos_Core.hpp>

namespace mixbeam {

template <class Scalar>
struct Vec3 {
  Scalar x[3];
  KOKKOS_INLINE_FUNCTION Scalar& operator[](int i) { return x[i]; }
  KOKKOS_INLINE_FUNCTION const Scalar& operator[](int i) const { return x[i]; }
};

/// Row-major 3 x 3 matrix.
template <class Scalar>
struct Mat3 {
  Scalar a[3][3];
  KOKKOS_INLINE_FUNCTION Scalar& operator()(int i, int j) { return a[i][j]; }
  KOKKOS_INLINE_FUNCTION const Scalar& operator()(int i, int j) const { return a[i][j]; }
};

template <class S>
KOKKOS_INLINE_FUNCTION Vec3<S> operator+(const Vec3<S>& a, const Vec3<S>& b) {
  return {{a[0] + b[0], a[1] + b[1], a[2] + b[2]}};
}
template <class S>
KOKKOS_INLINE_FUNCTION Vec3<S> operator-(const Vec3<S>& a, const Vec3<S>& b) {
  return {{a[0] - b[0], a[1] - b[1], a[2] - b[2]}};
}
template <class S>
KOKKOS_INLINE_FUNCTION Vec3<S> operator-(const Vec3<S>& a) {
  return {{-a[0], -a[1], -a[2]}};
}
template <class S, class T>
KOKKOS_INLINE_FUNCTION Vec3<S> operator*(const T& f, const Vec3<S>& a) {
  return {{S(f * a[0]), S(f * a[1]), S(f * a[2])}};
}
template <class S>
KOKKOS_INLINE_FUNCTION Vec3<S>& operator+=(Vec3<S>& a, const Vec3<S>& b) {
  for (int i = 0; i < 3; ++i) a[i] += b[i];
  return a;
}
template <class S>
KOKKOS_INLINE_FUNCTION S dot(const Vec3<S>& a, const Vec3<S>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
template <class S>
KOKKOS_INLINE_FUNCTION Vec3<S> cross(const Vec3<S>& a, const Vec3<S>& b) {
  return {{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]}};
}

template <class S>
KOKKOS_INLINE_FUNCTION Mat3<S> zero_matrix() {
  return {{{S(0), S(0), S(0)}, {S(0), S(0), S(0)}, {S(0), S(0), S(0)}}};
}
template <class S>
KOKKOS_INLINE_FUNCTION Mat3<S> identity_matrix() {
  return {{{S(1), S(0), S(0)}, {S(0), S(1), S(0)}, {S(0), S(0), S(1)}}};
}
/// hat(a) with hat(a) b = a x b.
template <class S>
KOKKOS_INLINE_FUNCTION Mat3<S> hat(const Vec3<S>& a) {
  return {{{S(0), -a[2], a[1]}, {a[2], S(0), -a[0]}, {-a[1], a[0], S(0)}}};
}
/// a b^T
template <class S>
KOKKOS_INLINE_FUNCTION Mat3<S> outer(const Vec3<S>& a, const Vec3<S>& b) {
  Mat3<S> m;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) m(i, j) = a[i] * b[j];
  return m;
}
template <class S>
KOKKOS_INLINE_FUNCTION Mat3<S> transpose(const Mat3<S>& m) {
  Mat3<S> t;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) t(i, j) = m(j, i);
  return t;
}
template <class S>
KOKKOS_INLINE_FUNCTION Mat3<S> operator+(const Mat3<S>& a, const Mat3<S>& b) {
  Mat3<S> m;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) m(i, j) = a(i, j) + b(i, j);
  return m;
}
template <class S>
KOKKOS_INLINE_FUNCTION Mat3<S> operator-(const Mat3<S>& a, const Mat3<S>& b) {
  Mat3<S> m;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) m(i, j) = a(i, j) - b(i, j);
  return m;
}
template <class S, class T>
KOKKOS_INLINE_FUNCTION Mat3<S> operator*(const T& f, const Mat3<S>& a) {
  Mat3<S> m;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) m(i, j) = f * a(i, j);
  return m;
}
template <class S>
KOKKOS_INLINE_FUNCTION Vec3<S> operator*(const Mat3<S>& m, const Vec3<S>& v) {
  return {{m(0, 0) * v[0] + m(0, 1) * v[1] + m(0, 2) * v[2], m(1, 0) * v[0] + m(1, 1) * v[1] + m(1, 2) * v[2],
           m(2, 0) * v[0] + m(2, 1) * v[1] + m(2, 2) * v[2]}};
}
template <class S>
KOKKOS_INLINE_FUNCTION Mat3<S> operator*(const Mat3<S>& a, const Mat3<S>& b) {
  Mat3<S> m;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) m(i, j) = a(i, 0) * b(0, j) + a(i, 1) * b(1, j) + a(i, 2) * b(2, j);
  return m;
}
/// m^T v
template <class S>
KOKKOS_INLINE_FUNCTION Vec3<S> transpose_times(const Mat3<S>& m, const Vec3<S>& v) {
  return {{m(0, 0) * v[0] + m(1, 0) * v[1] + m(2, 0) * v[2], m(0, 1) * v[0] + m(1, 1) * v[1] + m(2, 1) * v[2],
           m(0, 2) * v[0] + m(1, 2) * v[1] + m(2, 2) * v[2]}};
}
template <class S>
KOKKOS_INLINE_FUNCTION Mat3<S> symmetric_part(const Mat3<S>& m) {
  Mat3<S> s;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) s(i, j) = 0.5 * (m(i, j) + m(j, i));
  return s;
}
template <class S>
KOKKOS_INLINE_FUNCTION S norm(const Vec3<S>& a) {
  using std::sqrt;
  return sqrt(dot(a, a));
}

}  // namespace mixbeam
