/// Warnings of likely mistakes: things that a scene may contain and seldom means.
#pragma once

#include "discretization/scene/scene.hpp"

#include <string>
#include <vector>

namespace mixbeam {

/// Looks at a scene that read_scene accepted. Each warning is one line: place, value, and the usual reason. The first
/// few warnings of a kind are spelt out, the others counted. The limits are wide: a scene that means what it says
/// rarely meets them, and may run all the same.
std::vector<std::string> warnings(const Scene& scene);

/// Warning of a scene in which nothing acts: none where its vibrations are asked for.
inline constexpr const char* kNothingActs = "nothing acts: no loads, eigenstrains or prescribed motions";

}  // namespace mixbeam
