/// Formulas that a user writes in a scene: of a load along a member, a prescribed motion, a parametric curve; and those
/// that are evaluated once, with names that somebody else finds the values of.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace mixbeam {

/// A formula in named variables, parsed once. Operators and functions are those of muParser (+ - * / ^ ?: sin cos tan
/// asin acos atan atan2 exp ln log10 sqrt abs min max ...), the constants are pi and e. Copies share the parsed
/// formula; not for use by several threads at once.
class Expression {
 public:
  /// Always zero.
  Expression();
  /// Throws std::invalid_argument that says what is wrong with the text and where, including names it does not know.
  Expression(const std::string& text, const std::vector<std::string>& variables);

  /// Value for the variables in the order of the constructor. The result may be infinite or not a number, as the
  /// formula says.
  double operator()(const std::vector<double>& values) const;
  double operator()(double value) const;  ///< of the only variable

  const std::string& text() const;

 private:
  struct Formula;
  std::shared_ptr<Formula> formula_;
};

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
