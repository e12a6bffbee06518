/// Numbers with a given number of digits or a given width, for the terminal.
#pragma once

#include <string>

namespace mixbeam {

/// As printf writes it, whatever the length.
[[gnu::format(printf, 1, 2)]] std::string formatted(const char* format, ...);

}  // namespace mixbeam
