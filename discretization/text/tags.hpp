/// XML as text: escaping attributes, and scanning tags before a parser sees them.
#pragma once

#include <string>

namespace mixbeam {

/// Escapes a text for use as the value of an attribute.
std::string xml_escaped(const std::string& text);

/// Line of the first tag with more than `attributes` attributes; 0: none. Scans only tags and their quotes; ill-formed
/// text is left to the parser.
int line_of_tag_with_more(int attributes, const std::string& text);

}  // namespace mixbeam
