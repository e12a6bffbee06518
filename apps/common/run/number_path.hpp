/// Path of a number in a scene, as used by batch tables and the list "Gradient".
#pragma once

#include "discretization/text/number_text.hpp"

#include <algorithm>
#include <string>
#include <vector>

namespace mixbeam {

/// "Points/tip[1]": names of the lists and of the parameter; component of an array, -1 if the path has none, kNegative
/// for one that no array has, such as [-1].
struct NumberPath {
  static constexpr int kNegative = -2;
  std::vector<std::string> names{};
  int component = -1;

  std::string text() const {
    std::string all;
    for (const std::string& name : names) all += (all.empty() ? "" : "/") + name;
    return component < 0 ? all : all + "[" + std::to_string(component) + "]";
  }
};

/// Reads a path; a leading "Scene" is dropped.
inline NumberPath number_path(std::string text) {
  NumberPath path;
  const std::size_t bracket = text.rfind('[');
  if (bracket != std::string::npos && text.back() == ']' &&
      parse_number(text.substr(bracket + 1, text.size() - bracket - 2), path.component).empty()) {
    if (path.component < 0) path.component = NumberPath::kNegative;
    text.resize(bracket);
  }
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find('/', begin), text.size());
    path.names.push_back(trimmed(text.substr(begin, end - begin)));
    begin = end + 1;
  }
  if (path.names.size() > 1 && path.names.front() == "Scene") path.names.erase(path.names.begin());
  return path;
}

}  // namespace mixbeam
