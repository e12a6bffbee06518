/// The first point of a path that sets out infinitely steep.
#pragma once

#include "nonlinear/path/corrector.hpp"

#include <optional>

namespace mixbeam {

struct StageRange;

/// A straight member that cannot stretch has to buckle as soon as its ends approach: then displacements grow like the
/// square root of the load factor, the force in the member jumps to its critical value, and nothing at the start tells
/// the way. So members that are rigid in tension or shear yield at first, a little (strains of less than a hundredth as
/// they buckle). Their path is followed until it has buckled, and the point that is found there is hardened at its load
/// factor until members are rigid again.
///
/// From `start`, an equilibrium, along the stage. None where no member can yield, where the yielding structure passes
/// critical points that it does not branch at (which way it goes on is not known then), or where hardening leads away.
/// Collective. Throws what leave_if_asked of the problem throws.
std::optional<Correction> first_point_of_yielding(const Teuchos::RCP<BeamProblem>& problem,
                                                  const SolverParameters& parameters, const State& start,
                                                  const StageRange& range);

}  // namespace mixbeam
