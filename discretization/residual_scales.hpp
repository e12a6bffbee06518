/// Reference values that make the mixed residual dimensionless, so that the same tolerance means the same accuracy for
/// any units, slenderness and load: rows are divided by what is large in the present state, not by a fixed stiffness.
#pragma once

namespace mixbeam {

struct ResidualScales {
  double force = 1.0;     ///< vertex force rows
  double moment = 1.0;    ///< vertex moment rows, spin and psi rows
  double bubble = 1.0;    ///< beta rows: force times element length
  double strain = 1.0;    ///< N rows: a strain
  double rotation = 1.0;  ///< M rows: a relative rotation
  double length = 1.0;    ///< rows of prescribed displacements
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
