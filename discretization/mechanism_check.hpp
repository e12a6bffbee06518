/// Does every connected part of the structure have supports that hold it?
#pragma once

#include "discretization/parameter_source.hpp"
#include "discretization/scene.hpp"

namespace mixbeam {

/// Throws InputError if a connected part (all joints are rigid) can move as a rigid body: the message names its
/// members, the motion and the point that moves most. `path`: where the scene stands below the root of `source`.
void check_supports(const Scene& scene, const ParameterSource& source, const ParameterPath& path = {"Scene"});

}  // namespace mixbeam
