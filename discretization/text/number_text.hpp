/// Numbers as text and back, independent of the locale.
#pragma once

#include <array>
#include <string>
#include <vector>

namespace mixbeam {

/// Error message; empty: no error.
using Problem = std::string;

/// Parses `12`, `+12`, `-12`; the whole text must be the number.
Problem parse_number(const std::string& text, int& value);

/// Parses `1`, `1.5`, `-1e-3`, `inf`, `nan`; the parameter's range decides whether the last two are allowed.
Problem parse_number(const std::string& text, double& value);

/// Suggestion for a text that is not a number: `; did you mean 0.3?` for "0,3".
std::string number_hint(const std::string& text);

/// Shortest text that reads back as the same number.
std::string shortest(double value);

/// Rounds to at most `digits` significant digits, like "%.3g".
std::string rounded(double value, int digits);

/// `(1, 0, 0.5)`
std::string to_text(const std::array<double, 3>& vector);

/// Removes blanks at both ends.
std::string trimmed(const std::string& text);
/// Lines of a text, without their ends; an empty text has none.
std::vector<std::string> lines_of(const std::string& text);

}  // namespace mixbeam
