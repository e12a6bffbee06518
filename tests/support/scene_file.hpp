/// Scene files of the tests: texts in YAML, read as the program reads them.
#pragma once

#include "discretization/checks/expected_values.hpp"
#include "discretization/parameters/parameter_file.hpp"
#include "discretization/parameters/validate.hpp"
#include "discretization/reading/read_scene.hpp"

#include <string>

namespace mixbeam {

/// Declaration of a file of a scene with expected values; the other lists belong to the applications.
inline const ListSpec& scene_file_spec() {
  static const ListSpec spec = [] {
    ListSpec root("file");
    root.add_list("Scene", scene_spec(), Presence::optional);
    root.add_list("Expected", expected_values_spec(), Presence::optional);
    root.add_list("Study", ListSpec("anything").without_checks());
    return root;
  }();
  return spec;
}

/// A text in YAML or in XML, in which the first character is `<`, called "scene" in messages.
inline XmlParameters parsed(const std::string& text, const std::string& folder = "") {
  const bool is_xml = format_of("", text) == FileFormat::xml;
  return parse_parameters(text, folder + (is_xml ? "scene.xml" : "scene.yaml"), scene_file_spec());
}

/// Whole and checked, as read_scene() gives it.
inline Scene scene_of_text(const std::string& text) {
  XmlParameters file = parsed(text);
  return read_scene(file.list->sublist("Scene"), file.source);
}

}  // namespace mixbeam
