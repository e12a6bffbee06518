/// The first point of a path that sets out infinitely steep, or nearly so.
#pragma once

#include "nonlinear/path/corrector.hpp"

#include <optional>

namespace mixbeam {

class Stability;
struct StageRange;

/// A cable that is straight and not yet tight hardly resists its weight: it turns by a right angle at load factors of
/// 1e-12. A straight member that cannot stretch has to buckle as soon as its ends approach: displacements grow like the
/// square root of the load factor, and nothing at the start tells the way. Statics does not remember how a state was
/// reached, so a structure is followed whose stiffness makes the path regular: limp members are stiffer in bending, and
/// where none is limp, rigid ones yield in tension and shear (strains of less than a hundredth as they buckle). From a
/// point of its path the stiffnesses go back to their own, by factors, at that load factor.
///
/// From `start`, an equilibrium, along the stage. None where no member is limp or can yield, where the structure that
/// is followed passes critical points that it does not branch at (which way it goes on is not known then), or where the
/// way back does not end on the path of small loads: with limp members, which must be in tension, at an equilibrium
/// that is not stable; else far from where it began. Collective. Throws what leave_if_asked of the problem throws.
std::optional<Correction> first_point_of_steep_path(const Teuchos::RCP<BeamProblem>& problem,
                                                    const SolverParameters& parameters, const State& start,
                                                    const StageRange& range, Stability* stability);

/// Whether a state is that of a structure of cables in tension under dead loads: without compression their potential is
/// convex, and no other state is stable, whatever the path to it. Collective.
bool hangs_in_tension(const Model& model, const State& state, double load_factor);

}  // namespace mixbeam
