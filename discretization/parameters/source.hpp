/// Where parameters came from: the file and the place of each in it, for error messages.
#pragma once

#include "discretization/text/errors.hpp"

#include <map>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

namespace mixbeam {

/// Names from the root (itself not included) down to a parameter or list: {"Scene", "Members", "shaft", "Elements"}.
using ParameterPath = std::vector<std::string>;

/// `Scene / Members / shaft / Elements`
std::string to_string(const ParameterPath& path);

/// `path` one level deeper.
ParameterPath child(ParameterPath path, const std::string& name);

/// `scene` of `folder/scene.yaml`.
std::string name_of_file(const std::string& file);

class ParameterSource {
 public:
  /// Without a file name: a list that the program made itself.
  explicit ParameterSource(std::string file = "", std::string root_name = "");

  const std::string& file() const { return file_; }
  /// Name of the outermost list.
  const std::string& root_name() const { return root_name_; }

  void set_root_name(const std::string& name) { root_name_ = name; }
  /// Language of the file, `XML`, for messages.
  void set_language(const std::string& name) { language_ = name; }
  /// What the language of the file calls a list and a parameter.
  std::string list_word() const { return language_ == "YAML" ? "map" : "ParameterList"; }
  std::string parameter_word() const { return language_ == "YAML" ? "value" : "Parameter"; }
  /// Remembers the place of an entry. Throws InputError if there was one of this path before: names in a list differ.
  /// `column`: 0 where it says nothing.
  void record(const ParameterPath& path, int line, int column = 0);
  /// Of what comes from another file: `where` as messages say it, "loads.csv:12".
  void record(const ParameterPath& path, const std::string& where);

  /// Texts of the files that the input names, by that name: readers take them instead of what is on the disk now.
  const std::map<std::string, std::string>& files() const { return files_; }
  void set_files(std::map<std::string, std::string> files) { files_ = std::move(files); }

  /// Line of this very path, 0 if it was not in the file.
  int line(const ParameterPath& path) const;

  /// `scene.xml:12`, `scene.yaml:12:3`; for something that is missing, the place of the innermost list around it.
  std::string where(const ParameterPath& path) const;

  /// `scene.xml:12: XML path "Scene / Members": <remark>`
  std::string message(const ParameterPath& path, const std::string& remark) const;
  /// The same as an error.
  InputError error(const ParameterPath& path, const std::string& problem) const;

 private:
  std::string file_;
  std::string root_name_;
  std::string language_ = "XML";
  struct Position {
    int line = 0, column = 0;
  };
  std::unordered_map<std::string, Position> positions_;
  std::unordered_map<std::string, std::string> elsewhere_;

  Position position(const ParameterPath& path) const;
  std::string text_of(const Position& position) const;
  std::map<std::string, std::string> files_;
};

}  // namespace mixbeam
