/// Reading a whole file of input.
#pragma once

#include <string>

namespace mixbeam {

/// Its bytes. Throws InputError, with the name and the system's reason, for what is missing, no file ("allowed:
/// `kind`"), larger than 256 MiB (some million members; keeps a wrong file from eating memory) or not readable to its
/// end.
std::string text_of_file(const std::string& path, const std::string& kind);

}  // namespace mixbeam
