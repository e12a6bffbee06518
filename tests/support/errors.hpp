/// What an action throws.
#pragma once

#include <string>

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

}  // namespace mixbeam
