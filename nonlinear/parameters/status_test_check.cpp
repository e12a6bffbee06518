#include "nonlinear/parameters/status_test_check.hpp"

#include <NOX_StatusTest_Generic.H>
// needs the header above
#include <NOX_StatusTest_Factory.H>
#include <NOX_Utils.H>

#include <exception>
#include <sstream>

namespace mixbeam {

namespace {

bool begins_with(const std::string& line, const std::string& beginning) { return line.rfind(beginning, 0) == 0; }

/// Lines that Teuchos puts around a message: the place in its own source, and how often it has thrown.
bool is_decoration(const std::string& line) {
  return begins_with(line, "Throw number") || begins_with(line, "Throw test that evaluated") ||
         (line.find(".C:") != std::string::npos && line.back() == ':') ||
         (line.find(".hpp:") != std::string::npos && line.back() == ':');
}

std::string one_line(const std::string& message) {
  std::istringstream lines(message);
  std::string result;
  for (std::string line; std::getline(lines, line);) {
    const std::size_t begin = line.find_first_not_of(" \t");
    if (begin == std::string::npos || is_decoration(line)) continue;
    result += (result.empty() ? "" : " ") + line.substr(begin);
  }
  return result;
}

}  // namespace

std::string problem_of_status_tests(const Teuchos::ParameterList& tests) {
  Teuchos::ParameterList tried(tests);  // NOX fills in defaults
  const NOX::Utils silent;
  try {
    NOX::StatusTest::buildStatusTests(tried, silent);
  } catch (const std::exception& error) {
    return one_line(error.what());
  } catch (const char* error) {  // NOX throws texts too
    return error;
  }
  return "";
}

}  // namespace mixbeam
