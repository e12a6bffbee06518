/// Warnings of likely mistakes: valid input that is rarely intended.
#pragma once

#include "discretization/scene/scene.hpp"

#include <string>
#include <vector>

namespace mixbeam {

/// Warnings about a scene that read_scene accepted. Each is one line: place, value, and the usual cause. The first few
/// warnings of a kind are spelt out, the others counted. The limits are wide: intended input rarely exceeds them, and
/// such a scene runs all the same.
std::vector<std::string> warnings(const Scene& scene);

/// Warning of a scene in which nothing acts; left out if its vibrations are requested.
inline constexpr const char* kNothingActs = "nothing acts: no loads, eigenstrains or prescribed motions";

}  // namespace mixbeam
