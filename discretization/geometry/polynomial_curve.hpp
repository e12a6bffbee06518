/// Curves r(t) made of polynomial pieces: splines and formulas before their arc length is known.
#pragma once

#include "discretization/scene/scene.hpp"
#include "kernels/math/small_algebra.hpp"

#include <vector>

namespace mixbeam {

/// Polynomial over first <= t <= last by its coefficients in Chebyshev polynomials of x = -1 .. 1, with both
/// derivatives with respect to t in the same form.
class PolynomialPiece {
 public:
  PolynomialPiece(double first, double last, std::vector<Vec3<double>> coefficients);

  double first() const { return first_; }
  double last() const { return last_; }
  Vec3<double> position(double t) const { return evaluate(position_, t); }
  Vec3<double> velocity(double t) const { return evaluate(velocity_, t); }          ///< dr/dt
  Vec3<double> acceleration(double t) const { return evaluate(acceleration_, t); }  ///< d^2 r/dt^2

 private:
  Vec3<double> evaluate(const std::vector<Vec3<double>>& coefficients, double t) const;

  double first_, last_;
  std::vector<Vec3<double>> position_, velocity_, acceleration_;
};

/// Consecutive pieces; each starts at the t and position where the previous one ends. Positions are relative to
/// `origin`, the start of the curve, so that small curves far from the global origin keep their digits.
struct PolynomialCurve {
  Vec3<double> origin{};
  std::vector<PolynomialPiece> pieces{};
};

/// Cubic spline through start, the points of Curve::through and end, twice continuously differentiable in the
/// cumulative chord length. The spline through points of a smooth curve then converges with the fourth power of their
/// distance, however unequal the distances are (Floater, Numer. Algorithms 49 (2008)).
/// At an end with a tangent it takes that direction; without one it has no curvature there ("natural"), but a closed
/// spline (start = end) without both tangents is as smooth at that point as at the others ("periodic").
/// Throws std::invalid_argument for non-finite numbers, coinciding neighbours, and a closed spline without tangents
/// through fewer than three points.
PolynomialCurve make_spline(const Curve& curve, const Vector3& start, const Vector3& end);

/// x(t), y(t), z(t) of Curve::formula over Curve::range (which may run backwards: the curve then starts at the larger
/// t), interpolated at Chebyshev points to rounding: pieces are halved until their coefficients have decayed. Positions
/// are as accurate as the formula, derivatives lose two to three digits.
/// Throws std::invalid_argument for invalid formulas, values that are not finite, and curves with a jump or a kink,
/// with its t.
PolynomialCurve make_formula_curve(const Curve& curve);

}  // namespace mixbeam
