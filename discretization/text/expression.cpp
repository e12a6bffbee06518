#include "discretization/text/expression.hpp"

#include "kernels/math/constants.hpp"

#include <muParser.h>

#include <cmath>
#include <stdexcept>

namespace mixbeam {

namespace {

constexpr double kEuler = 2.71828182845904523536;
constexpr std::size_t kLongestFormula = 10000;  // a formula longer than that is a mistake, and deep nesting costs stack

double two_argument_arctangent(double y, double x) { return std::atan2(y, x); }

/// muParser would change its variables.
void refuse_assignments(const std::string& text) {
  for (std::size_t i = text.find('='); i != std::string::npos; i = text.find('=', i + 1)) {
    const bool follows = i > 0 && std::string("<>!=").find(text[i - 1]) != std::string::npos;
    if (follows || (i + 1 < text.size() && text[i + 1] == '=')) continue;
    throw std::invalid_argument("it has an assignment; a comparison is written ==");
  }
}

}  // namespace

struct Expression::Formula {
  std::string text;
  std::vector<double> values;
  mu::Parser parser;
};

Expression::Expression() : Expression("0", {}) {}

Expression::Expression(const std::string& text, const std::vector<std::string>& variables)
    : formula_(std::make_shared<Formula>()) {
  if (text.size() > kLongestFormula) throw std::invalid_argument("the formula is longer than 10000 characters");
  refuse_assignments(text);
  formula_->text = text;
  formula_->values.assign(variables.size(), 0.0);
  try {
    mu::Parser& parser = formula_->parser;
    parser.ClearConst();
    parser.DefineConst("pi", kPi);
    parser.DefineConst("e", kEuler);
    parser.DefineFun("atan2", two_argument_arctangent);
    for (std::size_t i = 0; i < variables.size(); ++i) parser.DefineVar(variables[i], &formula_->values[i]);
    parser.SetExpr(text);
    parser.Eval();  // parses; evaluation itself raises no error
  } catch (const mu::Parser::exception_type& error) {
    throw std::invalid_argument(error.GetMsg());
  }
  if (formula_->parser.GetNumResults() != 1) throw std::invalid_argument("the formula gives more than one value");
}

double Expression::operator()(const std::vector<double>& values) const {
  if (values.size() != formula_->values.size())
    throw std::invalid_argument("formula \"" + formula_->text + "\": wrong number of variables");
  formula_->values = values;  // same size: the addresses that the parser holds stay
  try {
    return formula_->parser.Eval();
  } catch (const mu::Parser::exception_type& error) {
    throw std::invalid_argument("formula \"" + formula_->text + "\": " + error.GetMsg());
  }
}

double Expression::operator()(double value) const { return (*this)(std::vector<double>{value}); }

const std::string& Expression::text() const { return formula_->text; }

}  // namespace mixbeam
