#include "discretization/text/expression.hpp"

#include "discretization/text/message_text.hpp"
#include "kernels/math/constants.hpp"

#include <muParser.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <list>
#include <stdexcept>

namespace mixbeam {

namespace {

constexpr double kEuler = 2.71828182845904523536;
constexpr std::size_t kLongestFormula = 10000;  // longer ones are mistakes, and deep nesting costs stack

double two_argument_arctangent(double y, double x) { return std::atan2(y, x); }

/// Assignments would let muParser change its variables.
void refuse_assignments(const std::string& text) {
  for (std::size_t i = text.find('='); i != std::string::npos; i = text.find('=', i + 1)) {
    const bool follows = i > 0 && std::string("<>!=").find(text[i - 1]) != std::string::npos;
    if (follows || (i + 1 < text.size() && text[i + 1] == '=')) continue;
    throw std::invalid_argument("it has an assignment; a comparison is written ==");
  }
}

double radians(double degrees) { return degrees * (kPi / 180.0); }

void define_words(mu::Parser& parser) {
  parser.ClearConst();
  parser.DefineConst("pi", kPi);
  parser.DefineConst("e", kEuler);
  parser.DefineFun("atan2", two_argument_arctangent);
  parser.DefinePostfixOprt("deg", radians);
}

void check_text(const std::string& text) {
  if (text.size() > kLongestFormula) throw std::invalid_argument("the formula is longer than 10000 characters");
  refuse_assignments(text);
}

/// Callbacks of the parser for the names in one formula.
struct NameFinder {
  const FormulaNames& names;
  std::list<double> values{};  ///< a list: the parser holds their addresses

  static double* variable(const char* name, void* finder) {
    auto& self = *static_cast<NameFinder*>(finder);
    return &self.values.emplace_back(self.names.variable(name));
  }
  template <int axis>
  static double coordinate(void* finder, const char* point) {
    return static_cast<NameFinder*>(finder)->names.coordinate(axis, point);
  }
};

}  // namespace

struct Expression::Formula {
  std::string text;
  std::vector<double> values;
  mu::Parser parser;
};

Expression::Expression() = default;  // constructing an unused parser costs as much as reading ten parameters

Expression::Expression(const std::string& text, const std::vector<std::string>& variables)
    : formula_(std::make_shared<Formula>()) {
  check_text(text);
  formula_->text = text;
  formula_->values.assign(variables.size(), 0.0);
  try {
    mu::Parser& parser = formula_->parser;
    define_words(parser);
    for (std::size_t i = 0; i < variables.size(); ++i) parser.DefineVar(variables[i], &formula_->values[i]);
    parser.SetExpr(text);
    parser.Eval();  // parses; evaluation itself raises no error
  } catch (const mu::Parser::exception_type& error) {
    throw std::invalid_argument(error.GetMsg());
  }
  if (formula_->parser.GetNumResults() != 1) throw std::invalid_argument("the formula gives more than one value");
}

double Expression::operator()(const std::vector<double>& values) const {
  if (values.size() != (formula_ == nullptr ? 0 : formula_->values.size()))
    throw std::invalid_argument("formula \"" + text() + "\": wrong number of variables");
  if (formula_ == nullptr) return 0.0;
  formula_->values = values;  // same size: the parser's addresses stay valid
  try {
    return formula_->parser.Eval();
  } catch (const mu::Parser::exception_type& error) {
    throw std::invalid_argument("formula \"" + formula_->text + "\": " + error.GetMsg());
  }
}

double Expression::operator()(double value) const { return (*this)(std::vector<double>{value}); }

const std::string& Expression::text() const {
  static const std::string zero = "0";
  return formula_ == nullptr ? zero : formula_->text;
}

double value_of_formula(const std::string& text, const FormulaNames& names) {
  check_text(text);
  NameFinder finder{names};
  try {
    mu::Parser parser;
    define_words(parser);
    parser.DefineFunUserData("x", NameFinder::coordinate<0>, &finder, false);
    parser.DefineFunUserData("y", NameFinder::coordinate<1>, &finder, false);
    parser.DefineFunUserData("z", NameFinder::coordinate<2>, &finder, false);
    parser.SetVarFactory(NameFinder::variable, &finder);
    std::string quoted = text;  // XML and YAML use double quotes themselves
    if (text.find('"') == std::string::npos) std::replace(quoted.begin(), quoted.end(), '\'', '"');
    parser.SetExpr(quoted);
    const double value = parser.Eval();
    if (parser.GetNumResults() != 1) throw std::invalid_argument("the formula gives more than one value");
    return value;
  } catch (const mu::Parser::exception_type& error) {
    throw std::invalid_argument(excerpt(error.GetMsg()));
  }
}

std::vector<std::string> formula_functions() {
  mu::Parser parser;
  define_words(parser);
  std::vector<std::string> names;
  for (const auto& function : parser.GetFunDef()) names.push_back(function.first);
  return names;
}

std::string with_names_replaced(const std::string& text,
                                const std::function<std::string(const std::string& name)>& replacement) {
  const auto belongs = [](unsigned char c) { return std::isalnum(c) != 0 || c == '_' || c == '.'; };
  std::string result;
  for (std::size_t i = 0; i < text.size();) {
    const bool is_number = std::isdigit(static_cast<unsigned char>(text[i])) != 0 || text[i] == '.';
    const auto is_sign_of_exponent = [&](std::size_t at) {
      return is_number && at > i && (text[at] == '-' || text[at] == '+') &&
             (text[at - 1] == 'e' || text[at - 1] == 'E');
    };
    std::size_t end = i;
    while (end < text.size() && (belongs(text[end]) || is_sign_of_exponent(end))) ++end;
    const std::string word = text.substr(i, std::max<std::size_t>(end - i, 1));
    result += end > i && !is_number ? replacement(word) : word;
    i += word.size();
  }
  return result;
}

}  // namespace mixbeam
