/// Parameter files in XML and in YAML: reading either, writing both.
#pragma once

#include "discretization/parameters/spec.hpp"
#include "discretization/parameters/xml_reader.hpp"

#include <Teuchos_ParameterList.hpp>

#include <string>

namespace mixbeam {

enum class FileFormat { xml, yaml };

/// XML where the first character is `<`, with which no scene in YAML begins; else by the ending of the name (.xml,
/// .yaml, .yml), whatever its case; another name: YAML.
FileFormat format_of(const std::string& file, const std::string& text = "");

/// Reads a file in either format. Throws InputError with file and line. `spec` says which types are meant in YAML.
XmlParameters read_parameters(const std::string& file, const ListSpec& spec, Mistakes mistakes = Mistakes::thrown);

/// The same for a text; `file` appears in the messages.
XmlParameters parse_parameters(const std::string& text, const std::string& file, const ListSpec& spec,
                               Mistakes mistakes = Mistakes::thrown);

/// As a file in XML. Numbers have the fewest digits that read back as the same bits.
std::string xml_text(const Teuchos::ParameterList& list);

/// As a file in YAML called `file`, with its comments.
std::string yaml_text(const XmlParameters& parameters, const ListSpec& spec, const std::string& file);

}  // namespace mixbeam
