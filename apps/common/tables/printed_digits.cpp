#include "apps/common/tables/printed_digits.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>

namespace mixbeam {
namespace {

constexpr std::size_t kMostDigits = 17;  // of a double, and few enough for a 64-bit integer

// A printed number: sign, digits without point, how many of them stand behind the point, power of ten.
struct Decimal {
  bool negative = false;
  std::string digits;
  int decimals = 0;
  int exponent = 0;
  bool has_exponent = false;
  std::string exponent_text;  // "e-07", kept to write it the same way
};

bool is_digit(char c) { return c >= '0' && c <= '9'; }

[[noreturn]] void refuse(const std::string& text) {
  throw std::invalid_argument("'" + text + "' is not a printed decimal number");
}

void read_exponent(const std::string& text, std::size_t at, Decimal& decimal) {
  decimal.has_exponent = true;
  decimal.exponent_text = text.substr(at);
  const std::size_t first = at + (text[at + 1] == '+' ? 2 : 1);
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data() + first, end, decimal.exponent);
  if (error != std::errc() || stop != end) refuse(text);
}

Decimal read_decimal(const std::string& text) {
  Decimal decimal;
  std::size_t at = 0;
  if (at < text.size() && (text[at] == '-' || text[at] == '+')) decimal.negative = text[at++] == '-';
  bool behind_point = false;
  for (; at < text.size() && (is_digit(text[at]) || (text[at] == '.' && !behind_point)); ++at) {
    if (text[at] == '.') {
      behind_point = true;
    } else {
      decimal.digits += text[at];
      decimal.decimals += behind_point ? 1 : 0;
    }
  }
  if (decimal.digits.empty()) refuse(text);
  if (at + 1 < text.size() && (text[at] == 'e' || text[at] == 'E')) {
    read_exponent(text, at, decimal);
  } else if (at != text.size()) {
    refuse(text);
  }
  return decimal;
}

// Correctly rounded fixed notation, whatever the locale.
std::string fixed(double value, int decimals) {
  std::array<char, 400> text{};
  const auto result = std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::fixed, decimals);
  return {text.data(), result.ptr};
}

// Digits of |value| / 10^exponent down to `decimals` places, correctly rounded: from all 17 digits of the value when a
// power of ten is in the way, since a division would round once more.
std::string scaled_digits(double value, const Decimal& style) {
  if (!style.has_exponent) return fixed(value, style.decimals);
  std::array<char, 400> text{};
  const auto all = std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::scientific, 16);
  Decimal exact = read_decimal({text.data(), all.ptr});
  std::string shifted(exact.negative ? "-" : "");
  const std::string mantissa = exact.digits.substr(0, 1) + "." + exact.digits.substr(1) + "e";
  shifted += mantissa + std::to_string(exact.exponent - style.exponent);
  return fixed(std::strtod(shifted.c_str(), nullptr), style.decimals);
}

std::string without_point(const std::string& text) {
  std::string digits;
  for (const char c : text) {
    if (is_digit(c)) digits += c;
  }
  const auto first = digits.find_first_not_of('0');
  return first == std::string::npos ? "0" : digits.substr(first);
}

long long signed_integer(const std::string& text, bool negative) {
  const long long integer = std::atoll(without_point(text).c_str());
  return negative ? -integer : integer;
}

std::string with_point(std::string digits, int decimals) {
  if (decimals <= 0) return digits + std::string(static_cast<std::size_t>(-decimals), '0');
  const auto places = static_cast<std::size_t>(decimals);
  if (digits.size() <= places) digits.insert(0, places + 1 - digits.size(), '0');
  return digits.insert(digits.size() - places, ".");
}

// Adds one to the last digit; true when the number became longer (999 -> 1000).
bool round_up(std::string& digits) {
  for (std::size_t i = digits.size(); i-- > 0;) {
    if (digits[i] != '9') {
      ++digits[i];
      return false;
    }
    digits[i] = '0';
  }
  digits.insert(0, "1");
  return true;
}

}  // namespace

double printed_value(const std::string& printed) {
  const Decimal decimal = read_decimal(printed);
  const std::string text = decimal.digits + "e" + std::to_string(decimal.exponent - decimal.decimals);
  const double magnitude = std::strtod(text.c_str(), nullptr);
  return decimal.negative ? -magnitude : magnitude;
}

std::string in_style_of(double value, const std::string& printed) {
  if (std::isnan(value)) return "nan";
  if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
  const Decimal style = read_decimal(printed);
  return scaled_digits(value, style) + style.exponent_text;
}

std::string in_known_digits(double value, double error) {
  constexpr int kMostKnown = 10;
  const double known = error > 0.0 ? std::floor(std::log10(std::abs(value) / error)) : kMostKnown;
  const int digits = static_cast<int>(std::fmin(std::fmax(known, 1.0), kMostKnown));
  std::array<char, 64> text{};
  if (digits == kMostKnown)
    std::snprintf(text.data(), text.size(), "%.*g", digits, value);
  else
    std::snprintf(text.data(), text.size(), "%#.*g +- %.0e", digits, value, error);
  return text.data();
}

bool agrees_in_printed_digits(double value, const std::string& printed, int units_in_last_place) {
  const Decimal reference = read_decimal(printed);
  if (!std::isfinite(value)) return false;
  const std::string own = scaled_digits(value, reference);
  if (without_point(own).size() > kMostDigits || without_point(reference.digits).size() > kMostDigits) return false;
  const long long difference =
      signed_integer(own, std::signbit(value)) - signed_integer(reference.digits, reference.negative);
  return std::llabs(difference) <= units_in_last_place;
}

std::string rounded_to_figures(const std::string& number, int figures) {
  if (figures < 1) throw std::invalid_argument("a number needs at least one significant figure");
  Decimal decimal = read_decimal(number);
  std::string digits = without_point(decimal.digits);
  const auto wanted = static_cast<std::size_t>(figures);
  if (digits != "0" && digits.size() > wanted) {
    const bool up = digits[wanted] >= '5';
    decimal.decimals -= static_cast<int>(digits.size() - wanted);
    digits.resize(wanted);
    if (up && round_up(digits)) {
      digits.pop_back();
      --decimal.decimals;
    }
  } else if (digits != "0") {
    decimal.decimals += static_cast<int>(wanted - digits.size());
    digits.append(wanted - digits.size(), '0');
  }
  return (decimal.negative ? "-" : "") + with_point(digits, decimal.decimals) + decimal.exponent_text;
}

}  // namespace mixbeam
