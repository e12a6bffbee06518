/// What measurements were made with.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace mixbeam {

/// Pairs of name and value: processor, cores, version, compiler, date, flags.
std::vector<std::pair<std::string, std::string>> machine_facts();

}  // namespace mixbeam
