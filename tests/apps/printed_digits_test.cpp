/// Agreement in printed digits: the comparison on which all checks against the paper's tables rest.
#include "apps/common/tables/formatted.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

namespace mixbeam {
namespace {

TEST(PrintedDigits, AgreesWithinOneUnitOfTheLastDigit) {
  EXPECT_TRUE(agrees_in_printed_digits(-23.64501, "-23.6450"));
  EXPECT_TRUE(agrees_in_printed_digits(-23.64514, "-23.6450"));  // rounds to ...451
  EXPECT_TRUE(agrees_in_printed_digits(9.99999999, "10.0000"));  // one digit less before the point
  EXPECT_TRUE(agrees_in_printed_digits(0.1, "0.1", 0));
  EXPECT_TRUE(agrees_in_printed_digits(7.0, "7"));
}

TEST(PrintedDigits, TwoUnitsFail) {
  EXPECT_FALSE(agrees_in_printed_digits(-23.64516, "-23.6450"));
  EXPECT_FALSE(agrees_in_printed_digits(-23.64516, "-23.6450", 1));
  EXPECT_TRUE(agrees_in_printed_digits(-23.64516, "-23.6450", 2));
  EXPECT_FALSE(agrees_in_printed_digits(-23.64514, "-23.6450", 0));
}

TEST(PrintedDigits, SignsAndZeros) {
  EXPECT_FALSE(agrees_in_printed_digits(23.6450, "-23.6450"));
  EXPECT_TRUE(agrees_in_printed_digits(-0.00004, "0.0000", 0));
  EXPECT_TRUE(agrees_in_printed_digits(-0.00012, "0.0000"));
  EXPECT_FALSE(agrees_in_printed_digits(-0.00008, "0.0001"));  // -1 and +1 differ by two units
  EXPECT_TRUE(agrees_in_printed_digits(0.0, "-0.00", 0));
}

TEST(PrintedDigits, PowersOfTen) {
  EXPECT_TRUE(agrees_in_printed_digits(6.6975e-3, "6.698e-03", 1));
  EXPECT_TRUE(agrees_in_printed_digits(-0.1249, "-1.249e-1", 0));
  EXPECT_FALSE(agrees_in_printed_digits(-0.1252, "-1.249e-1"));
  EXPECT_TRUE(agrees_in_printed_digits(1.234e5, "1.234E+5", 0));
  EXPECT_TRUE(agrees_in_printed_digits(9.9996e-5, "1.000e-4", 0));
}

TEST(PrintedDigits, NothingThatIsNotFiniteAgrees) {
  EXPECT_FALSE(agrees_in_printed_digits(std::nan(""), "0"));
  EXPECT_FALSE(agrees_in_printed_digits(std::numeric_limits<double>::infinity(), "1e300"));
  EXPECT_FALSE(agrees_in_printed_digits(1e300, "1"));
}

TEST(PrintedDigits, TextsThatAreNoNumbersAreRefused) {
  for (const char* text : {"", "-", ".", "1.2.3", "abc", "1e", "1e+", "1.0 ", "nan", "1,5", "0x10"}) {
    EXPECT_THROW(agrees_in_printed_digits(1.0, text), std::invalid_argument) << text;
  }
}

TEST(PrintedDigits, RoundsTextsAsTheTableIsSet) {
  EXPECT_EQ(rounded_to_figures("-23.75125", 6), "-23.7513");
  EXPECT_EQ(rounded_to_figures("54.095", 6), "54.0950");
  EXPECT_EQ(rounded_to_figures("-0.1870366", 6), "-0.187037");
  EXPECT_EQ(rounded_to_figures("-0.175832", 6), "-0.175832");
  EXPECT_EQ(rounded_to_figures("9.999996", 6), "10.0000");
  EXPECT_EQ(rounded_to_figures("123456", 2), "120000");
  EXPECT_EQ(rounded_to_figures("0.0", 3), "0.0");
  EXPECT_EQ(rounded_to_figures("7.250e-05", 3), "7.25e-05");
}

TEST(PrintedDigits, AsManyDigitsAsAreKnown) {
  const double value = 0.83333333305555;
  EXPECT_EQ(in_known_digits(value, 0.0), "0.8333333331");
  EXPECT_EQ(in_known_digits(value, 1e-13), "0.8333333331");
  EXPECT_EQ(in_known_digits(value, 9e-9), "0.833333333 +- 9e-09");
  EXPECT_EQ(in_known_digits(value, 3e-6), "0.833333 +- 3e-06");
  EXPECT_EQ(in_known_digits(-value, 0.1), "-0.8 +- 1e-01");
  EXPECT_EQ(in_known_digits(value, 5.0), "0.8 +- 5e+00");
  EXPECT_EQ(in_known_digits(0.28, 4e-10), "0.2800000000 +- 4e-10");
  EXPECT_EQ(in_known_digits(12.34, 0.3), "12.3 +- 3e-01");
  EXPECT_EQ(in_known_digits(123.4, 3.0), "123 +- 3e+00");
  EXPECT_EQ(in_known_digits(12.34, 30.0), "1e+01 +- 3e+01");
  EXPECT_EQ(in_known_digits(0.0, 0.3), "0 +- 3e-01");
}

TEST(PrintedDigits, ValuesAndStyle) {
  EXPECT_EQ(printed_value("-1.249e-1"), -0.1249);
  EXPECT_EQ(printed_value("54.0950"), 54.095);
  EXPECT_EQ(in_style_of(0.71828, "2.72"), "0.72");
  EXPECT_EQ(in_style_of(4.75321e-3, "4.753e-03"), "4.753e-03");
  EXPECT_EQ(in_style_of(std::nan(""), "2.72"), "nan");
}

}  // namespace
}  // namespace mixbeam
