/// The user's list "Status Tests", tried before the run.
#pragma once

#include <Teuchos_ParameterList.hpp>

#include <string>

namespace mixbeam {

/// What NOX says against the list, in one line; empty if it can build the tests. NOX checks names, types and test types
/// itself, but only when it builds the tests, and in a form that is no message for a user.
std::string problem_of_status_tests(const Teuchos::ParameterList& tests);

}  // namespace mixbeam
