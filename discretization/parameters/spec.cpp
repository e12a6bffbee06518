#include "discretization/parameters/spec.hpp"

#include "discretization/text/message_text.hpp"
#include "discretization/text/number_text.hpp"

#include <cmath>
#include <utility>

namespace mixbeam {
namespace {

/// Whole numbers without exponent: 10000000, not 1e+07.
std::string bound_text(double bound) {
  constexpr double kLongestWritten = 1e9;
  const bool whole = bound == std::floor(bound) && std::abs(bound) < kLongestWritten;
  return whole ? std::to_string(static_cast<long long>(bound)) : shortest(bound);
}

std::string range_text(const Range& range) {
  const bool bounded_below = std::isfinite(range.minimum);
  const bool bounded_above = std::isfinite(range.maximum);
  const std::string above = range.minimum_excluded ? " > " : " >= ";
  const std::string below = range.maximum_excluded ? " < " : " <= ";
  std::string text;
  if (bounded_below && bounded_above) {
    const std::string from = range.minimum_excluded ? " < " : " <= ";
    text = ", " + bound_text(range.minimum) + from + "value" + below + bound_text(range.maximum);
  } else if (bounded_below) {
    text = ", value" + above + bound_text(range.minimum);
  } else if (bounded_above) {
    text = ", value" + below + bound_text(range.maximum);
  }
  return text + (range.infinity_allowed ? ", or inf" : "");
}

ParameterSpec make(const std::string& name, ParameterType type) {
  ParameterSpec spec;
  spec.name = name;
  spec.type = type;
  return spec;
}

}  // namespace

ParameterSpec ParameterSpec::by_default(const ParameterValue& value) const {
  ParameterSpec spec = *this;
  spec.presence = Presence::defaulted;
  spec.default_value = value;
  if (type == ParameterType::real && std::holds_alternative<int>(value)) {
    spec.default_value = static_cast<double>(std::get<int>(value));
  }
  return spec;
}

ParameterSpec boolean(const std::string& name) { return make(name, ParameterType::boolean); }
ParameterSpec integer(const std::string& name) { return make(name, ParameterType::integer); }
ParameterSpec real(const std::string& name) { return make(name, ParameterType::real); }
ParameterSpec text(const std::string& name) { return make(name, ParameterType::text); }

ParameterSpec choice(const std::string& name, const std::vector<std::string>& choices) {
  ParameterSpec spec = text(name);
  spec.choices = choices;
  return spec;
}

ParameterSpec array(const std::string& name, ParameterType type, int length) {
  ParameterSpec spec = make(name, type);
  spec.length = length;
  return spec;
}

ParameterSpec vector3(const std::string& name) { return array(name, ParameterType::real_array, 3); }

ParameterSpec subset(const std::string& name, const std::vector<std::string>& choices) {
  ParameterSpec spec = array(name, ParameterType::text_array).or_empty();
  spec.choices = choices;
  return spec;
}

ListSpec::ListSpec(std::string sentence) : meaning(std::move(sentence)) {}

ListSpec& ListSpec::add(const ParameterSpec& parameter) {
  parameters.push_back(parameter);
  return *this;
}

ListSpec& ListSpec::add_list(const std::string& name, const ListSpec& list, Presence presence) {
  sublists.push_back(SublistSpec{name, presence, std::make_shared<const ListSpec>(list)});
  return *this;
}

ListSpec& ListSpec::with_named_parameters(const std::string& placeholder_name, const ParameterSpec& parameter,
                                          int minimum) {
  named_parameter = std::make_shared<const ParameterSpec>(parameter);
  placeholder = placeholder_name;
  minimum_named = minimum;
  return *this;
}

ListSpec& ListSpec::with_named_lists(const std::string& placeholder_name, const ListSpec& list, int minimum) {
  named_list = std::make_shared<const ListSpec>(list);
  placeholder = placeholder_name;
  minimum_named = minimum;
  return *this;
}

ListSpec& ListSpec::with_forms(const std::string& parameter,
                               const std::map<std::string, std::vector<Form>>& forms_of_words) {
  form_parameter = parameter;
  forms = forms_of_words;
  return *this;
}

ListSpec& ListSpec::without_form(const std::vector<std::string>& names) {
  formless = names;
  return *this;
}

ListSpec& ListSpec::without_checks() {
  unchecked = true;
  return *this;
}

ListSpec& ListSpec::had_once(const std::string& name) {
  removed.push_back(name);
  return *this;
}

const ParameterSpec* ListSpec::find_parameter(const std::string& name) const {
  for (const ParameterSpec& parameter : parameters) {
    if (parameter.name == name) return &parameter;
  }
  return nullptr;
}

const SublistSpec* ListSpec::find_list(const std::string& name) const {
  for (const SublistSpec& sublist : sublists) {
    if (sublist.name == name) return &sublist;
  }
  return nullptr;
}

const ParameterSpec* ListSpec::parameter(const std::string& name) const {
  const ParameterSpec* fixed = find_parameter(name);
  return fixed != nullptr ? fixed : named_parameter.get();
}

const ListSpec* ListSpec::list(const std::string& name) const {
  const SublistSpec* fixed = find_list(name);
  return fixed != nullptr ? fixed->list.get() : named_list.get();
}

std::vector<std::string> ListSpec::fixed_names() const {
  std::vector<std::string> names;
  for (const ParameterSpec& parameter : parameters) names.push_back(parameter.name);
  for (const SublistSpec& sublist : sublists) names.push_back(sublist.name);
  return names;
}

std::string allowed_values(const ParameterSpec& parameter) {
  std::string text = xml_name(parameter.type);
  if (parameter.length > 0) text += " of " + std::to_string(parameter.length) + " values";
  text += range_text(parameter.range);
  if (!parameter.choices.empty()) {
    text += parameter.type == ParameterType::text ? ", one of " : ", each at most once, of ";
    text += quoted_list(parameter.choices, parameter.choices.size());
    if (!parameter.other_words.empty()) text += ", or " + parameter.other_words;
  }
  if (!parameter.words.empty()) text += ", or string, one of " + quoted_list(parameter.words);
  return text;
}

bool stands_for_number(const ParameterValue& value, const ParameterSpec& spec) {
  const bool is_array_of_numbers = spec.type == ParameterType::real_array || spec.type == ParameterType::integer_array;
  if (is_array_of_numbers) return has_type(value, ParameterType::text_array) && holds_formula(value);
  if (spec.type != ParameterType::real && spec.type != ParameterType::integer) return false;
  return has_type(value, ParameterType::text) && (holds_formula(value) || !spec.other_words.empty());
}

}  // namespace mixbeam
