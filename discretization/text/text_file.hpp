/// Reads whole input files.
#pragma once

#include <string>

namespace mixbeam {

/// Bytes of a file, which becomes an input of this process. Throws InputError, with the name and the system's reason,
/// if it is missing, not a regular file ("allowed: `kind`"), larger than 256 MiB (some million members; a wrong file
/// must not exhaust memory) or not readable to its end.
std::string text_of_file(const std::string& path, const std::string& kind);

/// Throws InputError if `output` is an input of this process (under any name; both are named) or exists but is not a
/// regular file. To be called before a file of that name is replaced.
void require_no_input(const std::string& output);

}  // namespace mixbeam
