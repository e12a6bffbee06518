#include "discretization/geometry/isometry.hpp"

#include "discretization/text/number_text.hpp"
#include "kernels/math/vector_algebra.hpp"

#include <cmath>

namespace mixbeam {

using namespace vector_algebra;

Isometry Isometry::shift(const Vector3& vector) {
  Isometry motion;
  motion.shift_ = vector;
  return motion;
}

Isometry Isometry::rotation(const Vector3& center, const Vector3& axis, double angle) {
  const Vector3 n = unit(axis);
  // 1 - cos without cancellation; a rotation by 90 degrees should not leave 6e-17 in place of zero
  const double half_sine = std::sin(0.5 * angle);
  constexpr double kRounding = 4e-16;
  const auto cleaned = [](double value) { return std::abs(value) < kRounding ? 0.0 : value; };
  const double cosine = cleaned(std::cos(angle)), sine = cleaned(std::sin(angle));
  const double versine = 2.0 * half_sine * half_sine;
  Isometry motion;
  motion.is_shift_ = false;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
    motion.rows_[i][i] = cosine + versine * n[i] * n[i];
    motion.rows_[i][j] = versine * n[i] * n[j] - sine * n[k];
    motion.rows_[i][k] = versine * n[i] * n[k] + sine * n[j];
  }
  motion.shift_ = difference(center, motion.direction(center));
  return motion;
}

Isometry Isometry::reflection(const Vector3& point, const Vector3& normal) {
  const Vector3 n = unit(normal);
  Isometry motion;
  motion.is_shift_ = false;
  motion.mirrors_ = true;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) motion.rows_[i][j] -= 2.0 * n[i] * n[j];
  motion.shift_ = scaled(2.0 * dot(n, point), n);
  return motion;
}

Vector3 Isometry::direction(const Vector3& v) const { return {dot(rows_[0], v), dot(rows_[1], v), dot(rows_[2], v)}; }

Vector3 Isometry::position(const Vector3& x) const { return sum(is_shift_ ? x : direction(x), shift_); }

Vector3 Isometry::turning_axis(const Vector3& axis) const { return scaled(mirrors_ ? -1.0 : 1.0, direction(axis)); }

std::array<std::string, 3> Isometry::formulas(const std::array<std::string, 3>& x) const {
  std::array<std::string, 3> image;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      if (rows_[i][j] == 0.0) continue;
      const std::string factor = rows_[i][j] == 1.0 ? "" : "(" + shortest(rows_[i][j]) + ")*";
      image[i] += (image[i].empty() ? "" : "+") + factor + "(" + x[j] + ")";
    }
    if (shift_[i] != 0.0) image[i] += "+(" + shortest(shift_[i]) + ")";
  }
  return image;
}

Curve image(const Isometry& motion, const Curve& curve) {
  Curve moved = curve;
  moved.center = motion.position(curve.center);
  moved.axis = motion.turning_axis(curve.axis);
  if (motion.mirrors()) moved.rise = -curve.rise;
  for (Vector3& point : moved.through) point = motion.position(point);
  for (Vector3& tangent : moved.end_tangents) tangent = motion.direction(tangent);
  if (curve.shape == CurveShape::parametric) moved.formula = motion.formulas(curve.formula);
  return moved;
}

Matrix6 mirrored_stiffness(const Matrix6& stiffness) {
  constexpr std::array<double, 6> kSign = {1, 1, -1, -1, -1, 1};
  Matrix6 mirrored = stiffness;
  for (std::size_t i = 0; i < 6; ++i)
    for (std::size_t j = 0; j < 6; ++j) mirrored[i][j] *= kSign[i] * kSign[j];
  return mirrored;
}

}  // namespace mixbeam
