/// Names that users write: in messages, as patterns, and misspelt.
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

/// The candidate that differs from `name` in the fewest typing slips (a letter inserted, dropped, replaced, or two
/// neighbours exchanged; upper and lower case count as equal), else the one that other programs call so (`Nodes` for
/// Points), else the only one of more words that holds it (`frequency` for natural frequency), else one that begins
/// like it. Empty when nothing resembles `name`, and when it is in several.
std::string nearest_name(const std::string& name, const std::vector<std::string>& candidates);

/// `; did you mean "Elements"?`, or nothing when no candidate resembles `name`.
std::string did_you_mean(const std::string& name, const std::vector<std::string>& candidates);

/// Of a line and a column (characters of UTF-8), each counted from 1.
std::size_t offset_of(const std::string& text, int line, int column);

/// The line of a text around `offset` and a caret below that place, as further lines of a message.
std::string marked_line(const std::string& text, std::size_t offset);

/// In lower case, letters of ASCII only.
std::string lower_case(std::string text);

/// What a pattern may hold, for messages and pages.
inline const std::string kWildcards =
    "* stands for any characters, ? for one, [abc] or [a-c] for one of these, [!abc] for another";

/// Whether `text` is a pattern: it contains a `*`, which stands for any characters, also none, a `?`, which stands for
/// one, or characters in brackets, which stand for one of them.
bool has_wildcard(const std::string& text);

/// Whether the whole name fits the pattern. Takes time in proportion to both lengths at worst.
bool matches(const std::string& pattern, const std::string& name);

/// What `text` stands for among `names`: the name itself if it is one of them (even if it contains `*`), else every
/// name that fits it as a pattern, in their order. Empty: nothing.
std::vector<std::string> names_meant(const std::string& text, const std::vector<std::string>& names);

}  // namespace mixbeam
