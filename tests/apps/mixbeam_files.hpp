/// Scenes and result files for the tests of the program `mixbeam`.
#pragma once

#include "apps/common/run/scene_file.hpp"
#include "discretization/parameters/parameter_file.hpp"
#include "process.hpp"

#include <hdf5.h>
#include <libxml/parser.h>

#include <map>
#include <memory>
#include <optional>

namespace mixbeam {

/// Every dataset and attribute of a result file but those that describe how it came about (/properties): path -> bytes.
using FileContents = std::map<std::string, std::string>;

namespace h5 {

inline std::string bytes_of_dataset(hid_t id) {
  const hid_t type = H5Dget_type(id), space = H5Dget_space(id);
  const auto count = static_cast<std::size_t>(H5Sget_simple_extent_npoints(space));
  std::string bytes(count * H5Tget_size(type), '\0');
  if (!bytes.empty() && H5Dread(id, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes.data()) < 0) bytes = "unreadable";
  H5Sclose(space);
  H5Tclose(type);
  return std::to_string(count) + ":" + bytes;
}

inline std::string bytes_of_attribute(hid_t object, const char* name) {
  const hid_t id = H5Aopen(object, name, H5P_DEFAULT), type = H5Aget_type(id);
  std::string bytes(H5Tget_size(type), '\0');
  if (H5Aread(id, type, bytes.data()) < 0) bytes = "unreadable";
  H5Tclose(type);
  H5Aclose(id);
  return bytes;
}

struct Visit {
  FileContents& contents;
  std::string path;
};

inline herr_t on_attribute(hid_t object, const char* name, const H5A_info_t*, void* data) {
  const Visit& visit = *static_cast<Visit*>(data);
  visit.contents[visit.path + "@" + name] = bytes_of_attribute(object, name);
  return 0;
}

inline herr_t on_object(hid_t root, const char* name, const H5O_info_t* info, void* data) {
  FileContents& contents = static_cast<Visit*>(data)->contents;
  const std::string path = name;
  if (path == "properties") return 0;
  const hid_t id = H5Oopen(root, name, H5P_DEFAULT);
  contents[path] = info->type == H5O_TYPE_DATASET ? bytes_of_dataset(id) : "group";
  Visit visit{contents, path};
  H5Aiterate2(id, H5_INDEX_NAME, H5_ITER_INC, nullptr, on_attribute, &visit);
  H5Oclose(id);
  return 0;
}

}  // namespace h5

/// None when the file cannot be read.
inline std::optional<FileContents> contents_of(const fs::path& file) {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  const hid_t id = H5Fopen(file.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  if (id < 0) return {};
  FileContents contents;
  h5::Visit visit{contents, ""};
  const herr_t status = H5Ovisit2(id, H5_INDEX_NAME, H5_ITER_INC, h5::on_object, &visit, H5O_INFO_BASIC);
  H5Fclose(id);
  if (status < 0) return {};
  return contents;
}

/// What differs between two files, by name; empty when every bit is the same.
inline std::string differences(const FileContents& a, const FileContents& b) {
  std::string text;
  for (const auto& [path, bytes] : a)
    if (b.count(path) == 0)
      text += path + " is missing\n";
    else if (b.at(path) != bytes)
      text += path + " differs\n";
  for (const auto& [path, bytes] : b)
    if (a.count(path) == 0) text += path + " is new\n";
  return text;
}

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
  const int in_series = series == contents.end() ? 0 : std::stoi(series->second);  // the count stands before the bytes
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
