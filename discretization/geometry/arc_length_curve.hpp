/// Polynomial curves by arc length, with the rotation-minimising frame.
#pragma once

#include "discretization/geometry/polynomial_curve.hpp"
#include "kernels/math/rotation.hpp"

#include <memory>
#include <vector>

namespace mixbeam {

/// Curve over its arc length s in [0, length] with the rotation-minimising triad: g1 is the tangent, and the triad
/// never rotates about it (Bishop, Amer. Math. Monthly 82 (1975)), for any curvature and torsion.
///
/// The curve is cut into panels so short that their tangents stay within half a radian of the first one, a. In a panel
/// the triad is that of its start, transported by the smallest rotation from a to the tangent g1, and rotated about g1
/// by the area on the unit sphere that the arc from a to the moving tangent sweeps:
///   theta' = a . (g1 x g1') / (1 + a . g1).
/// Arc length and triad are thus Gauss integrals of known functions: no differential equation is solved.
class ArcLengthCurve {
 public:
  /// `start_triad`: g1 is along the tangent at the start (rounding is removed). Throws std::invalid_argument if the
  /// curve has no tangent somewhere: where it stops or reverses.
  ArcLengthCurve(PolynomialCurve curve, const Quaternion<double>& start_triad);

  double length() const { return panels_.back().end(); }
  Vec3<double> position(double s) const;
  Vec3<double> tangent(double s) const;        ///< of unit length
  Vec3<double> tangent_slope(double s) const;  ///< g1', the vector of curvature: normal to the tangent, 1/length
  Quaternion<double> triad(double s) const;

 private:
  /// Integrals from the start of a panel.
  struct Integrals {
    double length = 0.0;
    double angle = 0.0;            ///< theta
    double smallest_cosine = 1.0;  ///< between the first and the other tangents
    double largest_speed = 0.0;    ///< |dr/dt|
  };
  struct Panel {
    const PolynomialPiece* piece;
    double first, last;  ///< t
    double start;        ///< s
    Vec3<double> tangent;
    Quaternion<double> triad;  ///< at the start
    Integrals whole;
    Quaternion<double> end_triad;

    Panel(const PolynomialPiece& piece, double first, double last, double start, const Quaternion<double>& triad);
    double forward() const { return last > first ? 1.0 : -1.0; }
    double end() const { return start + whole.length; }
    Integrals integrate(double t) const;
    /// Transported triad; `angle`: theta at t.
    Quaternion<double> carried_triad(double t, double angle) const;
    double parameter(double s) const;  ///< t of an arc length
  };

  void add_panels(const PolynomialPiece& piece, double first, double last, int halvings);
  const Panel& panel_at(double s) const;

  std::shared_ptr<const PolynomialCurve> curve_;  ///< panels point into it
  Quaternion<double> start_triad_;
  std::vector<Panel> panels_;
};

/// Smallest rotation between two unit vectors that are not opposite.
Quaternion<double> smallest_rotation(const Vec3<double>& from, const Vec3<double>& to);
Quaternion<double> turn_about_first_axis(double angle);

/// Unit tangent at the start of a curve. Throws std::invalid_argument if the velocity vanishes there.
Vec3<double> start_tangent(const PolynomialCurve& curve);

}  // namespace mixbeam
