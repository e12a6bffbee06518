/// Guessing what a misspelt name was meant to be.
#pragma once

#include <string>
#include <vector>

namespace mixbeam {

/// The candidate that differs from `name` in the fewest typing slips (a letter inserted, dropped, replaced, or two
/// neighbours exchanged; upper and lower case count as equal), else one that begins like it. Empty when nothing
/// resembles `name`.
std::string nearest_name(const std::string& name, const std::vector<std::string>& candidates);

/// `; did you mean "Elements"?`, or nothing when no candidate resembles `name`.
std::string did_you_mean(const std::string& name, const std::vector<std::string>& candidates);

}  // namespace mixbeam
