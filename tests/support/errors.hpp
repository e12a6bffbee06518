/// What an action throws.
#pragma once

#include "tests/support/text.hpp"

namespace mixbeam {

/// Message of the error of this kind that `action` throws; "no error" if it throws none.
template <class Error, class Action>
std::string error_of(const Action& action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

/// An error of this kind, with all `parts` in its message.
template <class Error, class Action>
void expect_error(const Action& action, const std::vector<std::string>& parts) {
  expect_in(error_of<Error>(action), parts);
}

}  // namespace mixbeam
