/// Numbers with a given number of digits or width, for the terminal; comparison with printed numbers of papers, to the
/// digits that they claim.
#pragma once

#include <string>
#include <type_traits>

namespace mixbeam {

/// Formats like printf, in any length.
std::string printed(const char* format, ...);

/// Formats likewise, but without the sign of zero.
template <class... Values>
std::string formatted(const char* format, Values... values) {
  const auto without_sign_of_zero = [](auto value) {
    if constexpr (std::is_floating_point_v<decltype(value)>) return value + decltype(value){0};
    return value;
  };
  return printed(format, without_sign_of_zero(values)...);
}

/// Value of a printed number such as "-23.6450" or "5.6e-07". Throws std::invalid_argument with the text if it is not a
/// decimal number.
double printed_value(const std::string& printed);

/// `value` rounded to the decimal place of the last digit of `printed` and written in the same style (fixed or with the
/// same power of ten), so that the two texts can be compared digit by digit: 0.71828 beside "2.72" gives "0.72".
/// "nan", "inf" or "-inf" if `value` is not finite.
std::string in_style_of(double value, const std::string& printed);

/// `value` down to the first digit of its estimated error, which follows: "0.833333 +- 3e-06"; with ten significant
/// digits alone if the error is smaller than these or unknown (zero or less): "0.8333333331".
std::string in_known_digits(double value, double error);

/// True if `value` rounds to `printed`, or to a number that differs from it by at most `units_in_last_place` of its
/// last digit: within (units + 1/2) of these, so that halves agree on either side. False if `value` is not finite.
bool agrees_in_printed_digits(double value, const std::string& printed, int units_in_last_place = 1);

/// The decimal text `number` rounded to `figures` significant digits, halves away from zero and zeros kept, as LaTeX's
/// siunitx sets a table: ("-23.75125", 6) gives "-23.7513", ("54.095", 6) gives "54.0950". Powers of ten stay apart.
std::string rounded_to_figures(const std::string& number, int figures);

}  // namespace mixbeam
