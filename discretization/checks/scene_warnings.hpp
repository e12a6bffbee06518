/// What is allowed in a scene but is a slip more often than not.
#pragma once

#include "discretization/scene/scene.hpp"

#include <string>
#include <vector>

namespace mixbeam {

/// Looks at a scene that read_scene accepted. Each warning is one line: place, value, and the usual reason. Of
/// warnings of one kind the first few are spelt out and the others counted. The limits are wide: a scene that means
/// what it says rarely meets them, and may run all the same.
std::vector<std::string> warnings(const Scene& scene);

}  // namespace mixbeam
