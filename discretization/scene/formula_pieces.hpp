/// Places where functions along a member change: peaks, boxes and jumps, however narrow, so that no mesh misses them.
#pragma once

#include "discretization/geometry/reference_curve.hpp"
#include "discretization/scene/scene.hpp"

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace mixbeam {

/// Least distance of vertices that are made for formulas: shorter elements resolve rounding only.
inline constexpr double kNearestPlaces = 1e-6;

using FormulaFunction = std::function<double(double x)>;  ///< of x = relative arc length

/// Pieces of [0, 1] in each of which a function is a polynomial of degree 7, up to 1e-9 of its whole integral.
struct FormulaPieces {
  std::vector<double> end{0.0, 1.0};  ///< ascending
  std::vector<double> places{};       ///< inside (0, 1), where a mesh needs vertices: jumps, kinks, short pieces

  /// Gauss points and weights over [a, b] that integrate the function times a polynomial of degree 7. Empty where [a,
  /// b] lies in one piece.
  std::vector<std::pair<double, double>> points(double a, double b) const;
};

/// A force, couple, strain or curvature along a member of the scene, as its formulas say.
struct FormulaVector {
  std::array<std::shared_ptr<const FormulaPieces>, 3> component{};  ///< null: not a formula, or a constant one
  bool empty() const { return !component[0] && !component[1] && !component[2]; }
};
/// Samples 16384 places, enough to meet features a ten-thousandth as wide as the member, and refines where the formula
/// is not resolved; values that are not finite count as zero. Each distinct text and length is sampled once in a
/// process, whatever the number of members. Throws std::invalid_argument for an invalid formula.
FormulaVector pieces_of(const std::array<std::string, 3>& formula, double length);

/// Pieces of the compliance of a member whose taper is a formula; null for all others. Throws like SectionLaw.
std::shared_ptr<const FormulaPieces> pieces_of_taper(const Scene& scene, const Member& member);

/// Formula along a member: of a load, of an eigenstrain, of the member's taper or of its curve.
struct FormulaAlong {
  size_t member = 0;
  std::string list{}, text{};             ///< `list`: the one of the scene that has it
  std::array<double, 2> range{0.0, 1.0};  ///< where it acts
  std::shared_ptr<const FormulaPieces> pieces{};
  /// Value of the formula; for a taper the sum of the diagonal compliances over those at x = 0; for a curve its squared
  /// curvature.
  FormulaFunction function{};
};
/// All formulas that are not constant, of members that are `wanted`. Calls `curve` for members whose formulas need it.
/// `places`: also finds where curves need vertices, which takes many samples; their pieces are then those of the
/// tangent.
std::vector<FormulaAlong> formulas_along(const Scene& scene, const std::function<bool(const Member&)>& wanted,
                                         const std::function<const ReferenceCurve&(size_t)>& curve, bool places);

/// Error of sums over points in resultants and in first moments over half lengths of elements, and the integral of
/// |function| to compare it with. Over lengths relative to the member.
struct MissedIntegral {
  double missed = 0.0, total = 0.0;
};
/// Share of an element below which the error of such sums is small enough, as for smooth functions.
inline constexpr double kMissedShare = 1e-6;

/// `value`: values of a function at points xi of an element [a, b] with the weights of their Gauss rule. If their sums
/// miss more than kMissedShare, they are replaced by those of the polynomial that has the integrals of the function
/// itself against all polynomials that the rule distinguishes.
MissedIntegral integrate_at_points(const FormulaPieces& pieces, const FormulaFunction& function, double a, double b,
                                   const std::vector<double>& xi, const std::vector<double>& weight,
                                   std::vector<double>& value);

}  // namespace mixbeam
