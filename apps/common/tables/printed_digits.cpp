#include "apps/common/tables/printed_digits.hpp"

#include "apps/common/tables/formatted.hpp"

#include <cmath>
#include <cstdlib>
#include <regex>
#include <stdexcept>

namespace mixbeam {
namespace {

constexpr std::size_t kMostDigits = 17;  // of a double, and few enough for a 64-bit integer

// A printed number: sign, digits without point, how many of them follow the point, power of ten.
struct Decimal {
  bool negative = false;
  std::string digits;
  int decimals = 0;
  int exponent = 0;
  std::string exponent_text{};  // "e-07", kept to write it the same way
};

Decimal read_decimal(const std::string& text) {
  static const std::regex form(R"(([+-]?)(\d*)(?:\.(\d*))?((?:[eE]([+-]?\d{1,4}))?))");
  std::smatch parts;
  if (!std::regex_match(text, parts, form) || parts.length(2) + parts.length(3) == 0)
    throw std::invalid_argument("'" + text + "' is not a printed decimal number");
  Decimal decimal{parts[1] == "-", parts.str(2) + parts.str(3), static_cast<int>(parts.length(3))};
  decimal.exponent_text = parts[4];
  decimal.exponent = parts.length(5) == 0 ? 0 : std::stoi(parts[5]);
  return decimal;
}

// Digits of |value| / 10^exponent down to `decimals` places, correctly rounded: from all 17 digits of the value when a
// power of ten is in the way, since a division would round once more.
std::string scaled_digits(double value, const Decimal& style) {
  if (!style.exponent_text.empty()) {
    const std::string all = formatted("%.16e", value);
    const auto mark = all.find('e');
    const std::string exponent = std::to_string(std::stoi(all.substr(mark + 1)) - style.exponent);
    value = std::strtod((all.substr(0, mark + 1) + exponent).c_str(), nullptr);
  }
  return formatted("%.*f", style.decimals, value);
}

std::string without_point(const std::string& text) {
  std::string digits;
  for (const char c : text)
    if (c >= '0' && c <= '9') digits += c;
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
  if (digits == kMostKnown) return formatted("%.*g", digits, value);
  return formatted("%#.*g +- %.0e", digits, value, error);
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
