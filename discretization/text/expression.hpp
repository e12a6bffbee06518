/// Formulas in scenes: functions such as a load along a member, a prescribed motion or a parametric curve, and
/// expressions evaluated once, for whose names the caller supplies values.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace mixbeam {

/// Formula in named variables, parsed once. Operators and functions are those of muParser (+ - * / ^ ?: sin cos tan
/// asin acos atan atan2 exp ln log10 sqrt abs min max ...), the constants are pi and e. Copies share the parsed formula
/// and must not be used by several threads at once.
class Expression {
 public:
  /// Constant zero.
  Expression();
  /// Throws std::invalid_argument that says what is wrong with the text and where; unknown names are errors too.
  Expression(const std::string& text, const std::vector<std::string>& variables);

  /// Value for the variables in the order of the constructor; may be infinite or NaN.
  double operator()(const std::vector<double>& values) const;
  double operator()(double value) const;  ///< formulas of one variable

  const std::string& text() const;

 private:
  struct Formula;
  std::shared_ptr<Formula> formula_;
};

/// Supplies values for the names in a formula; either function may throw std::invalid_argument or InputError.
struct FormulaNames {
  std::function<double(const std::string& name)> variable;
  std::function<double(int axis, const std::string& point)> coordinate;  ///< x("tip"): axis 0 of the point
};
/// Value of a formula like `L*sin(25 deg) + x("tip")`. Throws like Expression, and whatever `names` throws.
double value_of_formula(const std::string& text, const FormulaNames& names);

/// Names of all functions of formulas.
std::vector<std::string> formula_functions();

/// Replaces each name in a formula by `replacement(name)`, which returns the name itself to keep it.
std::string with_names_replaced(const std::string& text,
                                const std::function<std::string(const std::string& name)>& replacement);

}  // namespace mixbeam
