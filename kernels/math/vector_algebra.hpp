/// Vectors of scenes and results: three doubles. Elements compute with Vec3, for any scalar.
#pragma once

#include "kernels/math/small_algebra.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace mixbeam {

using Vector3 = std::array<double, 3>;

namespace vector_algebra {

inline Vector3 to_array(const Vec3<double>& v) { return {v[0], v[1], v[2]}; }
inline Vec3<double> to_vec3(const Vector3& v) { return {{v[0], v[1], v[2]}}; }

inline Vector3 sum(const Vector3& a, const Vector3& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
inline Vector3 difference(const Vector3& a, const Vector3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
inline Vector3 scaled(double factor, const Vector3& a) { return {factor * a[0], factor * a[1], factor * a[2]}; }
inline double dot(const Vector3& a, const Vector3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
inline Vector3 cross(const Vector3& a, const Vector3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
/// Norm without overflow or underflow of the squares.
inline double norm(const Vector3& a) { return std::hypot(a[0], a[1], a[2]); }
inline double distance(const Vector3& a, const Vector3& b) { return norm(difference(a, b)); }
/// Largest absolute value of the components.
inline double largest_component(const Vector3& a) { return std::max({std::abs(a[0]), std::abs(a[1]), std::abs(a[2])}); }
/// Unit vector in the direction of `a`, which is at least kShortestLength long.
inline Vector3 unit(const Vector3& a) { return scaled(1.0 / norm(a), a); }
/// Shortest vector that has a direction: the squares of shorter ones underflow.
inline constexpr double kShortestLength = 1e-100;

/// Smallest box around points, with sides along the global axes.
struct Box {
  Vector3 low{HUGE_VAL, HUGE_VAL, HUGE_VAL}, high{-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};

  void enclose(const Vector3& position) {
    for (std::size_t i = 0; i < 3; ++i) {
      low[i] = std::min(low[i], position[i]);
      high[i] = std::max(high[i], position[i]);
    }
  }
  double diagonal() const { return norm(difference(high, low)); }
};

inline bool is_zero(const Vector3& a) { return a[0] == 0.0 && a[1] == 0.0 && a[2] == 0.0; }

}  // namespace vector_algebra

}  // namespace mixbeam
