/// Newton increments without the cap of the tangent. The capped tangent J_c differs from J only by the compliance that
/// it adds to N and M where a section is (nearly) rigid. Forces that equilibrium determines do not feel it; but in a
/// redundant structure N and M are shared by stiffness, and an increment with J_c shares them by the capped one: then
/// Newton's method would need as many iterations as the cap is below the stiffness. J = J_c + D, D the E of theory
/// (38), is solved here instead by GMRES, preconditioned with the factorised J_c: its iterations are as many as there
/// are distinct ways of sharing.
#pragma once

#include "nonlinear/newton/step.hpp"

namespace mixbeam {

/// From d with J_c d = -r to d with (J_c + D) d = -r. `cap_ratio`: of the cap to the largest finite stiffness
/// (Cap::least_ratio); what answers less belongs to closed frames that are exactly rigid, may carry any stress of their
/// own, and are left alone. The increment stays as it is where the iteration gains nothing. Returns whether it gained
/// something. Throws LinearSolverError, the increment being untouched then. Collective; the same for any number of
/// threads.
bool remove_cap_compliance(Linearization& linearization, double cap_ratio, MixedVector& increment);

}  // namespace mixbeam
