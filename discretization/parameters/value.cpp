#include "discretization/parameters/value.hpp"

#include "discretization/text/message_text.hpp"

#include <algorithm>
#include <type_traits>

namespace mixbeam {
namespace {

std::string element_text(bool value) { return value ? "true" : "false"; }
std::string element_text(int value) { return std::to_string(value); }
std::string element_text(double value) { return shortest(value); }
std::string element_text(const std::string& value) { return "\"" + value + "\""; }
std::string element_text(std::monostate) { return ""; }

template <typename T>
std::string element_text(const Teuchos::Array<T>& values) {
  std::string text = "{";
  for (Teuchos::Ordinal i = 0; i < values.size(); ++i) {
    text += (i == 0 ? "" : ", ") + element_text(values[i]);
  }
  return text + "}";
}

Problem parse_text(const std::string& text, bool& value) {
  const std::string word = trimmed(text);
  if (word != "true" && word != "false") return "value \"" + excerpt(word) + R"("; allowed: "true", "false")";
  value = word == "true";
  return "";
}
Problem parse_text(const std::string& text, int& value) { return parse_number(text, value); }
Problem parse_text(const std::string& text, double& value) { return parse_number(text, value); }
Problem parse_text(const std::string& text, std::string& value) {
  value = text;
  return "";
}

/// Offsets where the entries of an array end. A comma inside parentheses belongs to the entry, as in max(x, 1), unless
/// the parentheses do not match.
std::vector<std::size_t> ends_of_entries(const std::string& text) {
  std::vector<std::size_t> all, outside;
  int depth = 0;
  bool match = true;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '(') ++depth;
    if (text[i] == ')') match = --depth >= 0 && match;
    if (text[i] != ',') continue;
    all.push_back(i);
    if (depth == 0) outside.push_back(i);
  }
  std::vector<std::size_t>& ends = match && depth == 0 ? outside : all;
  ends.push_back(text.size());
  return ends;
}

template <typename T>
Problem parse_text(const std::string& text, Teuchos::Array<T>& values) {
  const std::string braced = trimmed(text);
  if (braced.size() < 2 || braced.front() != '{' || braced.back() != '}' || braced.find('{', 1) != std::string::npos) {
    return "value \"" + excerpt(braced) + "\" is not an array; allowed: values between braces, like {1, 2, 3}";
  }
  const std::string inside = braced.substr(1, braced.size() - 2);
  if (trimmed(inside).empty()) return "";
  std::size_t begin = 0;
  for (const std::size_t end : ends_of_entries(inside)) {
    const std::string entry = trimmed(inside.substr(begin, end - begin));
    if (entry.empty()) return "value \"" + excerpt(braced) + "\" has an empty entry; allowed: values between commas";
    T value{};
    if (Problem problem = parse_text(entry, value); !problem.empty()) return "in an array: " + problem;
    values.push_back(value);
    begin = end + 1;
  }
  return "";
}

template <typename T>
Problem parse_as(const std::string& text, ParameterValue& value) {
  return parse_text(text, value.emplace<T>());
}

using Parser = Problem (*)(const std::string&, ParameterValue&);
/// In the order of ParameterType.
constexpr Parser kParsers[] = {parse_as<bool>,
                               parse_as<int>,
                               parse_as<double>,
                               parse_as<std::string>,
                               parse_as<Teuchos::Array<int>>,
                               parse_as<Teuchos::Array<double>>,
                               parse_as<Teuchos::Array<std::string>>};

template <typename T>
bool take(const Teuchos::ParameterEntry& entry, ParameterValue& value) {
  if (!entry.isType<T>()) return false;
  value = Teuchos::getValue<T>(entry);
  return true;
}

bool is_number(ParameterType type) {
  return type == ParameterType::integer || type == ParameterType::real || type == ParameterType::integer_array ||
         type == ParameterType::real_array;
}

}  // namespace

const std::vector<std::string>& xml_names() {
  static const std::vector<std::string> names = {"bool",       "int",           "double",       "string",
                                                 "Array(int)", "Array(double)", "Array(string)"};
  return names;
}

std::string to_text(const ParameterValue& value) {
  return std::visit([](const auto& held) { return element_text(held); }, value);
}

std::string attribute_text(const ParameterValue& value) {
  if (const auto* text = std::get_if<std::string>(&value)) return *text;
  const auto* texts = std::get_if<Teuchos::Array<std::string>>(&value);
  if (texts == nullptr) return to_text(value);
  std::string all;
  for (const std::string& entry : *texts) all += (all.empty() ? "" : ", ") + entry;
  return "{" + all + "}";
}

Problem parse_value(const std::string& text, ParameterType type, ParameterValue& value) {
  if (is_number(type) && text.find('=') != std::string::npos) {
    ParameterValue formula;
    const ParameterType written = is_array(type) ? ParameterType::text_array : ParameterType::text;
    if (parse_value(text, written, formula).empty() && holds_formula(formula)) return value = formula, "";
  }
  return kParsers[static_cast<std::size_t>(type)](text, value);
}

ParameterValue value_of(const Teuchos::ParameterEntry& entry) {
  ParameterValue value;
  static_cast<void>(take<bool>(entry, value) || take<int>(entry, value) || take<double>(entry, value) ||
                    take<std::string>(entry, value) || take<Teuchos::Array<int>>(entry, value) ||
                    take<Teuchos::Array<double>>(entry, value) || take<Teuchos::Array<std::string>>(entry, value));
  return value;
}

void set_value(Teuchos::ParameterList& list, const std::string& name, const ParameterValue& value, bool as_default) {
  const auto set = [&](const auto& held) {
    if constexpr (!std::is_same_v<std::decay_t<decltype(held)>, std::monostate>) {
      if (as_default) {
        list.get(name, held);  // remembers that this value is a default
      } else {
        list.set(name, held);
      }
    }
  };
  std::visit(set, value);
}

bool is_formula(const std::string& text) {
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  return first != std::string::npos && text[first] == '=';
}

bool holds_formula(const ParameterValue& value) {
  if (const auto* text = std::get_if<std::string>(&value)) return is_formula(*text);
  const auto* texts = std::get_if<Teuchos::Array<std::string>>(&value);
  return texts != nullptr && std::any_of(texts->begin(), texts->end(), is_formula);
}

WrittenValue written_value(const Teuchos::ParameterEntry& entry) {
  const std::string kept = entry.docString();
  const std::size_t blank = kept.find(' ');
  if (blank == std::string::npos) return {kept, value_of(entry)};
  WrittenValue written{kept.substr(0, blank), {}};
  const ParameterType type = kept.rfind("Array", 0) == 0 ? ParameterType::text_array : ParameterType::text;
  static_cast<void>(parse_value(kept.substr(blank + 1), type, written.value));
  return written;
}

void set_result(Teuchos::ParameterEntry& entry, const ParameterValue& result, const WrittenValue& written) {
  std::visit(
      [&](const auto& held) {
        if constexpr (!std::is_same_v<std::decay_t<decltype(held)>, std::monostate>)
          entry.setValue(held, false, written.type + " " + attribute_text(written.value));
      },
      result);
}

}  // namespace mixbeam
