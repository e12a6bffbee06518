/// Names with wildcards: one load for all struts.
#pragma once

#include <string>
#include <vector>

namespace mixbeam {

/// Whether `text` is a pattern: it contains a `*`, which stands for any characters, also none.
bool has_wildcard(const std::string& text);

/// Whether the whole name fits the pattern. Takes time in proportion to both lengths at worst.
bool matches(const std::string& pattern, const std::string& name);

/// What `text` stands for among `names`: the name itself if it is one of them (even if it contains `*`), else every
/// name that fits it as a pattern, in their order. Empty: nothing.
std::vector<std::string> names_meant(const std::string& text, const std::vector<std::string>& names);

}  // namespace mixbeam
