#include "discretization/text/name_pattern.hpp"

#include <algorithm>
#include <cstddef>

namespace mixbeam {

bool has_wildcard(const std::string& text) { return text.find('*') != std::string::npos; }

bool matches(const std::string& pattern, const std::string& name) {
  // After a mismatch only the last `*` has to give way: it takes one character more.
  std::size_t p = 0, n = 0, star = std::string::npos, taken_from = 0;
  while (n < name.size()) {
    if (p < pattern.size() && pattern[p] == '*') {
      star = p++;
      taken_from = n;
    } else if (p < pattern.size() && pattern[p] == name[n]) {
      ++p;
      ++n;
    } else if (star != std::string::npos) {
      p = star + 1;
      n = ++taken_from;
    } else {
      return false;
    }
  }
  return std::all_of(pattern.begin() + static_cast<std::ptrdiff_t>(p), pattern.end(), [](char c) { return c == '*'; });
}

std::vector<std::string> names_meant(const std::string& text, const std::vector<std::string>& names) {
  if (std::find(names.begin(), names.end(), text) != names.end()) return {text};
  std::vector<std::string> meant;
  if (!has_wildcard(text)) return meant;
  std::copy_if(names.begin(), names.end(), std::back_inserter(meant),
               [&](const std::string& name) { return matches(text, name); });
  return meant;
}

}  // namespace mixbeam
