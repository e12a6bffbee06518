/// Vectors of the scene: three doubles.
#pragma once

#include "discretization/scene/scene.hpp"

#include <cmath>

namespace mixbeam::vector_algebra {

inline Vector3 sum(const Vector3& a, const Vector3& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
inline Vector3 difference(const Vector3& a, const Vector3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
inline Vector3 scaled(double factor, const Vector3& a) { return {factor * a[0], factor * a[1], factor * a[2]}; }
inline double dot(const Vector3& a, const Vector3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
inline Vector3 cross(const Vector3& a, const Vector3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
/// Without overflow or underflow of the squares.
inline double norm(const Vector3& a) { return std::hypot(a[0], a[1], a[2]); }
/// In the direction of `a`, which is at least kShortestLength long.
inline Vector3 unit(const Vector3& a) { return scaled(1.0 / norm(a), a); }
/// Shorter vectors have no direction: the squares of their components underflow.
inline constexpr double kShortestLength = 1e-100;

inline bool is_zero(const Vector3& a) { return a[0] == 0.0 && a[1] == 0.0 && a[2] == 0.0; }

}  // namespace mixbeam::vector_algebra
