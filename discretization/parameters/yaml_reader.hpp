/// Reading a parameter file in YAML: a map for each list, a scalar or a sequence for each parameter.
///
///     Scene:
///       Points: {wall: [0, 0, 0], tip: [1, 0, 0]}
#pragma once

#include "discretization/parameters/spec.hpp"
#include "discretization/parameters/xml_reader.hpp"

#include <string>

namespace mixbeam {

/// Entry at the root of a YAML file with the name of the list, which stands in an attribute in XML.
inline constexpr const char* kRootName = "Name";

/// The list that an XML file of the same content gives. The declaration decides what a scalar without quotes is: a word
/// where a word is declared (1, no, null), else a number or a switch; in quotes it is a word. What does not fit its
/// declaration, or has none, keeps the type that it shows, and validate() reports what is wrong with it. Throws
/// InputError with file, line and column for what is no YAML, several documents, keys given twice or merged (<<),
/// tags, control characters, lists nested too deep and aliases that unfold to too much.
XmlParameters parse_yaml(const std::string& text, const std::string& file, const ListSpec& spec,
                         Mistakes mistakes = Mistakes::thrown);

}  // namespace mixbeam
