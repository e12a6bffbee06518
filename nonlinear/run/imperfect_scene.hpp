/// Scenes whose stress-free geometry follows a buckling mode.
#pragma once

#include "discretization/mesh/communicator.hpp"
#include "discretization/parameters/source.hpp"
#include "discretization/scene/scene.hpp"
#include "nonlinear/parameters/solver_parameters.hpp"

namespace mixbeam {

/// The scene with its Scene::imperfection_modes laid on: each member becomes a spline through the displaced places of
/// its vertices and element middles, with the displaced tangents at its ends and a twist that follows its sections (C1
/// in centerline and triads; the fourth power of the distance between these places is what it deviates from the mode).
/// The mode's sign: positive where its largest entry occurs first; those of critical points have the sign of result
/// files, and the path of the structure as it was drawn is followed up to them. Unchanged where there are none.
/// Collective. Throws InputError where the structure has fewer modes. `place`: of the scene.
Scene with_mode_shapes(const Scene& scene, const SolverParameters& parameters, const Communicator& comm,
                       const InputPlace& place);

}  // namespace mixbeam
