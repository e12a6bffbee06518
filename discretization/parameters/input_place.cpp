#include "discretization/parameters/input_place.hpp"

#include "discretization/text/message_text.hpp"
#include "discretization/text/number_text.hpp"

#include <cmath>
#include <stdexcept>

namespace mixbeam {
namespace {

/// `s and x`
std::string listed(const std::vector<std::string>& variables) {
  if (variables.empty()) return "numbers";
  std::string text;
  for (std::size_t i = 0; i < variables.size(); ++i) {
    if (i > 0) text += i + 1 == variables.size() ? " and " : ", ";
    text += variables[i];
  }
  return text;
}

}  // namespace

Expression checked_formula(const std::string& text, const std::vector<std::string>& variables,
                           const InputPlace& place) {
  try {
    return Expression(text, variables);
  } catch (const std::invalid_argument& error) {
    throw place.error("value \"" + excerpt(text) + "\" is no formula: " + excerpt(error.what()) +
                      "; allowed: a formula of " + listed(variables) +
                      " with + - * / ^ ( ), pi, e, sin, cos, tan, exp, ln, sqrt, abs, min, max, ...");
  }
}

void check_finite(const Expression& formula, const std::vector<std::string>& variables,
                  const std::vector<std::vector<double>>& samples, const InputPlace& place) {
  for (const std::vector<double>& sample : samples) {
    const double value = formula(sample);
    if (std::isfinite(value)) continue;
    std::string at;
    for (std::size_t i = 0; i < variables.size(); ++i)
      at += (i == 0 ? "" : ", ") + variables[i] + " = " + shortest(sample[i]);
    throw place.error("value \"" + excerpt(formula.text()) + "\" is " + shortest(value) + " at " + at +
                      "; allowed: a formula that is finite everywhere");
  }
}

}  // namespace mixbeam
