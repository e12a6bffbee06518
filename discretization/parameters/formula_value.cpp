#include "discretization/parameters/formula_value.hpp"

#include <algorithm>
#include <type_traits>

namespace mixbeam {

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

bool stands_for_number(const ParameterValue& value, const ParameterSpec& spec) {
  const bool is_array_of_numbers = spec.type == ParameterType::real_array || spec.type == ParameterType::integer_array;
  if (is_array_of_numbers) return has_type(value, ParameterType::text_array) && holds_formula(value);
  if (spec.type != ParameterType::real && spec.type != ParameterType::integer) return false;
  return has_type(value, ParameterType::text) && (holds_formula(value) || !spec.other_words.empty());
}

}  // namespace mixbeam
