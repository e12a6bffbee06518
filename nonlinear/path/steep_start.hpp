/// First point of a path with an infinite, or nearly infinite, initial slope.
#pragma once

#include "nonlinear/path/corrector.hpp"

#include <optional>

namespace mixbeam {

class Stability;
struct StageRange;

/// Finds the first point of such a path. A cable that is straight and not yet tight hardly resists its weight: it
/// rotates by a right angle at load factors of 1e-12. A straight inextensible member has to buckle as soon as its ends
/// approach: displacements grow like the square root of the load factor, and the tangent at the start gives no
/// direction. Since static states do not depend on how they were reached, an auxiliary structure with a regular path is
/// followed: limp members are stiffer in bending; if none is limp, rigid ones yield in tension and shear (strains below
/// 1 % as they buckle). From a point of its path stiffnesses are restored by factors, at constant load factor.
///
/// `start`: an equilibrium at the start of the range. None if no member is limp or can yield, if the auxiliary
/// structure passes critical points at which it does not branch (the direction is unknown then), or if restoring
/// stiffnesses does not lead to the path of small loads: to an equilibrium that is stable, with limp members in
/// tension; without limp members, close to the point where it began. Collective. Passes on what leave_if_asked throws.
std::optional<Correction> first_point_of_steep_path(const Teuchos::RCP<BeamProblem>& problem,
                                                    const SolverParameters& parameters, const State& start,
                                                    const StageRange& range, Stability* stability);

/// Whether a state is that of a cable structure in tension under dead loads: without compression its potential is
/// convex, and no other state is stable, whatever the path to it. Collective.
bool hangs_in_tension(const Model& model, const State& state, double load_factor);

}  // namespace mixbeam
