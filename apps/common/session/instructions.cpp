#include "apps/common/session/instructions.hpp"

#include "kernels/execution/pack.hpp"
#include "mixbeam/version.hpp"

namespace mixbeam {

std::string instructions() { return std::string(kInstructions) + ", " + std::to_string(kLanes) + " lanes"; }

}  // namespace mixbeam
