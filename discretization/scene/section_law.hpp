/// Compliance of elements from the sections of a scene: coupled sections, and sections that vary along a member.
#pragma once

#include "discretization/scene/scene.hpp"
#include "discretization/text/expression.hpp"

namespace mixbeam {

/// The six numbers of a section in the order EA, GA2, GA3, GIt, EI2, EI3.
std::array<double, 6> diagonal(const Section& section);
void set_diagonal(Section& section, const std::array<double, 6>& diagonal);

/// Compliance S = C^-1 of (N, M) -> (gamma, kappa), material components, order as in Section::matrix. Rigid components
/// (an infinite stiffness among the six numbers) have zero rows and columns. Throws std::invalid_argument when a
/// stiffness is not positive, or the matrix is not finite, symmetric and positive definite in the components that are
/// not rigid.
Matrix6 section_compliance(const Section& section);

/// Mass per length to which the weight of a tapered member refers: that of the start section, or of the end section if
/// the start section has none.
inline double reference_mass(double start, double end) { return start > 0.0 ? start : end; }

/// Whether elements of the member need the full 6 x 6 law: a coupled section, or one that varies.
bool has_general_section(const Scene& scene, const Member& member);

/// Section of a member along its length.
class SectionLaw {
 public:
  /// Holds no section.
  SectionLaw() = default;
  /// Throws InputError for an unknown section, std::invalid_argument for a formula that cannot be parsed, a section
  /// that section_compliance rejects, and for a taper between sections of which one is rigid in a component and the
  /// other is not.
  SectionLaw(const Scene& scene, const Member& member);

  /// Section at x = relative arc length in [0, 1]. In a taper with weight w(x), interpolates (1 - w) start + w end the
  /// dimensions if both sections have shapes of one kind, otherwise the stiffness matrix. Throws std::invalid_argument
  /// if the weight is not finite.
  Section section(double x) const;
  /// Section for a given weight; members without end section have one section only.
  Section section_of_weight(double weight) const;

  /// Mass at x over reference_mass().
  double share_of_mass(double x) const { return section(x).mass / reference_mass(start_.mass, end_.mass); }

  /// section_compliance(section(x)); the text of an error names the place.
  Matrix6 compliance(double x) const;

 private:
  bool tapered_ = false, by_shape_ = false;
  Section start_{}, end_{};
  Matrix6 start_compliance_{};
  Expression weight_{};
};

/// Whether a body can have these moments of inertia: none exceeds the sum of the others.
bool is_inertia(const std::array<double, 3>& inertia);

/// Cholesky factor of the 6 x 6 mass matrix of a section, whose quadratic form in velocity and spin along its axes is
/// twice the kinetic energy per length; lower triangle, row by row.
std::array<double, 21> mass_factor(const Section& section);

}  // namespace mixbeam
