/// Scenes whose stress-free geometry follows a buckling mode.
#pragma once

#include "discretization/mesh/communicator.hpp"
#include "discretization/parameters/source.hpp"
#include "discretization/scene/scene.hpp"
#include "nonlinear/parameters/solver_parameters.hpp"

namespace mixbeam {

/// Applies the Scene::imperfection_modes: each member becomes a spline through the displaced positions of its vertices
/// and element midpoints, with the displaced tangents at its ends and a twist that follows its sections (C1 in
/// centerline and triads; it deviates from the mode by the fourth power of the distance between these positions).
/// Sign of a mode: positive where its largest entry occurs first; modes of critical points have the sign of result
/// files, and the path of the structure as drawn is followed up to them. Returns the scene unchanged without modes.
/// Collective. Throws InputError if the structure has fewer modes. `place`: of the scene.
Scene with_mode_shapes(const Scene& scene, const SolverParameters& parameters, const Communicator& comm,
                       const InputPlace& place);

}  // namespace mixbeam
