/// Formulas that a user writes in a scene: a load along a member, a prescribed motion, a parametric curve.
#pragma once

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

}  // namespace mixbeam
