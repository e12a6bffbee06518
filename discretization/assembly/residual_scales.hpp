/// Reference values that make the mixed residual dimensionless, theory (39), so that the same tolerance means the same
/// accuracy for any units, slenderness and load: rows are divided by what is large in the present state, not by a fixed
/// stiffness.
#pragma once

#include "kernels/element/row_scales.hpp"

namespace mixbeam {

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
