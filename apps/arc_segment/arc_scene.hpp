/// The scene of the study and its variants: other slenderness, mesh, load, rigidity.
#pragma once

#include "discretization/scene/scene.hpp"

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

}  // namespace mixbeam
