/// Parameter files in XML and in YAML: reading either, writing both.
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
  Teuchos::RCP<Teuchos::ParameterList> list;  ///< bears the name of the root, or of the file where that has none
  ParameterSource source;                     ///< file and place of every entry
  std::string text;                           ///< the file itself, to be kept with the results
  std::vector<Comment> comments{};            ///< of XML, in the order of the file
};

enum class FileFormat { xml, yaml };

/// XML where the first character is `<`, with which no scene in YAML begins; else by the ending of the name (.xml,
/// .yaml, .yml), whatever its case; another name: YAML.
FileFormat format_of(const std::string& file, const std::string& text = "");

/// Reads a file in either format. Throws InputError with file and line. `spec` says which types are meant in YAML.
XmlParameters read_parameters(const std::string& file, const ListSpec& spec, Mistakes mistakes = Mistakes::thrown);

/// The same for a text; `file` appears in the messages.
XmlParameters parse_parameters(const std::string& text, const std::string& file, const ListSpec& spec,
                               Mistakes mistakes = Mistakes::thrown);

/// Reads a text in the XML format of Teuchos, `<ParameterList name="..">` with `<Parameter name=".." type=".."
/// value=".."/>` and nested lists; types bool, int, double, string, Array(int), Array(double), Array(string). More
/// strictly than Teuchos does: that reader takes `abc` for the number 0, lets the last of two equal names win, and
/// knows no line numbers. Throws InputError with file and line; `file` appears in the messages.
XmlParameters parse_xml(const std::string& text, const std::string& file, Mistakes mistakes = Mistakes::thrown);

/// Entry at the root of a YAML file with the name of the list, which stands in an attribute in XML.
inline constexpr const char* kRootName = "Name";

/// Reads a text in YAML: a map for each list, a scalar or a sequence for each parameter.
///
///     Scene:
///       Points: {wall: [0, 0, 0], tip: [1, 0, 0]}
///
/// Returns the list that an XML file of the same content gives. The declaration decides what a scalar without quotes
/// is: a word where a word is declared (1, no, null), else a number or a switch; in quotes it is a word. What does not
/// fit its declaration, or has none, keeps the type that it shows, and validate() reports what is wrong with it. Throws
/// InputError with file, line and column for what is no YAML, several documents, keys given twice or merged (<<),
/// tags, control characters, lists nested too deep and aliases that unfold to too much.
XmlParameters parse_yaml(const std::string& text, const std::string& file, const ListSpec& spec,
                         Mistakes mistakes = Mistakes::thrown);

/// As a file in XML. Numbers have the fewest digits that read back as the same bits.
std::string xml_text(const Teuchos::ParameterList& list);

/// As a file in YAML called `file`, with its comments.
std::string yaml_text(const XmlParameters& parameters, const ListSpec& spec, const std::string& file);

}  // namespace mixbeam
