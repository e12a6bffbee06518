/// Linear buckling: load factors at which the tangent, extrapolated from the unloaded structure, becomes singular.
#pragma once

#include "nonlinear/newton/beam_problem.hpp"
#include "nonlinear/stability/independent_unknowns.hpp"

#include <vector>

namespace mixbeam {

/// Finds load factors lambda (EigenMode::eigenvalue) and modes of K(lambda) phi = 0, nearest to zero first, of both
/// signs: negative factors mean buckling under the reversed load. K(lambda) is the tangent of the undeformed structure
/// with lambda times the stresses N, M of its linear response to the loads, interiors of elements condensed exactly,
/// with the true stiffness to second order in the cap of Newton's tangent. Rotations before buckling do not enter: a
/// stiffness rotated by a linearised rotation becomes singular at meaningless factors. Loads and prescribed motions are
/// those that begin to act at load factor 0, with their slopes there; what acts at 0 already is ignored. At most
/// `count`, fewer if there are fewer; none if the loads cause no stress.
///
/// EigenMode::error: residual of the pair, |K(lambda) phi| in units of K(0)^-1 over that of phi, a bound of the
/// relative error of the factor (usually its square). EigenMode::converged: the residual is small, and the inertia of K
/// on both sides of the factor, or of its cluster, confirms it and that none is missing between it and zero. Follower
/// loads and spatial moments: real factors, by modes of K and of its transpose, never confirmed.
///
/// Exact in the limit of small displacements before buckling (columns, frames, beams that are stiff in the plane of the
/// load); an overestimate if the structure softens before. Collective.
/// Throws LinearSolverError if the unloaded structure is not stable.
std::vector<EigenMode> linear_buckling(BeamProblem& problem, int count);

/// Does so about an equilibrium at the end of a stage, with its geometric stiffness: finds factors of the loads that
/// begin to act there. Throws LinearSolverError if it is not stable.
std::vector<EigenMode> linear_buckling(BeamProblem& problem, int count, const State& state, double load_factor);

}  // namespace mixbeam
