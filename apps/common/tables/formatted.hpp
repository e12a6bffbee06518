/// Numbers with a given number of digits or a given width, for the terminal.
#pragma once

#include <string>
#include <type_traits>

namespace mixbeam {

/// Prints as printf writes it, whatever the length.
std::string printed(const char* format, ...);

/// Prints likewise, but zero has no sign.
template <class... Values>
std::string formatted(const char* format, Values... values) {
  const auto without_sign_of_zero = [](auto value) {
    if constexpr (std::is_floating_point_v<decltype(value)>) return value + decltype(value){0};
    return value;
  };
  return printed(format, without_sign_of_zero(values)...);
}

}  // namespace mixbeam
