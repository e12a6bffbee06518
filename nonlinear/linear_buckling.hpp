/// Linear buckling: load factors at which the tangent, extrapolated from the unloaded structure, becomes singular.
#pragma once

#include "nonlinear/beam_problem.hpp"
#include "nonlinear/eigen_mode.hpp"

#include <vector>

namespace mixbeam {

/// Load factors lambda (EigenMode::eigenvalue) and modes of (K + lambda K_g) phi = 0, nearest to zero first, of both
/// signs: a negative one buckles under the reversed load. K is the tangent of the reference state, K_g its derivative
/// along the linear response to the loads, d/d lambda at 0, initial stress and initial displacement included; both with
/// the true stiffness to second order in the cap of Newton's tangent. Loads and prescribed motions are those that begin
/// to act at load factor 0, with their slopes there; what acts already at 0 is not taken into account. At most `count`,
/// fewer when there are not so many; none when the loads cause no stress. Follower loads and spatial moments: real
/// factors alone.
///
/// The pencil is linear in the condensed tangent, so factors also have an error of the element length h, whatever the
/// order: of h^4 in columns (clamped and free: 1.3e-5 with five elements, 2.1e-6 with eight), more under moments
/// (lateral buckling: 7e-3 with six elements, below 5e-4 with 64). Critical points that Stability finds on the path
/// have no such error.
///
/// Exact in the limit of small displacements before buckling (columns, frames, beams that are stiff in the plane of the
/// load); it overestimates where the structure softens before. Collective; leaves another tangent in the assembler.
/// Throws LinearSolverError when the unloaded structure is not stable.
std::vector<EigenMode> linear_buckling(BeamProblem& problem, int count);

}  // namespace mixbeam
