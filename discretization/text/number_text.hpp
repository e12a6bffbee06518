/// Numbers as text and back, independent of the locale.
#pragma once

#include <array>
#include <string>
#include <vector>

namespace mixbeam {

/// What went wrong; empty if nothing.
using Problem = std::string;

/// `12`, `+12`, `-12`; the whole text must be the number.
Problem parse_number(const std::string& text, int& value);

/// `1`, `1.5`, `-1e-3`, `inf`, `nan`: whether the last two make sense is decided by the parameter's range.
Problem parse_number(const std::string& text, double& value);

/// What is usually meant by a text that is no number: `; did you mean 0.3?` for "0,3".
std::string number_hint(const std::string& text);

/// Shortest text that reads back as the same number.
std::string shortest(double value);

/// With so many significant digits at most, like "%.3g".
std::string rounded(double value, int digits);

/// `(1, 0, 0.5)`
std::string to_text(const std::array<double, 3>& vector);

/// Without blanks at both ends.
std::string trimmed(const std::string& text);
/// Without their ends; none of an empty text.
std::vector<std::string> lines_of(const std::string& text);

}  // namespace mixbeam
