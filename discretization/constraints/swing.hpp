/// Deviation of a rotation from one about a given axis.
#pragma once

#include "kernels/math/rotation.hpp"

#include <cmath>

namespace mixbeam {

/// Rotation Q = swing * twist, the twist about the axis a, the swing about a direction normal to it. Vectors are
/// components in a right-handed frame (b1, b2, a). Swings and angle are those of theory (42) for the quaternion of Q in
/// that frame. At zero swing their derivatives with respect to a spin from the left are (1, 0, 0) and (0, 1, 0), for
/// any angle.
struct SwingTwist {
  double swing[2];              ///< both exactly zero for a rotation about a
  double angle;                 ///< of the twist, in (-2 pi, 2 pi]: continuous beyond pi, like the quaternion
  Vec3<double> swing_slope[2];  ///< derivatives for Q <- exp(eta) Q, components of eta in the frame
  Vec3<double> angle_slope;

  /// `frame` has the rows b1, b2, a.
  SwingTwist(const Quaternion<double>& q, const Mat3<double>& frame) {
    const Vec3<double> v = frame * Vec3<double>{{q.x, q.y, q.z}};
    const double w = q.w, s = v[2];
    swing[0] = 2.0 * (w * v[0] - s * v[1]);
    swing[1] = 2.0 * (s * v[0] + w * v[1]);
    angle = 2.0 * std::atan2(s, w);
    for (int i = 0; i < 3; ++i) {  // exp(eta) Q has the quaternion Q + (0, eta) Q / 2
      Vec3<double> eta{{0.0, 0.0, 0.0}};
      eta[i] = 0.5;
      const double dw = -dot(eta, v);
      const Vec3<double> dv = w * eta + cross(eta, v);
      swing_slope[0][i] = 2.0 * (dw * v[0] + w * dv[0] - dv[2] * v[1] - s * dv[1]);
      swing_slope[1][i] = 2.0 * (dv[2] * v[0] + s * dv[0] + dw * v[1] + w * dv[1]);
      angle_slope[i] = 2.0 * (w * dv[2] - s * dw) / (w * w + s * s);
    }
  }
};

/// Rotation vector of a unit quaternion; q and -q give different ones. Its norm 2 atan2(|v|, w) exceeds pi, up to 2 pi,
/// if the quaternion has changed continuously from the identity.
inline Vec3<double> continued_log(const Quaternion<double>& q) {
  if (q.w >= 0.0) return log_quaternion(q);
  const Vec3<double> v{{q.x, q.y, q.z}};
  const double n = norm(v);
  return (2.0 * std::atan2(n, q.w) / n) * v;
}

}  // namespace mixbeam
