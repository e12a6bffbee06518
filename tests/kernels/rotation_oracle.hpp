/// What rotation.hpp is measured against: power series of the matrix hat(psi) with 64-bit mantissas (long double),
/// which know nothing of Rodrigues' formula, quaternions or switch points; and the rotation vectors at which it is
/// measured.
#pragma once

#include "kernels/math/rotation.hpp"

#include <Sacado_No_Kokkos.hpp>

#include <array>
#include <cmath>
#include <limits>
#include <ostream>
#include <random>
#include <vector>

namespace mixbeam::oracle {

using Real = long double;
static_assert(std::numeric_limits<Real>::digits >= 64, "the oracles need more digits than what they judge");
constexpr Real kPi = 3.141592653589793238462643383279502884L;

// ---- functions

/// Sums below are cut off when terms fall below 1e-21 of the first one.
constexpr int kStumpffTerms = 60;             // x <= 30: 30^60 / 120! = 6e-111
constexpr double kStumpffTaylorLimit = 30.0;  // terms of the sum stay below 120: 1e-17 is left of the 1e-19
constexpr int kExponentialTerms = 20;         // |A| <= 1/2: 2^-20 / 20! = 4e-25

/// c_k(x) = sum_j (-x)^j / (2j + k)!, k = 0 .. 7. `value` is the plain number in x.
template <class S>
std::array<S, 8> stumpff(const S& x, double value) {
  using std::cos;
  using std::sin;
  using std::sqrt;
  std::array<S, 8> c;
  Real factorial = 1.0;
  for (std::size_t k = 0; k < 8; ++k) {
    if (k > 0) factorial *= static_cast<Real>(k);
    if (value <= kStumpffTaylorLimit) {
      c[k] = S(1.0);
      for (int j = kStumpffTerms; j > 0; --j)
        c[k] = S(1.0) - x * c[k] * S(Real(1.0) / (Real(2 * j - 1 + int(k)) * Real(2 * j + int(k))));
      c[k] = c[k] * S(Real(1.0) / factorial);
    } else if (k < 2) {
      c[k] = k == 0 ? S(cos(sqrt(x))) : S(sin(sqrt(x)) / sqrt(x));
    } else {
      const Real first_term = Real(static_cast<double>(k) * (static_cast<double>(k) - 1.0)) / factorial;  // 1 / (k-2)!
      c[k] = (S(first_term) - c[k - 2]) / x;
    }
  }
  return c;
}

template <class S>
struct Exponential {
  Mat3<S> rotation;  ///< sum hat(psi)^n / n!
  Mat3<S> tangent;   ///< sum hat(psi)^n / (n + 1)!
};

/// Series at A = hat(psi) / 2^m with |A| <= 1/2, then m doublings: exp(2A) = exp(A)^2, T(2A) = (exp(A) + I) T(A) / 2.
template <class S>
Exponential<S> exponential(const Vec3<S>& psi, double angle) {
  const int doublings = angle > 0.5 ? static_cast<int>(std::ceil(std::log2(angle))) + 1 : 0;
  const Mat3<S> A = S(std::ldexp(1.0, -doublings)) * hat(psi), I = identity_matrix<S>();
  Mat3<S> tangent = I;
  for (int n = kExponentialTerms; n >= 2; --n) tangent = I + S(Real(1.0) / n) * (A * tangent);
  Mat3<S> rotation = I + A * tangent;
  for (int i = 0; i < doublings; ++i) {
    tangent = S(0.5) * ((rotation + I) * tangent);
    rotation = rotation * rotation;
  }
  return {rotation, tangent};
}

/// By Cramer's rule.
template <class S>
Mat3<S> inverse(const Mat3<S>& m) {
  Mat3<S> adjugate;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const int r = (j + 1) % 3, s = (j + 2) % 3, p = (i + 1) % 3, q = (i + 2) % 3;
      adjugate(i, j) = m(r, p) * m(s, q) - m(r, q) * m(s, p);
    }
  const S determinant = m(0, 0) * adjugate(0, 0) + m(0, 1) * adjugate(1, 0) + m(0, 2) * adjugate(2, 0);
  return S(S(1.0) / determinant) * adjugate;
}

/// Rotation vector of q with the shorter angle: 2 atan(|v| / w) v / |v|.
inline Vec3<Real> logarithm(const Quaternion<double>& q) {
  const Real sign = q.w < 0.0 ? -1.0L : 1.0L;
  const Vec3<Real> v{{sign * q.x, sign * q.y, sign * q.z}};
  const Real n = std::hypot(v[0], v[1], v[2]);
  if (n == 0.0L) return v;
  return (2.0L * std::atan2(n, sign * Real(q.w)) / n) * v;
}

// ---- algebra

inline Vec3<Real> to_long(const Vec3<double>& v) { return {{v[0], v[1], v[2]}}; }
inline Real length(const Vec3<double>& v) { return std::hypot(Real(v[0]), Real(v[1]), Real(v[2])); }

/// Euclidean distance, without losing tiny differences to underflow.
template <class A, class B>
double distance(const Vec3<A>& a, const Vec3<B>& b) {
  return static_cast<double>(std::hypot(Real(a[0]) - Real(b[0]), Real(a[1]) - Real(b[1]), Real(a[2]) - Real(b[2])));
}

/// Largest difference of two entries.
template <class A, class B>
double distance(const Mat3<A>& a, const Mat3<B>& b) {
  double largest = 0.0;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const auto error = static_cast<double>(std::abs(Real(a(i, j)) - Real(b(i, j))));
      if (!(error <= largest)) largest = error;  // NaN is kept
    }
  return largest;
}

inline double distance(const Quaternion<double>& a, const Quaternion<double>& b) {
  return std::sqrt((a.w - b.w) * (a.w - b.w) + (a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y) +
                   (a.z - b.z) * (a.z - b.z));
}

template <class S>
Vec3<S> constant(const Vec3<double>& v) {
  return {{S(v[0]), S(v[1]), S(v[2])}};
}

// ---- cases

constexpr unsigned kSeed = 7041776;

struct RotationCase {
  double angle;  ///< intended; |psi| differs from it by rounding
  Vec3<double> psi;
  double exact_angle() const { return static_cast<double>(length(psi)); }
  bool is_below_pi() const { return length(psi) < kPi; }
};

inline std::ostream& operator<<(std::ostream& out, const RotationCase& c) {
  return out << "angle " << c.angle << ", psi = (" << c.psi[0] << ", " << c.psi[1] << ", " << c.psi[2] << "), seed "
             << kSeed;
}

/// Coordinate axes, axes close to one, and random ones.
inline std::vector<Vec3<double>> axes() {
  std::vector<Vec3<double>> result = {{{1, 0, 0}}, {{0, 1, 0}}, {{0, 0, -1}}, {{1, 1e-8, 0}}, {{1e-12, 0.6, 0.8}}};
  std::mt19937_64 random(kSeed);
  std::normal_distribution<double> component;
  constexpr int kRandomAxes = 40;
  for (int i = 0; i < kRandomAxes; ++i) {
    const Vec3<double> v{{component(random), component(random), component(random)}};
    result.push_back((1.0 / norm(v)) * v);
  }
  return result;
}

/// Zero, tiny, both sides of every switch, moderate, next to pi, and many turns.
inline std::vector<double> angles() {
  std::vector<double> result = {0.0, 1e-300, 1e-160, 1e-16, 1e-12, 1e-8, 1e-4, 1e-2, 0.5, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0};
  const double stumpff_switch = std::sqrt(kStumpffSeriesLimit),
               log_switch = 2.0 * std::atan(std::sqrt(kLogSeriesLimit));
  for (const double angle : {stumpff_switch, 2.0 * stumpff_switch, log_switch})
    for (const double off : {1e-12, 1e-6, 1e-2}) {
      result.push_back(angle * (1.0 - off));
      result.push_back(angle * (1.0 + off));
    }
  for (int digits = 1; digits <= 15; ++digits) result.push_back(static_cast<double>(kPi) - std::pow(10.0, -digits));
  for (const double angle : {static_cast<double>(kPi), 2.0 * static_cast<double>(kPi), 10.0, 31.0, 100.0})
    result.push_back(angle);
  return result;
}

inline std::vector<RotationCase> rotation_cases(double largest_angle = 1e3) {
  std::vector<RotationCase> result;
  for (const double angle : angles())
    for (const Vec3<double>& axis : axes())
      if (angle <= largest_angle) result.push_back({angle, angle * axis});
  return result;
}

}  // namespace mixbeam::oracle
