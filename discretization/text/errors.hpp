/// The two ways in which a run can fail through no fault of the program.
#pragma once

#include <stdexcept>
#include <string>
#include <utility>

namespace mixbeam {

/// What the user gave cannot be used; the message says where, what was seen and what is allowed. Exit code 2.
class InputError : public std::runtime_error {
 public:
  /// `place`: of what the user gave, in words that only compare places (ParameterSource); empty: not known.
  explicit InputError(const std::string& text, std::string place = "")
      : std::runtime_error(text), place_(std::move(place)) {}

  const std::string& place() const { return place_; }

 private:
  std::string place_;
};

/// The input is fine but no equilibrium was found. Exit code 3.
class ConvergenceError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// For functions that do not know where their numbers come from: whoever does catches it and names the place.
template <class Text>
void require(bool condition, const Text& otherwise) {
  if (!condition) throw std::invalid_argument(otherwise);
}

inline constexpr int kInputErrorExitCode = 2;
inline constexpr int kConvergenceErrorExitCode = 3;

}  // namespace mixbeam
