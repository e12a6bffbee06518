/// Reads and writes parameter files in XML and YAML.
#pragma once

#include "discretization/parameters/source.hpp"
#include "discretization/parameters/spec.hpp"

#include <Teuchos_ParameterList.hpp>
#include <Teuchos_RCP.hpp>

#include <string>
#include <vector>

namespace mixbeam {

/// Nested lists; real files need less than ten.
inline constexpr std::size_t kDeepestLists = 64;

/// A comment and the entry that it belongs to.
struct Comment {
  enum class Place {
    before,  ///< in lines of its own
    behind,  ///< in the last line of the entry
    end      ///< behind the last entry of this list
  };
  Place place;
  ParameterPath path;
  std::string text;
};

struct XmlParameters {
  Teuchos::RCP<Teuchos::ParameterList> list;  ///< named after the root, else after the file
  ParameterSource source;                     ///< file and place of every entry
  std::string text;                           ///< the file itself, to be kept with the results
  std::vector<Comment> comments{};            ///< XML only, in the order of the file
};

enum class FileFormat { xml, yaml };

/// Format of a file: XML if the first character is `<`, with which no scene in YAML begins; else by its extension
/// (.xml, .yaml, .yml, in any case); with another one YAML, or XML if the text is empty.
FileFormat format_of(const std::string& file, const std::string& text = "");

/// Reads a file in either format. Throws InputError with file and line. `spec` resolves the types of YAML scalars.
XmlParameters read_parameters(const std::string& file, const ListSpec& spec, Mistakes mistakes = Mistakes::thrown);

/// Reads a text in either format; `file` appears in the messages.
XmlParameters parse_parameters(const std::string& text, const std::string& file, const ListSpec& spec,
                               Mistakes mistakes = Mistakes::thrown);

/// Reads a text in the XML format of Teuchos, `<ParameterList name="..">` with `<Parameter name=".." type=".."
/// value=".."/>` and nested lists; types bool, int, double, string, Array(int), Array(double), Array(string). Stricter
/// than Teuchos, which reads `abc` as the number 0, keeps the last of two equal names, and knows no line numbers.
/// Throws InputError with file and line; `file` appears in the messages.
XmlParameters parse_xml(const std::string& text, const std::string& file, Mistakes mistakes = Mistakes::thrown);

/// Entry at the root of a YAML file that names the list; in XML an attribute does.
inline constexpr const char* kRootName = "Name";

/// Reads a text in YAML: a map for each list, a scalar or a sequence for each parameter.
///
///     Scene:
///       Points: {wall: [0, 0, 0], tip: [1, 0, 0]}
///
/// Returns the same list as an XML file of the same content. The declaration decides the type of an unquoted scalar:
/// text where text is declared (1, no, null), else a number or a boolean; a quoted scalar is text. A value that does
/// not fit its declaration, or has none, keeps its apparent type, and validate() reports it. Throws InputError with
/// file, line and column for ill-formed YAML, several documents, keys given twice or merged (<<), tags, control
/// characters, lists nested too deep and aliases that expand too far.
XmlParameters parse_yaml(const std::string& text, const std::string& file, const ListSpec& spec,
                         Mistakes mistakes = Mistakes::thrown);

/// Text of a file in XML. Numbers have the fewest digits that read back as the same bits.
std::string xml_text(const Teuchos::ParameterList& list);

/// Text of a file in YAML called `file`, with its comments.
std::string yaml_text(const XmlParameters& parameters, const ListSpec& spec, const std::string& file);

}  // namespace mixbeam
