/// Errors: the two ways in which a run can fail through no fault of the program, and lack of memory.
#pragma once

#include <cstring>
#include <exception>
#include <new>
#include <stdexcept>
#include <string>
#include <utility>

namespace mixbeam {

/// Invalid input; the message gives the place, what was found and what is allowed. Exit code 2.
class InputError : public std::runtime_error {
 public:
  /// `place`: key of the faulty entry (ParameterSource), used only to compare places; empty: unknown.
  explicit InputError(const std::string& text, std::string place = "")
      : std::runtime_error(text), place_(std::move(place)) {}

  const std::string& place() const { return place_; }

 private:
  std::string place_;
};

/// An error found only when a member is divided into elements, where its file is unknown; the caller that knows the
/// file adds the place (scene_file.hpp).
class MemberError : public InputError {
 public:
  /// `remark`: text after the name, such as ", element 1 of 4".
  MemberError(std::string member, const std::string& remark, const std::string& problem)
      : InputError("member \"" + member + "\"" + remark + ": " + problem), member_(std::move(member)) {}

  const std::string& member() const { return member_; }

 private:
  std::string member_;
};

/// The input is fine but no equilibrium was found. Exit code 3.
class ConvergenceError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Throws for functions that do not know where their numbers come from; a caller that does adds the place.
template <class Text>
void require(bool condition, const Text& otherwise) {
  if (!condition) throw std::invalid_argument(otherwise);
}

/// Whether memory ran out. Kokkos and Tpetra throw texts of their own, which name the view and its size.
inline bool is_out_of_memory(const std::exception& error) {
  return dynamic_cast<const std::bad_alloc*>(&error) != nullptr ||
         std::strstr(error.what(), "failed to allocate memory") != nullptr ||
         std::strstr(error.what(), "insufficient memory") != nullptr;
}

/// Message of an error; std::bad_alloc has no useful one of its own.
inline std::string reason_of(const std::exception& error) {
  return std::strcmp(error.what(), std::bad_alloc().what()) == 0 ? "not enough memory" : error.what();
}

inline constexpr int kInputErrorExitCode = 2;
inline constexpr int kConvergenceErrorExitCode = 3;

}  // namespace mixbeam
