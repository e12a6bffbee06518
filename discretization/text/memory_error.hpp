/// What is thrown where memory is not there.
#pragma once

#include <cstring>
#include <exception>
#include <new>

namespace mixbeam {

/// Kokkos throws a std::runtime_error with a text of its own, which names the view and its size.
inline bool is_out_of_memory(const std::exception& error) {
  return dynamic_cast<const std::bad_alloc*>(&error) != nullptr ||
         std::strstr(error.what(), "failed to allocate memory") != nullptr;
}

}  // namespace mixbeam
