/// Which parameters of NOX and LOCA a user may set. Those libraries ignore names that they do not know, so a misspelt
/// one would have no effect and no message; defaults stay theirs unless this program sets its own.
#pragma once

#include "discretization/parameters/spec.hpp"

namespace mixbeam {

/// Declaration of the list "NOX" (names: NOX_LineSearch_*.H, NOX_Direction_Newton.H, NOX_Utils.H of Trilinos 13.2).
ListSpec nox_spec();

/// Declaration of the list "LOCA" (names: LOCA_Stepper, LOCA_MultiContinuation_ArcLengthGroup.H, LOCA_StepSize_*.H,
/// LOCA_MultiPredictor_Factory.H). Continuation parameter, its range and the numbers of steps and iterations are not
/// among them: the program sets them from the scene and from "Load Path" and "Newton".
ListSpec loca_spec();

}  // namespace mixbeam
