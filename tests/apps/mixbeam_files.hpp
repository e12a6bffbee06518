/// Scenes and result files for the tests of the program `mixbeam`.
#pragma once

#include "apps/common/run/scene_file.hpp"
#include "discretization/parameters/parameter_file.hpp"
#include "process.hpp"
#include "tests/support/hdf5.hpp"

#include <libxml/parser.h>

#include <memory>

namespace mixbeam {

/// Number of completed steps that a file holds in full: those in the time series, every one with its fields and state.
inline int complete_steps(const FileContents& contents) {
  int steps = 0;
  for (const auto& [path, bytes] : contents) {
    const std::string ending = "/state/interior";
    if (path.rfind("steps/", 0) == 0 && path.size() > ending.size() &&
        path.compare(path.size() - ending.size(), ending.size(), ending) == 0)
      ++steps;
  }
  const auto series = contents.find("monitor/step");
  const int in_series = series == contents.end() ? 0 : std::stoi(series->second);  // it stands before the bytes
  return steps == in_series ? steps : -1;
}

/// What `mixbeam` prints with these arguments.
inline std::string output_of(const std::vector<std::string>& arguments) {
  const TemporaryFolder folder;
  const Ended ended = run_process(program("mixbeam"), arguments, folder);
  EXPECT_EQ(ended.exit_code, 0) << ended.err;
  return ended.out;
}

using XmlDocument = std::unique_ptr<xmlDoc, void (*)(xmlDocPtr)>;
/// Empty for a text that is no XML.
inline XmlDocument xml_document(const std::string& text) {
  return {xmlReadMemory(text.data(), static_cast<int>(text.size()), "", nullptr, XML_PARSE_NOERROR), xmlFreeDoc};
}

/// A scene file, in XML or YAML, with more in it: entries of `yaml` are added or take the place of those of the same
/// name, after the lists `removed` have gone.
inline std::string with(const std::string& scene, const std::string& yaml,
                        const std::vector<std::string>& removed = {}) {
  ApplicationDefinition definition;
  definition.study = ListSpec("anything").without_checks();
  definition.batch = definition.study;
  definition.answers_quantities = true;
  const ListSpec root = root_spec(definition);
  const XmlParameters whole = parse_parameters(scene, "scene", root), more = parse_yaml(yaml, "more.yaml", root);
  for (const std::string& list : removed) EXPECT_TRUE(whole.list->remove(list, false));
  whole.list->setParameters(*more.list);
  return xml_text(*whole.list);
}

/// A file of the folder with the scene.
inline std::string scene_in(const fs::path& folder, const std::string& text) {
  write_text(folder / "scene.xml", text);
  return (folder / "scene.xml").string();
}

/// The scene of an application with more in it, as a file of the folder.
inline std::string scene_with(const std::string& application, const std::string& yaml, const fs::path& folder) {
  return scene_in(folder, with(scene_of(application), yaml));
}

}  // namespace mixbeam
