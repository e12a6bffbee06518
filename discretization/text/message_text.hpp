/// Names that users write: in messages, misspelt, and as patterns.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace mixbeam {

/// More names than this do not help a reader.
constexpr std::size_t kLongestList = 24;

/// `"Start", "End", "Section"`; a longer list is cut and says how many names were left out.
std::string quoted_list(const std::vector<std::string>& names, std::size_t most = kLongestList);

/// The text itself, or its beginning when it is longer than a line; control characters become spaces.
std::string excerpt(const std::string& text);

/// Candidate that `name` probably means: the one that other programs call so (`Nodes` for Points), else the one with
/// the fewest typing slips (a letter inserted, dropped, replaced, or two neighbours exchanged; case is ignored), else
/// the only one of several words that contains it (`frequency` for natural frequency), else one that begins alike.
/// Empty if none resembles `name`, or if several contain it.
std::string nearest_name(const std::string& name, const std::vector<std::string>& candidates);

/// `; did you mean "Elements"?`, or nothing when no candidate resembles `name`.
std::string did_you_mean(const std::string& name, const std::vector<std::string>& candidates);

/// Offset of a line and a column (characters of UTF-8), each counted from 1.
std::size_t offset_of(const std::string& text, int line, int column);

/// The line of a text around `offset` and a caret below that place, as further lines of a message.
std::string marked_line(const std::string& text, std::size_t offset);

/// Converts to lower case, ASCII letters only.
std::string lower_case(std::string text);

/// Syntax of patterns, for messages and pages.
inline const std::string kWildcards =
    "* stands for any characters, ? for one, [abc] or [a-c] for one of these, [!abc] for another";

/// Whether `text` is a pattern: it contains a `*` (any characters, or none), a `?` (one character), or characters in
/// brackets (one of them).
bool has_wildcard(const std::string& text);

/// Whether the whole name matches the pattern. Takes time in proportion to the product of both lengths at worst.
bool matches(const std::string& pattern, const std::string& name);

/// Names that `text` stands for: itself if it is among `names` (even if it contains `*`), else every name that matches
/// it as a pattern, in their order. Empty: none.
std::vector<std::string> names_meant(const std::string& text, const std::vector<std::string>& names);

}  // namespace mixbeam
