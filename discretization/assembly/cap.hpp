/// Cap on the stiffness of a tangent, theory (36). The residual keeps the true compliance, so the cap affects only how
/// fast Newton's method converges, not the result.
#pragma once

#include "discretization/assembly/residual.hpp"

namespace mixbeam {

struct Cap {
  double stiffness = 0.0;  ///< limit of force stiffnesses
  /// Smallest ratio of the cap to a finite stiffness above it; zero if there is none. (Exactly rigid members do not
  /// share forces by stiffness.)
  double least_ratio = 0.0;
  bool cuts_off = false;       ///< any stiffness is cut off; otherwise the tangent is exact
  StructureViews structure{};  ///< sections with the tangent stiffness and the compliance that the cap adds

  bool cuts_off_force(int section, int component) const {
    return structure.sections(section).force_cap_compliance[component] > 0.0;
  }
};

/// Default cap at a state with these scales, times `raise`.
Cap cap_for(const Model& model, const ResidualScales& scales, double raise = 1.0);

/// Computes the rows of the linearised equations that the cap omits, theory (37): (J - capped J) times an increment,
/// scaled.
void cap_compliance_rows(const Model& model, const Cap& cap, const ResidualScales& scales, const MixedVector& increment,
                         MixedVector& rows);
/// Largest of these rows. Collective.
double largest_cap_compliance_row(const Model& model, const Cap& cap, const ResidualScales& scales,
                                  const MixedVector& increment);

/// Sum over all elements of (capped compliance - true compliance) of dN and dM, the interior parts of two increments
/// that Tangent::recover completed. To first order in the compliance that the cap adds, the quadratic form of the true
/// tangent is that of the capped one plus this, because a stationary value changes by the change of its functional; the
/// error is quadratic. Collective; a length times a force.
double cap_compliance_form(const Model& model, const Cap& cap, const MixedVector& a, const MixedVector& b);

}  // namespace mixbeam
