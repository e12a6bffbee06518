/// Strict reading of numbers: the whole text must be one number, independent of the locale.
#pragma once

#include <string>

namespace mixbeam {

/// What went wrong; empty if nothing.
using Problem = std::string;

/// `12`, `+12`, `-12`.
Problem parse_number(const std::string& text, int& value);

/// `1`, `1.5`, `-1e-3`, `inf`, `nan`: whether the last two make sense is decided by the parameter's range.
Problem parse_number(const std::string& text, double& value);

/// Without blanks at both ends.
std::string trimmed(const std::string& text);

}  // namespace mixbeam
