/// Distance-preserving maps: translations, rotations, reflections, applied to points and members.
#pragma once

#include "discretization/scene/scene.hpp"

#include <array>

namespace mixbeam {

/// x -> R x + t with an orthogonal R, whose determinant is -1 for a reflection.
class Isometry {
 public:
  static Isometry shift(const Vector3& vector);
  /// Right-handed rotation by `angle` about the axis through `center` (axis of any nonzero length).
  static Isometry rotation(const Vector3& center, const Vector3& axis, double angle);
  /// Reflection in the plane through `point` with this normal (any nonzero length).
  static Isometry reflection(const Vector3& point, const Vector3& normal);

  Vector3 position(const Vector3& x) const;
  Vector3 direction(const Vector3& v) const;
  /// Axis of the image of a right-handed rotation about `axis`, right-handed again: det(R) R axis.
  Vector3 turning_axis(const Vector3& axis) const;

  bool is_shift() const { return is_shift_; }
  bool mirrors() const { return mirrors_; }
  /// Formulas of the image of the point with the given coordinate formulas.
  std::array<std::string, 3> formulas(const std::array<std::string, 3>& x) const;

 private:
  std::array<Vector3, 3> rows_{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  Vector3 shift_{};
  bool is_shift_ = true;
  bool mirrors_ = false;
};

/// Image of a curve. A reflection changes the handedness of a helix: its axis of rotation is reversed relative to the
/// image of the axis, and so is the rise along it.
Curve image(const Isometry& motion, const Curve& curve);

/// Image of a stiffness under a reflection. Section triads are right-handed: the image of axis 2 becomes axis 2, the
/// negative image of axis 3 becomes axis 3. Strains of the image are then (gamma_1, gamma_2, -gamma_3, -kappa_1,
/// -kappa_2, kappa_3), and couplings between the two groups change sign.
Matrix6 mirrored_stiffness(const Matrix6& stiffness);

}  // namespace mixbeam
