/// Formulas that are evaluated once, with names that somebody else finds the values of.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace mixbeam {

/// Finds values for names that a formula uses; either may throw std::invalid_argument or InputError.
struct FormulaNames {
  std::function<double(const std::string& name)> variable;
  std::function<double(int axis, const std::string& point)> coordinate;  ///< x("tip"): axis 0 of the point
};
/// Value of a formula like `L*sin(25 deg) + x("tip")`. Throws as Expression, and what the finders throw.
double value_of_formula(const std::string& text, const FormulaNames& names);

/// Names of all functions of formulas.
std::vector<std::string> formula_functions();

/// The formula with each name replaced as `replacement` says, which returns the name itself where it stays.
std::string with_names_replaced(const std::string& text,
                                const std::function<std::string(const std::string& name)>& replacement);

}  // namespace mixbeam
