/// Reading a whole file of input.
#pragma once

#include <string>

namespace mixbeam {

/// Its bytes. Throws InputError, with the name and the system's reason, for what is missing, no file ("allowed:
/// `kind`"), larger than 256 MiB (some million members; keeps a wrong file from eating memory) or not readable to its
/// end. It is an input of this process from now on.
std::string text_of_file(const std::string& path, const std::string& kind);

/// Throws InputError, which names both, where `output` is an input of this process, by whatever name, and where it is
/// no file: whoever writes a file under that name replaces neither.
void require_no_input(const std::string& output);

}  // namespace mixbeam
