/// Where parameters came from: the file and the line of each, for error messages.
#pragma once

#include "discretization/errors.hpp"

#include <string>
#include <unordered_map>
#include <vector>

namespace mixbeam {

/// Names from the root (itself not included) down to a parameter or list: {"Scene", "Members", "shaft", "Elements"}.
using ParameterPath = std::vector<std::string>;

/// `Scene / Members / shaft / Elements`
std::string to_string(const ParameterPath& path);

/// `path` one level deeper.
ParameterPath child(ParameterPath path, const std::string& name);

class ParameterSource {
 public:
  /// Without a file name: a list that the program made itself.
  explicit ParameterSource(std::string file = "", std::string root_name = "");

  const std::string& file() const { return file_; }
  /// Name of the outermost list.
  const std::string& root_name() const { return root_name_; }

  void set_root_name(const std::string& name) { root_name_ = name; }
  void record(const ParameterPath& path, int line);
  void reserve(std::size_t entries) { lines_.reserve(entries); }

  /// Line of this very path, 0 if it was not in the file.
  int line(const ParameterPath& path) const;

  /// `scene.xml:12`; for something that is missing, the line of the innermost list around it.
  std::string where(const ParameterPath& path) const;

  /// `scene.xml:12: XML path "Scene / Members": <problem>`
  InputError error(const ParameterPath& path, const std::string& problem) const;

 private:
  std::string file_;
  std::string root_name_;
  std::unordered_map<std::string, int> lines_;
};

}  // namespace mixbeam
