/// XML as text: attributes that are written, and tags before a parser sees them.
#pragma once

#include <string>

namespace mixbeam {

/// As the value of an attribute.
std::string xml_escaped(const std::string& text);

/// The line of the first tag with more attributes than that, 0 where there is none. Reads tags and what is between
/// quotes in them, nothing else: what is not well-formed is left to the parser.
int line_of_tag_with_more(int attributes, const std::string& text);

}  // namespace mixbeam
