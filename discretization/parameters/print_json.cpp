#include "discretization/parameters/parameter_file.hpp"
#include "discretization/parameters/print.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <set>

namespace mixbeam {
namespace {

using Json = nlohmann::ordered_json;

/// A number, or a word if it is infinite: JSON has no infinity.
Json json_number(double number) { return std::isfinite(number) ? Json(number) : Json(shortest(number)); }

Json json_value(const ParameterValue& value) {
  const auto converted = [](const auto& held) -> Json {
    using Held = std::decay_t<decltype(held)>;
    if constexpr (std::is_same_v<Held, std::monostate>) return nullptr;
    if constexpr (std::is_same_v<Held, double>) return json_number(held);
    if constexpr (std::is_same_v<Held, Teuchos::Array<double>>) {
      Json numbers = Json::array();
      for (const double number : held) numbers.push_back(json_number(number));
      return numbers;
    } else if constexpr (std::is_same_v<Held, Teuchos::Array<int>> ||
                         std::is_same_v<Held, Teuchos::Array<std::string>>) {
      return held.toVector();
    } else if constexpr (!std::is_same_v<Held, std::monostate>) {
      return held;
    }
  };
  return std::visit(converted, value);
}

Json json_range(const Range& range) {
  Json json = Json::object();
  if (std::isfinite(range.minimum)) json[range.minimum_excluded ? "above" : "at_least"] = range.minimum;
  if (std::isfinite(range.maximum)) json[range.maximum_excluded ? "below" : "at_most"] = range.maximum;
  if (range.infinity_allowed) json["infinite"] = true;
  return json;
}

std::string json_presence(Presence presence) {
  if (presence == Presence::required) return "required";
  return presence == Presence::defaulted ? "default" : "optional";
}

/// Unit at the end of a meaning, `force / length` of [force / length]; empty: none.
std::string unit_of(const ParameterSpec& spec) {
  const std::size_t begin = spec.meaning.rfind(" [");
  const std::size_t end = spec.meaning.find(']', begin == std::string::npos ? 0 : begin);
  if (begin == std::string::npos || end == std::string::npos) return "";
  return spec.meaning.substr(begin + 2, end - begin - 2);
}

Json json_parameter(const ParameterSpec& spec, const std::string& name) {
  Json json = {{"name", name}, {"type", xml_name(spec.type)}, {"presence", json_presence(spec.presence)}};
  if (!spec.name.empty()) json["program_name"] = program_name(name);
  if (spec.presence == Presence::defaulted) json["default"] = json_value(spec.default_value);
  if (const Json range = json_range(spec.range); !range.empty()) json["range"] = range;
  if (spec.length > 0) json["length"] = spec.length;
  if (spec.empty_allowed) json["empty"] = true;
  if (!spec.choices.empty()) json["choices"] = spec.choices;
  if (!spec.other_words.empty()) json["or_other"] = spec.other_words;
  if (!spec.words.empty()) json["words"] = spec.words;
  if (const std::string unit = unit_of(spec); !unit.empty()) json["unit"] = unit;
  json["meaning"] = spec.meaning;
  return json;
}

Json json_forms(const ListSpec& spec) {
  Json words = Json::object();
  for (const auto& [word, forms] : spec.forms) {
    words[word] = Json::array();
    for (const Form& form : forms) words[word].push_back({{"needed", form.needed}, {"optional", form.optional}});
  }
  return {{"parameter", spec.form_parameter}, {"words", words}};
}

Json json_list(const ListSpec& spec, const std::vector<std::string>& path, Presence presence) {
  const auto inside = [&path](const std::string& name) {
    std::vector<std::string> longer = path;
    longer.push_back(name);
    return longer;
  };
  Json json = {{"path", path}, {"presence", json_presence(presence)}, {"meaning", spec.meaning}};
  if (!path.empty()) json["name"] = path.back();
  if (!path.empty() && path.back().front() != '<') json["program_name"] = program_name(path.back());
  json["parameters"] = Json::array();
  for (const ParameterSpec& parameter : spec.parameters)
    json["parameters"].push_back(json_parameter(parameter, parameter.name));
  json["lists"] = Json::array();
  for (const SublistSpec& sublist : spec.sublists)
    json["lists"].push_back(json_list(*sublist.list, inside(sublist.name), sublist.presence));
  if (spec.named_parameter || spec.named_list) {
    const std::string placeholder = "<" + spec.placeholder + ">";
    Json& free = json["free_names"] = {{"placeholder", spec.placeholder}, {"at_least", spec.minimum_named}};
    if (spec.named_parameter) free["parameter"] = json_parameter(*spec.named_parameter, placeholder);
    if (spec.named_list) free["list"] = json_list(*spec.named_list, inside(placeholder), Presence::optional);
  }
  if (!spec.form_parameter.empty()) json["forms"] = json_forms(spec);
  if (!spec.removed.empty()) json["removed"] = spec.removed;
  if (spec.unchecked) json["unchecked"] = true;
  return json;
}

// JSON Schema

/// Schema of a number, or of each number of an array.
Json schema_of_number(const Range& range, bool is_whole, bool is_any_text_formula) {
  Json schema = {{"type", is_whole ? "integer" : "number"}};
  if (std::isfinite(range.minimum)) schema[range.minimum_excluded ? "exclusiveMinimum" : "minimum"] = range.minimum;
  if (std::isfinite(range.maximum)) schema[range.maximum_excluded ? "exclusiveMaximum" : "maximum"] = range.maximum;
  if (is_whole && !std::isfinite(range.minimum)) schema["minimum"] = std::numeric_limits<int>::min();
  if (is_whole && !std::isfinite(range.maximum)) schema["maximum"] = std::numeric_limits<int>::max();
  Json formula = {{"type", "string"}};
  if (!is_any_text_formula) formula["pattern"] = "^\\s*=";
  schema = {{"anyOf", {schema, formula}}};
  if (range.infinity_allowed) schema["anyOf"].push_back({{"const", "inf"}});
  return schema;
}

/// Unquoted text may look like a number or a boolean.
Json schema_of_text(const ParameterSpec& spec) {
  const Json any = {{"type", {"string", "number", "boolean"}}};
  if (spec.choices.empty()) return any;
  Json words = Json::array();
  for (const std::string& word : spec.choices) {
    words.push_back(word);
    if (int number = 0; parse_number(word, number).empty()) words.push_back(number);
  }
  const Json one = {{"enum", words}};
  return spec.other_words.empty() ? one : Json({{"anyOf", {one, any}}});
}

Json schema_of_value(const ParameterSpec& spec) {
  switch (spec.type) {
    case ParameterType::boolean:
      return {{"type", "boolean"}};
    case ParameterType::integer:
    case ParameterType::integer_array:
      return schema_of_number(spec.range, true, !spec.other_words.empty());
    case ParameterType::real:
    case ParameterType::real_array:
      return schema_of_number(spec.range, false, !spec.other_words.empty());
    case ParameterType::text:
    case ParameterType::text_array:
      break;
  }
  return schema_of_text(spec);
}

Json schema_of_parameter(const ParameterSpec& spec) {
  Json schema = schema_of_value(spec);
  if (is_array(spec.type)) {
    schema = {{"type", "array"}, {"items", schema}};
    if (spec.length > 0) schema["maxItems"] = spec.length;
    if (spec.length > 0 || !spec.empty_allowed) schema["minItems"] = std::max(spec.length, 1);
    if (!spec.choices.empty()) schema["uniqueItems"] = true;
  }
  if (!spec.words.empty()) {
    Json words = spec.words;
    for (const bool word : {true, false})
      if (std::count(spec.words.begin(), spec.words.end(), to_text(ParameterValue(word))) > 0) words.push_back(word);
    schema = {{"anyOf", {schema, {{"enum", words}}}}};
  }
  schema["description"] = spec.meaning + " (" + allowed_values(spec) + ")";
  if (spec.presence == Presence::defaulted) schema["default"] = json_value(spec.default_value);
  return schema;
}

std::set<std::string> all_names_of_forms(const ListSpec& spec) {
  std::set<std::string> names;
  for (const auto& [word, forms] : spec.forms)
    for (const Form& form : forms)
      for (const auto* part : {&form.needed, &form.optional}) names.insert(part->begin(), part->end());
  return names;
}

/// Forbids all entries of the forms if the deciding word is absent.
Json schema_without_form(const ListSpec& spec) {
  Json refused = Json::object();
  for (const std::string& name : all_names_of_forms(spec)) refused[name] = false;
  return {{"if", {{"not", {{"required", Json::array({spec.form_parameter})}}}}}, {"then", {{"properties", refused}}}};
}

/// Other entries that a word needs and allows. If none is given, the default word counts.
Json schema_of_forms(const ListSpec& spec, const std::string& word, const std::vector<Form>& forms) {
  std::set<std::string> names = all_names_of_forms(spec);
  names.insert(spec.formless.begin(), spec.formless.end());
  Json alternatives = Json::array();
  for (const Form& form : forms) {
    Json alternative = {{"required", form.needed}, {"properties", Json::object()}};
    for (const std::string& name : names)
      if (std::count(form.needed.begin(), form.needed.end(), name) == 0 &&
          std::count(form.optional.begin(), form.optional.end(), name) == 0)
        alternative["properties"][name] = false;
    alternatives.push_back(alternative);
  }
  const ParameterSpec* parameter = spec.find_parameter(spec.form_parameter);
  const bool is_default = parameter->default_value == ParameterValue(word);
  Json condition = {{"properties", {{spec.form_parameter, {{"const", word}}}}}};
  if (!is_default) condition["required"] = {spec.form_parameter};
  return {{"if", condition}, {"then", {{"anyOf", alternatives}}}};
}

Json schema_of_list(const ListSpec& spec) {
  Json schema = {{"type", "object"}, {"description", spec.meaning}};
  if (spec.unchecked) return schema;
  Json properties = Json::object(), required = Json::array();
  for (const ParameterSpec& parameter : spec.parameters) {
    properties[parameter.name] = schema_of_parameter(parameter);
    if (parameter.presence == Presence::required) required.push_back(parameter.name);
  }
  for (const SublistSpec& sublist : spec.sublists) {
    properties[sublist.name] = schema_of_list(*sublist.list);
    if (sublist.presence == Presence::required) required.push_back(sublist.name);
  }
  for (const std::string& name : spec.removed)
    properties[name] = {{"description", "Removed: it has no effect any more."}, {"deprecationMessage", "removed"}};
  schema["properties"] = properties;
  if (!required.empty()) schema["required"] = required;
  schema["additionalProperties"] = false;
  if (spec.named_parameter) schema["additionalProperties"] = schema_of_parameter(*spec.named_parameter);
  if (spec.named_list) schema["additionalProperties"] = schema_of_list(*spec.named_list);
  if (spec.minimum_named > 0) schema["minProperties"] = spec.minimum_named;
  for (const auto& [word, forms] : spec.forms) schema["allOf"].push_back(schema_of_forms(spec, word, forms));
  if (!spec.formless.empty()) schema["allOf"].push_back(schema_without_form(spec));
  return schema;
}

/// Whether a word is a symbol as engineers write it (EI2, GIt, E), not a title of several words.
bool is_symbol(const std::string& word) {
  if (word.find(' ') != std::string::npos) return false;
  const auto capitals = std::count_if(word.begin(), word.end(), [](unsigned char c) { return std::isupper(c) != 0; });
  return word.size() == 1 || capitals > 1 || std::isdigit(static_cast<unsigned char>(word.back())) != 0;
}

/// Keywords of Python.
const std::set<std::string> kReserved = {
    "and",      "as",     "assert",  "async", "await", "break",  "class", "continue", "def",  "del",  "elif",
    "else",     "except", "finally", "for",   "from",  "global", "if",    "import",   "in",   "is",   "lambda",
    "nonlocal", "not",    "or",      "pass",  "raise", "return", "try",   "while",    "with", "yield"};

}  // namespace

std::string program_name(const std::string& name) {
  if (is_symbol(name)) return name;
  std::string result;
  for (const char c : name) {
    const auto letter = static_cast<unsigned char>(c);
    result += std::isalnum(letter) != 0 ? static_cast<char>(std::tolower(letter)) : '_';
  }
  return kReserved.count(result) > 0 ? result + "_" : result;
}

void print_json_schema(std::ostream& out, const ListSpec& spec, const std::string& title) {
  Json schema = {{"$schema", "http://json-schema.org/draft-07/schema#"}, {"title", title}};
  schema.update(schema_of_list(spec));
  schema.erase("description");  // which explains how lists are written in XML
  schema["properties"][kRootName] = {{"type", {"string", "number", "boolean"}},
                                     {"description", "Name of the scene; that of the file if absent."}};
  out << schema.dump(1) << '\n';
}

void print_parameters_json(std::ostream& out, const ListSpec& spec) {
  out << json_list(spec, {}, Presence::required).dump(2) << '\n';
}

}  // namespace mixbeam
