/// What the cap on the force stiffness of the tangent (Assembler, cap_force_stiffness) changes in its quadratic form.
#pragma once

#include "discretization/assembly/assembler.hpp"

namespace mixbeam {

/// The sum of theory (49) over all elements: (tangent compliance - true compliance) of dN and dM, the interior parts of
/// two increments that Assembler::recover completed at the state of the last tangent(). To first order in the
/// compliance that the cap adds, the quadratic form of the true tangent is that of the capped one plus this, because a
/// stationary value changes by the change of its functional; the error is quadratic. Collective; a length times a
/// force.
double added_compliance(const Assembler& assembler, const MixedVector& a, const MixedVector& b);

/// What the rows of N and M of `increment`, which solves the capped equations, lack in the true ones: (tangent
/// compliance - true compliance) times dN and dM, theory (37), scaled as Assembler::condense takes it; all other rows
/// zero.
void added_strains(const Assembler& assembler, const MixedVector& increment, MixedVector& scaled_rhs);

}  // namespace mixbeam
