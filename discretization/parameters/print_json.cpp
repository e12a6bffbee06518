#include "discretization/parameters/print.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <set>

namespace mixbeam {
namespace {

using Json = nlohmann::ordered_json;

/// JSON has no infinite numbers: a word.
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
  switch (presence) {
    case Presence::required:
      return "required";
    case Presence::defaulted:
      return "default";
    case Presence::optional:
      break;
  }
  return "optional";
}

/// `force / length` of a meaning that ends with [force / length]; empty where it names none.
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

/// EI2, GIt, E, nu as engineers write them; not a title of several words.
bool is_symbol(const std::string& word) {
  if (word.find(' ') != std::string::npos) return false;
  const auto capitals = std::count_if(word.begin(), word.end(), [](unsigned char c) { return std::isupper(c) != 0; });
  return word.size() == 1 || capitals > 1 || std::isdigit(static_cast<unsigned char>(word.back())) != 0;
}

/// Words that Python keeps for itself.
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

void print_parameters_json(std::ostream& out, const ListSpec& spec) {
  out << json_list(spec, {}, Presence::required).dump(2) << '\n';
}

}  // namespace mixbeam
