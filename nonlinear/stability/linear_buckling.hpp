/// Linear buckling: load factors at which the tangent, extrapolated from the unloaded structure, becomes singular.
#pragma once

#include "nonlinear/newton/beam_problem.hpp"
#include "nonlinear/stability/independent_unknowns.hpp"

#include <vector>

namespace mixbeam {

/// Load factors lambda (EigenMode::eigenvalue) and modes of K(lambda) phi = 0, nearest to zero first, of both signs: a
/// negative one buckles under the reversed load. K(lambda) is the tangent of the undeformed structure with lambda times
/// the stresses N, M of its linear response to the loads, interiors of elements condensed exactly, with the true
/// stiffness to second order in the cap of Newton's tangent. Rotations before buckling do not enter: a stiffness turned
/// by a linearised rotation becomes singular at factors without meaning. Loads and prescribed motions are those that
/// begin to act at load factor 0, with their slopes there; what acts already at 0 is not taken into account. At most
/// `count`, fewer when there are not so many; none when the loads cause no stress.
///
/// EigenMode::error: residual of the pair, |K(lambda) phi| in units of K(0)^-1 over that of phi, which bounds the share
/// of the factor by which it may be wrong (its square is the usual size). EigenMode::converged: the residual is small
/// and the inertia of K on both sides of the factor, or of the cluster it belongs to, confirms it and that none is
/// missing between it and zero. Follower loads and spatial moments: real factors, by modes of K and of its transpose,
/// never confirmed.
///
/// Exact in the limit of small displacements before buckling (columns, frames, beams that are stiff in the plane of the
/// load); it overestimates where the structure softens before. Collective.
/// Throws LinearSolverError when the unloaded structure is not stable.
std::vector<EigenMode> linear_buckling(BeamProblem& problem, int count);

/// The same about a state in equilibrium at the end of a stage, with the stiffness that its stresses give: factors of
/// the loads that begin to act there. Throws LinearSolverError when it is not stable.
std::vector<EigenMode> linear_buckling(BeamProblem& problem, int count, const State& state, double load_factor);

}  // namespace mixbeam
