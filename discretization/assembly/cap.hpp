/// The cap on the stiffness of a tangent, theory (36). The residual keeps the true compliance, so the cap costs
/// accuracy nowhere; it decides how fast Newton's method contracts.
#pragma once

#include "discretization/assembly/residual.hpp"

namespace mixbeam {

struct Cap {
  double stiffness = 0.0;  ///< of forces
  /// Cap over stiffness, where that is largest among the stiffnesses that are cut off and finite; zero where there are
  /// none. (What is exactly rigid shares nothing by stiffness.)
  double least_ratio = 0.0;
  bool cuts_off = false;       ///< whether it cuts off any stiffness: else the tangent is the true one
  StructureViews structure{};  ///< sections with the stiffness and the added compliance of tangents

  bool cuts_off_force(int section, int component) const {
    return structure.sections(section).force_cap_compliance[component] > 0.0;
  }
};

/// The usual cap at a state with these scales, times `raise`.
Cap cap_for(const Model& model, const ResidualScales& scales, double raise = 1.0);

/// Computes the rows that the cap leaves out of the linearised equations, theory (37): (J - capped J) times an
/// increment, scaled.
void cap_compliance_rows(const Model& model, const Cap& cap, const ResidualScales& scales, const MixedVector& increment,
                         MixedVector& rows);
/// The largest of these rows. Collective.
double largest_cap_compliance_row(const Model& model, const Cap& cap, const ResidualScales& scales,
                                  const MixedVector& increment);

/// Sum over all elements of (capped compliance - true compliance) of dN and dM, the interior parts of two increments
/// that Tangent::recover completed. To first order in the compliance that the cap adds, the quadratic form of the true
/// tangent is that of the capped one plus this, because a stationary value changes by the change of its functional; the
/// error is quadratic. Collective; a length times a force.
double cap_compliance_form(const Model& model, const Cap& cap, const MixedVector& a, const MixedVector& b);

}  // namespace mixbeam
