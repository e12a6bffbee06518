/// Text by a printf format: what the reports of this program are made of.
#pragma once

#include <cstdio>
#include <string>
#include <type_traits>

namespace mixbeam {

/// Zero has no sign in a report.
template <class Value>
Value without_sign_of_zero(Value value) {
  if constexpr (std::is_floating_point_v<Value>) return value + Value{0};
  return value;
}

/// The formatted text, truncated after 255 characters.
template <class... Values>
std::string text_of(const char* format, Values... values) {
  char line[256];
  std::snprintf(line, sizeof line, format, without_sign_of_zero(values)...);
  return line;
}

}  // namespace mixbeam
