/// What is thrown where memory is not there.
#pragma once

#include <cstring>
#include <exception>
#include <new>
#include <string>

namespace mixbeam {

/// Kokkos and Tpetra throw texts of their own, which name the view and its size.
inline bool is_out_of_memory(const std::exception& error) {
  return dynamic_cast<const std::bad_alloc*>(&error) != nullptr ||
         std::strstr(error.what(), "failed to allocate memory") != nullptr ||
         std::strstr(error.what(), "insufficient memory") != nullptr;
}

/// Message of an error: its text, but of std::bad_alloc itself, which has none.
inline std::string reason_of(const std::exception& error) {
  return std::strcmp(error.what(), std::bad_alloc().what()) == 0 ? "not enough memory" : error.what();
}

}  // namespace mixbeam
