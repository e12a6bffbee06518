#include "discretization/text/expression.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace mixbeam {
namespace {

TEST(Expression, EvaluatesFormulasOfNamedVariables) {
  const Expression f("2*x^2 - sin(pi*y) + atan2(y, x)", {"x", "y"});
  EXPECT_DOUBLE_EQ(f({3.0, 0.5}), 18.0 - 1.0 + std::atan2(0.5, 3.0));
  EXPECT_DOUBLE_EQ(f({1.0, 0.0}), 2.0);
  EXPECT_DOUBLE_EQ(Expression("t < 1 ? t : 1", {"t"})(0.25), 0.25);
  EXPECT_EQ(Expression()(std::vector<double>{}), 0.0);
}

TEST(Expression, CopiesStayIndependentOfLaterEvaluations) {
  const Expression f("s", {"s"});
  const Expression copy = f;
  EXPECT_EQ(f(2.0), 2.0);
  EXPECT_EQ(copy(3.0), 3.0);
  EXPECT_EQ(f(4.0), 4.0);
}

TEST(Expression, TellsWhatIsWrongWithAText) {
  for (const char* text : {"", "2*", "x + q", "sin(", "1, 2", "s = 3 +", "((((((("}) {
    try {
      Expression(text, {"x"});
      ADD_FAILURE() << "accepted: " << text;
    } catch (const std::invalid_argument& error) {
      EXPECT_FALSE(std::string(error.what()).empty()) << text;
    }
  }
  EXPECT_THROW(Expression(std::string(20000, '1'), {}), std::invalid_argument);
}

TEST(Expression, AssignmentsAreRefusedAndComparisonsAreNot) {
  for (const char* text : {"x = 3", "x*(x=0.1)", "x>0 ? x=1 : 2"})
    EXPECT_THROW(Expression(text, {"x"}), std::invalid_argument) << text;
  for (const char* text : {"x==3", "x<=3", "x>=3", "x!=3"}) EXPECT_NO_THROW(Expression(text, {"x"})) << text;
}

TEST(Expression, DegreesAndPointsAndNames) {
  EXPECT_DOUBLE_EQ(Expression("sin(30 deg)", {})(std::vector<double>{}), std::sin(30 * (std::acos(-1.0) / 180.0)));
  const FormulaNames names{
      [](const std::string& name) -> double {
        if (name != "L") throw std::invalid_argument("unknown " + name);
        return 3.0;
      },
      [](int axis, const std::string& point) { return axis + (point == "deck w10" ? 10.0 : 20.0); }};
  EXPECT_EQ(value_of_formula("2*L + x(\"deck w10\")", names), 16.0);
  EXPECT_EQ(value_of_formula("y('deck w10') - z('b')", names), -11.0);
  EXPECT_THROW(value_of_formula("M", names), std::invalid_argument);
  EXPECT_THROW(value_of_formula("x", names), std::invalid_argument);
  const auto doubled = [](const std::string& name) { return name + name; };
  EXPECT_EQ(with_names_replaced("a+1e5*b2-1.5e-3*_c", doubled), "aa+1e5*b2b2-1.5e-3*_c_c");
}

TEST(Expression, DivisionByZeroIsANumberForTheCallerToJudge) {
  EXPECT_FALSE(std::isfinite(Expression("1/x", {"x"})(0.0)));
}

}  // namespace
}  // namespace mixbeam
