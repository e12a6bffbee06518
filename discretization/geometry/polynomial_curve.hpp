/// Curves r(t) of polynomial pieces: what splines and formulas become before arc length is known.
#pragma once

#include "discretization/scene/scene.hpp"
#include "kernels/math/small_algebra.hpp"

#include <vector>

namespace mixbeam {

/// A polynomial over first <= t <= last by its coefficients of Chebyshev polynomials in x = -1 .. 1, with both
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

/// Pieces one after the other; each starts at the t and at the place where the one before it ends. Positions are
/// relative to `origin`, the start of the curve, so that small curves far from the global origin keep their digits.
struct PolynomialCurve {
  Vec3<double> origin{};
  std::vector<PolynomialPiece> pieces{};
};

/// Cubic spline through start, the points of Curve::through and end, twice continuously differentiable in a parameter
/// that grows by the chord between neighbouring points: then the spline through points of a smooth curve approaches it
/// with the fourth power of their distance, however unequal these are (Floater, Numer. Algorithms 49 (2008)).
/// At an end with a tangent it takes that direction; without one it has no curvature there ("natural"), but a closed
/// spline (start = end) without both tangents passes its point as smoothly as the others ("periodic").
/// Throws std::invalid_argument for numbers that are not finite, neighbouring points that coincide, and a closed
/// spline without tangents through fewer than three points.
PolynomialCurve make_spline(const Curve& curve, const Vector3& start, const Vector3& end);

/// x(t), y(t), z(t) of Curve::formula over Curve::range (which may run backwards: then the curve starts at the larger
/// t), interpolated at Chebyshev points to rounding: pieces are halved until their coefficients have decayed. Positions
/// are as accurate as the formula, derivatives lose two to three digits.
/// Throws std::invalid_argument for formulas that cannot be read, values that are not finite, and curves with a jump or
/// a kink, with its t.
PolynomialCurve make_formula_curve(const Curve& curve);

}  // namespace mixbeam
