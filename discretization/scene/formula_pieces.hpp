/// Where functions along a member change: peaks, boxes and jumps however narrow, so that no mesh passes them unseen.
#pragma once

#include "discretization/geometry/reference_curve.hpp"
#include "discretization/scene/scene.hpp"

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace mixbeam {

/// Vertices for the sake of formulas stay this far apart: shorter elements leave nothing but rounding.
inline constexpr double kNearestPlaces = 1e-6;

using FormulaFunction = std::function<double(double x)>;  ///< of x = relative arc length

/// Pieces of [0, 1] on each of which a function is a polynomial of degree 7, up to 1e-9 of its integral over all.
struct FormulaPieces {
  std::vector<double> end{0.0, 1.0};  ///< ascending
  std::vector<double> places{};       ///< inside (0, 1), those that a mesh needs: jumps, kinks, ends of short pieces

  /// Gauss points and weights over [a, b] that integrate the function times a polynomial of degree 7. Empty where [a,
  /// b] lies in one piece.
  std::vector<std::pair<double, double>> points(double a, double b) const;
};

/// A force, couple, strain or curvature along a member of the scene, as its formulas say.
struct FormulaVector {
  std::array<std::shared_ptr<const FormulaPieces>, 3> component{};  ///< null: not a formula, or a constant one
  bool empty() const { return !component[0] && !component[1] && !component[2]; }
};
/// Looks at 16384 places, so that what is a ten-thousandth as wide as the member is met, and from there on wherever the
/// formula is not resolved; values that are not finite count as zero. Each distinct text and length is looked at once
/// in a process, whatever the number of members. Throws std::invalid_argument for a text that is no formula.
FormulaVector pieces_of(const std::array<std::string, 3>& formula, double length);

/// Of the compliance of a member whose taper is a formula, likewise; null for all others. Throws as SectionLaw.
std::shared_ptr<const FormulaPieces> pieces_of_taper(const Scene& scene, const Member& member);

/// What a formula says along a member: that of a load, of an eigenstrain, of the member's taper or of its curve.
struct FormulaAlong {
  size_t member = 0;
  std::string list{}, text{};             ///< `list`: where it stands in the scene
  std::array<double, 2> range{0.0, 1.0};  ///< where it acts
  std::shared_ptr<const FormulaPieces> pieces{};
  /// Value; of a taper the sum of all components of the compliance over those at x = 0; of a curve its squared
  /// curvature.
  FormulaFunction function{};
};
/// All that are not constant, of those members that are `wanted`. `curve` of a member is asked where a formula needs
/// it. `places`: also where curves need vertices; that takes many looks at them, and their pieces are those of the
/// tangent.
std::vector<FormulaAlong> formulas_along(const Scene& scene, const std::function<bool(const Member&)>& wanted,
                                         const std::function<const ReferenceCurve&(size_t)>& curve, bool places);

/// What sums over points miss of resultants and of first moments over half lengths of elements, and of what: the
/// integral of |function|. Over lengths relative to the member.
struct MissedIntegral {
  double missed = 0.0, total = 0.0;
};
/// Sums that miss a smaller share than this of an element are good enough: so they do for smooth functions.
inline constexpr double kMissedShare = 1e-6;

/// `value`: of a function at points xi of an element [a, b] with the weights of their Gauss rule. Where their sums miss
/// more than kMissedShare they become those of the polynomial that has the integrals of the function itself against all
/// polynomials which the rule can tell apart.
MissedIntegral integrate_at_points(const FormulaPieces& pieces, const FormulaFunction& function, double a, double b,
                                   const std::vector<double>& xi, const std::vector<double>& weight,
                                   std::vector<double>& value);

}  // namespace mixbeam
