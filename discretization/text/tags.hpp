/// Tags of a text before a parser sees it.
#pragma once

#include <string>

namespace mixbeam {

/// The line of the first tag with more attributes than that, 0 where there is none. Reads tags and what is between
/// quotes in them, nothing else: what is not well-formed is left to the parser.
int line_of_tag_with_more(int attributes, const std::string& text);

}  // namespace mixbeam
