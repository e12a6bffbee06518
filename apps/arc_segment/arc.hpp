/// The arc of the study: its variants, and the displacement along a computed one as the polynomials that it is, away
/// from the simulation, to be compared with that of another mesh.
#pragma once

#include "nonlinear/run/simulation.hpp"

#include <vector>

namespace mixbeam {

struct ArcVariant {
  double slenderness = 100.0;  ///< R/a, square section of side a
  int order = 1;
  int elements = 1;
  double force_factor = 1.0;  ///< times the scene's force
  bool shear_rigid = false, inextensible = false;
};

class ArcScene {
 public:
  /// Throws InputError unless the scene is one circular arc.
  explicit ArcScene(const Scene& scene);

  /// Stiffnesses follow the side of the section (EA, GA ~ a^2, GIt, EI ~ a^4), and so do the loads (~ a^4): the
  /// displacement stays about the same.
  Scene variant(const ArcVariant& arc) const;

  double radius() const { return radius_; }
  double slenderness() const { return slenderness_; }  ///< of the scene as it stands

 private:
  Scene scene_;
  double radius_ = 0.0, slenderness_ = 0.0;
};

class DisplacementField {
 public:
  /// Of the first member of the scene; complete on every rank. Collective.
  explicit DisplacementField(const Simulation& simulation);

  int order() const { return order_; }
  int elements() const { return elements_; }
  /// u at xi in [-1, 1] along an element.
  Vec3<double> at(int element, double xi) const;

 private:
  int order_, elements_;
  std::vector<double> values_;  // (element, node 0..k, component), nodes equidistant from end to end
};

/// sqrt(1/L int |a - b|^2 ds); the elements of `coarse` must consist of whole elements of `fine`.
double l2_difference(const DisplacementField& coarse, const DisplacementField& fine);

/// What the paper's tables add to the tip displacement u(L) of the arc. The paper measures against an element-wise
/// least-squares projection p of the reference curve r0 to polynomials of degree k (with k + 1 Gauss points), and
/// follows the deformed curve by r' of k Gauss points; neither reaches the end of a curved element:
///   printed value = u(L) + t - (p(L) - p(0)),   t = sum over elements and k Gauss points of the tangent r0'.
/// Does not depend on the load; vanishes with the mesh (rate k + 1).
Vec3<double> offset_of_paper(const Simulation& simulation);

}  // namespace mixbeam
