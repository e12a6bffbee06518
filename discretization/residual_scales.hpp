/// Reference values that make the mixed residual dimensionless, so that the same tolerance means the same accuracy for
/// any units, slenderness and load: rows are divided by what is large in the present state, not by a fixed stiffness.
#pragma once

#include <algorithm>

namespace mixbeam {

struct ResidualScales {
  double force = 1.0;      ///< vertex force rows
  double moment = 1.0;     ///< vertex moment rows
  double strain = 1.0;     ///< N rows: a strain
  double rotation = 1.0;   ///< M rows: a relative rotation
  double length = 1.0;     ///< rows of prescribed displacements
  double amplitude = 1.0;  ///< how far the structure has moved: strain and rotation before they allow for rounding
  /// What the rounding errors of displacements leave of a strain over a length, divided by the tolerance.
  double displacement_noise = 0.0;

  // Rows of one element of length h: integrals over it, so that short and long elements of a mesh must not share one
  // scale, which would be below the rounding errors of the longest or far above those of the others.
  /// N rows
  double element_strain(double h) const { return std::max(strain, displacement_noise / h); }
  double element_moment(double h) const { return std::max(moment, force * h); }  ///< spin and psi rows
  double element_bubble(double h) const { return force * h; }                    ///< beta rows
};

/// What a state and its loads look like in size (maxima over all ranks).
struct StateMagnitude {
  double force = 0.0;         ///< largest |N| component
  double moment = 0.0;        ///< largest |M| component
  double displacement = 0.0;  ///< largest |u| component
  double rotation = 0.0;      ///< largest vertex rotation angle
  double load_force = 0.0;    ///< largest applied force, point or line load times length
  double load_moment = 0.0;
  double eigenstrain = 0.0;  ///< largest eigenstrain, or eigencurvature times length
};

/// `tolerance`: the scaled residual that will count as converged; floors keep round-off below it.
ResidualScales residual_scales(const StateMagnitude& state, double length, double shortest_element,
                               double bending_stiffness, double tolerance);

}  // namespace mixbeam
