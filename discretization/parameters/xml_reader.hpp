/// Reading a parameter file in the Teuchos XML format, more strictly than Teuchos does: that reader takes `abc` for
/// the number 0, lets the last of two equal names win, and knows no line numbers.
#pragma once

#include "discretization/parameters/source.hpp"

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

/// Reads `<ParameterList name="..">` with `<Parameter name=".." type=".." value=".."/>` and nested lists; types bool,
/// int, double, string, Array(int), Array(double), Array(string). Throws InputError with file and line.
XmlParameters read_xml(const std::string& file);

/// The same for a text; `file` appears in the messages.
XmlParameters parse_xml(const std::string& text, const std::string& file, Mistakes mistakes = Mistakes::thrown);

}  // namespace mixbeam
