/// Text by a printf format: what the reports of this program are made of.
#pragma once

#include <cstdio>
#include <string>

namespace mixbeam {

/// The formatted text, cut behind 255 characters.
template <class... Values>
std::string text_of(const char* format, Values... values) {
  char line[256];
  std::snprintf(line, sizeof line, format, values...);
  return line;
}

}  // namespace mixbeam
