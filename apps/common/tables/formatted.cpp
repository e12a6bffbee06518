#include "apps/common/tables/formatted.hpp"

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>

namespace mixbeam {

namespace {

/// Relative tolerance for binary rounding, so that a decimal number that ends in 5 counts as half a unit.
constexpr double kRoundingOfHalves = 1e-12;

/// A printed number: mantissa, digits after its decimal point, power of ten.
struct Printed {
  double value = 0.0, mantissa = 0.0;
  int decimals = 0;
  std::string exponent{};  ///< "e-07", kept to write it the same way

  explicit Printed(const std::string& text) {
    char* end = nullptr;
    value = std::strtod(text.c_str(), &end);
    if (text.empty() || *end != '\0' || text.find_first_not_of("+-.0123456789eE") != std::string::npos)
      throw std::invalid_argument("'" + text + "' is not a printed decimal number");
    const auto mark = std::min(text.find_first_of("eE"), text.size()), point = text.find('.');
    mantissa = std::strtod(text.substr(0, mark).c_str(), nullptr);
    if (point != std::string::npos) decimals = static_cast<int>(mark - point) - 1;
    exponent = text.substr(mark);
  }
  double power() const { return exponent.empty() ? 1.0 : std::pow(10.0, std::atoi(exponent.c_str() + 1)); }
};

}  // namespace

std::string printed(const char* format, ...) {
  std::va_list values, again;
  va_start(values, format);
  va_copy(again, values);
  std::string text(static_cast<std::size_t>(std::vsnprintf(nullptr, 0, format, values)) + 1, '\0');
  std::vsnprintf(text.data(), text.size(), format, again);
  va_end(again);
  va_end(values);
  text.pop_back();
  return text;
}

double printed_value(const std::string& printed) { return Printed(printed).value; }

std::string in_style_of(double value, const std::string& printed) {
  if (std::isnan(value)) return "nan";
  if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
  const Printed style(printed);
  return formatted("%.*f", style.decimals, value / style.power()) + style.exponent;
}

std::string in_known_digits(double value, double error) {
  constexpr int kMostKnown = 10;
  if (!(error > std::pow(10.0, -kMostKnown) * std::abs(value))) return formatted("%.*g", kMostKnown, value);
  const auto place = [](double number) { return std::floor(std::log10(number)); };  // of its first digit
  const double digits = place(std::abs(value)) - place(error) + 1.0;
  std::string text = formatted("%#.*g", static_cast<int>(std::fmax(digits, 1.0)), value);
  const std::size_t point = text.find('.');
  if (point != std::string::npos && text.find_first_of("0123456789", point) != point + 1) text.erase(point, 1);
  return text + formatted(" +- %.0e", error);
}

bool agrees_in_printed_digits(double value, const std::string& printed, int units_in_last_place) {
  const Printed reference(printed);
  const double unit = reference.power() * std::pow(10.0, -reference.decimals);
  return std::abs(value - reference.value) <= (units_in_last_place + 0.5) * unit * (1.0 + kRoundingOfHalves);
}

std::string rounded_to_figures(const std::string& number, int figures) {
  if (figures < 1) throw std::invalid_argument("a number needs at least one significant figure");
  const Printed printed(number);
  if (printed.mantissa == 0.0) return number;
  const std::string rounded = formatted("%.*e", figures - 1, printed.mantissa * (1.0 + kRoundingOfHalves));
  const int decimals = figures - 1 - std::atoi(rounded.c_str() + rounded.find('e') + 1);
  return formatted("%.*f", std::max(decimals, 0), std::strtod(rounded.c_str(), nullptr)) + printed.exponent;
}

}  // namespace mixbeam
