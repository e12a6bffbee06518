/// Stresses in a cross-section of given shape from the forces and moments in it: Saint-Venant's fields. Pure functions
/// of the section, its forces and a point; nothing here knows a state or a mesh.
#pragma once

#include "discretization/scene/scene.hpp"

#include <array>
#include <memory>
#include <optional>

namespace mixbeam {

/// Forces and moments in a section, material components as the element has them.
struct SectionForces {
  Vector3 force{};   ///< N, Q2, Q3
  Vector3 moment{};  ///< T, M2, M3
};

/// Place in a section: coordinates along its axes 2 and 3 from the centroid [length].
using SectionPoint = std::array<double, 2>;

/// Stresses at a point of a section, with their signs [force / length^2]; all other components are zero.
struct PointStress {
  double normal = 0.0;            ///< sigma_11, tension positive
  std::array<double, 2> shear{};  ///< tau_12, tau_13
  double largest_shear() const;   ///< sqrt(tau_12^2 + tau_13^2): on the section, not Mohr's
  double von_mises() const;       ///< sqrt(sigma^2 + 3 (tau_12^2 + tau_13^2))
};

/// Largest value over a section and where it is found.
struct LargestStress {
  double value = 0.0;
  SectionPoint point{};
};

/// Largest stresses, at points that may differ. For equal values any symmetric state names the same point.
struct LargestStresses {
  LargestStress normal;     ///< of largest magnitude, with its sign; tension where both are as large
  LargestStress shear;      ///< sqrt(tau_12^2 + tau_13^2)
  LargestStress von_mises;  ///< of signed components at one point
};

class StressField;

/// Whether the stresses of a section are known: from its shape, or at its stress points.
bool has_stresses(const Section& section);

/// Admissible von Mises stress of its material, if known.
std::optional<double> strength_of(const Section& section);

/// Stresses of one section. The fields, with Poisson's ratio n of the material and shear modulus E / (2 (1 + n)):
///
/// All shapes: sigma = N / A + M2 x3 / I2 - M3 x2 / I3; shear stresses of T, Q2 and Q3 add with their signs.
/// Circle, tube, ellipse, rectangle: Saint-Venant's torsion and flexure, exact in the theory of elasticity (Love, A
/// Treatise on the Mathematical Theory of Elasticity, ch. XV; Timoshenko and Goodier, Theory of Elasticity, art. 104 to
/// 110 and ch. 11). I and box: thin walls, shear flow V S / (I t) (EN 1993-1-1, 6.20), no fillets, no warping
/// restraint; torsion of the I: +-T t / J on the faces of each wall, linear between them; T, L and U likewise, shear
/// forces through their shear centre; of the box: Bredt's flow, and likewise linear through the walls with what they
/// carry as open ones. In the corners of a box the shear stress of the wall's end is kept. Stress points: sigma as
/// above with A = EA / E and I = EI / E at these points alone; tau = T / W_T at each of them; shear forces make none.
/// Of a section given by a matrix: at the same points, by their rows of stresses.
///
/// Neglected: curvature of the member (Winkler and Bach), the stresses that a taper adds.
class SectionStresses {
 public:
  /// Accepts the shapes of make_section; throws std::invalid_argument for others. Costs some 50 microseconds for a
  /// rectangle (its series), a few for other shapes.
  explicit SectionStresses(const SectionShape& shape);
  /// For a section that has_stresses().
  explicit SectionStresses(const Section& section);

  /// Stress at a point of the section; points outside of it give meaningless numbers, see `contains`. Where flange and
  /// web of an I meet, the flange counts.
  PointStress at(const SectionForces& forces, const SectionPoint& point) const;

  /// Whether a point belongs to the section, its boundary included (to rounding).
  bool contains(const SectionPoint& point) const;

  /// Largest stresses over the section: no point exceeds a value by more than 1e-6 of it.
  LargestStresses largest(const SectionForces& forces) const;

  /// Largest normal strain over the section, |gamma_1 + kappa_2 x3 - kappa_3 x2|, for strains of the centerline: at its
  /// edge.
  double largest_edge_strain(double axial, double bending2, double bending3) const;

  /// Relative excess of the bending stress at the inner fibre of a curved member over the linear one, to first order in
  /// size over radius (Winkler and Bach): kappa (c - I / (A c)), c the distance of that fibre. h / (3 R) for a
  /// rectangle, 3 d / (8 R) for a circle. `kappa2`, `kappa3`: undeformed curvature about axes 2 and 3.
  double curvature_error(double kappa2, double kappa3) const;

 private:
  explicit SectionStresses(std::shared_ptr<const StressField> field);

  std::shared_ptr<const StressField> field_;                             ///< immutable, so copies share it
  std::shared_ptr<const std::vector<StressPoints::Place>> recovered_{};  ///< points with rows of their own, else null
  std::array<LargestStress, 3> unit_shear_{};                            ///< of unit T, Q2, Q3, times sqrt(3)
};

}  // namespace mixbeam
