/// Instruction set that this library was built for; in a package the loader chooses one of several.
#pragma once

#include <string>

namespace mixbeam {

/// "x86-64-v4, 8 lanes". Runs have the same bits where this agrees.
std::string instructions();

}  // namespace mixbeam
