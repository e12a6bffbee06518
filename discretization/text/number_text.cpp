#include "discretization/text/number_text.hpp"

#include "discretization/text/message_text.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <limits>
#include <sstream>
#include <system_error>

namespace mixbeam {
namespace {

/// Applies from_chars, which rejects a leading plus sign, to the whole of `text`.
template <typename Number>
std::errc read_all(const std::string& text, Number& value) {
  const bool plus = text.size() > 1 && text[0] == '+' && text[1] != '-';
  const char* const begin = text.data() + (plus ? 1 : 0);
  const char* const end = text.data() + text.size();
  const auto [stopped, error] = std::from_chars(begin, end, value);
  if (error == std::errc() && stopped != end) return std::errc::invalid_argument;
  return error;
}

template <typename... Format>
std::string written(double value, Format... format) {
  std::array<char, 32> text{};  // up to 17 digits
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value, format...).ptr};
}

}  // namespace

std::string trimmed(const std::string& text) {
  const char* const blanks = " \t\r\n";
  const std::size_t begin = text.find_first_not_of(blanks);
  if (begin == std::string::npos) return "";
  return text.substr(begin, text.find_last_not_of(blanks) - begin + 1);
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

Problem parse_number(const std::string& text, int& value) {
  const std::string number = trimmed(text);
  const std::errc error = read_all(number, value);
  if (error == std::errc()) return "";
  if (error == std::errc::result_out_of_range) {
    return "value \"" + excerpt(number) + "\" does not fit an int; allowed: whole numbers from " +
           std::to_string(std::numeric_limits<int>::min()) + " to " + std::to_string(std::numeric_limits<int>::max());
  }
  return "value \"" + excerpt(number) + "\" is not a whole number; allowed: digits with an optional sign, like 12";
}

Problem parse_number(const std::string& text, double& value) {
  const std::string number = trimmed(text);
  const std::errc error = read_all(number, value);
  if (error == std::errc()) return "";
  if (error == std::errc::result_out_of_range) {
    return "value \"" + excerpt(number) + "\" does not fit a double; allowed: magnitudes from 2.3e-308 to 1.7e308";
  }
  return "value \"" + excerpt(number) +
         "\" is not a number; allowed: like 12, 0.5 or 1.5e-3 (decimal point, no units)" + number_hint(number);
}

std::string number_hint(const std::string& text) {
  const std::string plain = trimmed(text);
  double number = 0.0;
  for (const auto& [character, meant] : {std::pair(',', "."), std::pair('D', "e"), std::pair('d', "e")}) {
    std::string other = plain;
    if (std::count(plain.begin(), plain.end(), character) == 1) other.replace(plain.find(character), 1, meant);
    if (other != plain && read_all(other, number) == std::errc()) return "; did you mean " + other + "?";
  }
  if (const std::size_t blank = plain.find(' '); blank < plain.size() &&
                                                 parse_number(plain.substr(0, blank), number).empty() &&
                                                 parse_number(plain.substr(plain.rfind(' ')), number).empty())
    return "; a comma stands between numbers, and no blank inside of one";
  const auto [stopped, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  const std::string rest = error == std::errc() ? trimmed({stopped, text.data() + text.size()}) : "";
  const auto formula = [](const std::string& meant) { return "; did you mean \"=" + meant + "\", a formula?"; };
  if (rest == "pi") return formula(shortest(number) + "*pi");
  if (rest == "deg" || rest == "degrees" || rest == "°") return formula(shortest(number) + " deg");
  const bool has_unit = !rest.empty() && std::isalpha(static_cast<unsigned char>(rest[0])) != 0;
  if (has_unit) return "; numbers stand without units, all in one consistent set";
  if (rest == "%") return "; did you mean " + shortest(number / 100.0) + "?";
  return plain == "pi" || plain.find_first_of("*/^(") < plain.size() ? formula(plain) : "";
}

std::string shortest(double value) { return written(value); }

std::string rounded(double value, int digits) { return written(value, std::chars_format::general, digits); }

std::string to_text(const std::array<double, 3>& vector) {
  return "(" + shortest(vector[0]) + ", " + shortest(vector[1]) + ", " + shortest(vector[2]) + ")";
}

}  // namespace mixbeam
