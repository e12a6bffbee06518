/// Members of a scene: their parameters.
#pragma once

#include "discretization/parameters/binding.hpp"
#include "discretization/scene/scene.hpp"

namespace mixbeam {

/// Parameters of one member. A further property of members is a field of Member, a line here, and its use.
const BoundList<Member>& member_parameters();

}  // namespace mixbeam
