#include "discretization/reading/variables.hpp"

#include "discretization/parameters/validate.hpp"
#include "discretization/parameters/value.hpp"
#include "discretization/text/expression.hpp"
#include "discretization/text/message_text.hpp"
#include "discretization/text/number_text.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace mixbeam {
namespace {

const std::string kVariables = "Variables";

/// Names with a meaning of their own in formulas of loads, tapers and curves, and words of all formulas.
const std::vector<std::string> kTakenNames = {"s", "x",     "y",      "z",  "X", "Y",  "Z",
                                              "t", "stage", "lambda", "pi", "e", "deg"};

constexpr std::size_t kDeepestFormulas = 200;  // of names that need others: keeps slips from filling the stack

/// Whole numbers by formula may miss by rounding: 0.3 / 0.1.
constexpr double kRoundingOfWhole = 1e-9;

/// Replaces a variable that cannot be evaluated: most formulas of it give allowed, distinct numbers.
constexpr double kStandIn = 1.5;

bool contains(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// Removes the = in front.
std::string body_of(const std::string& formula) { return is_formula(formula) ? trimmed(formula).substr(1) : formula; }

std::string usual_slip(const std::string& formula, const std::string& problem) {
  if (formula.find("\u00B0") != std::string::npos) return "; degrees are written deg, as in 25 deg";
  if (formula.find("**") != std::string::npos) return "; powers are written ^";
  return problem.find("more than one value") != std::string::npos ? "; decimals have a point" : "";
}

/// Hint at a number like 90 in sin(90), too large for an angle in radians.
std::string angle_in_degrees(const std::string& formula) {
  constexpr double kWholeTurn = 6.2832;
  for (std::size_t open = formula.find('('); open < formula.size(); open = formula.find('(', open + 1)) {
    const bool is_longer = open > 3 && std::isalpha(static_cast<unsigned char>(formula[open - 4])) != 0;  // atan
    const std::string function = open < 3 || is_longer ? "" : formula.substr(open - 3, 3);
    const std::string argument = formula.substr(open + 1, formula.find(')', open) - open - 1);
    double angle = 0.0;
    if ((function == "sin" || function == "cos" || function == "tan") && parse_number(argument, angle).empty() &&
        std::abs(angle) > kWholeTurn)
      return ": " + function + "(" + argument + ") is of radians; did you mean " + function + "(" + argument + " deg)?";
  }
  return "";
}

/// Texts of the numbers of a value that may hold formulas.
std::vector<std::string> texts_of(const ParameterValue& value) {
  std::vector<std::string> texts;
  const auto add = [&texts](const auto& held) {
    using Held = std::decay_t<decltype(held)>;
    if constexpr (std::is_same_v<Held, std::string>) texts.push_back(held);
    if constexpr (std::is_same_v<Held, Teuchos::Array<std::string>>) texts = held.toVector();
    if constexpr (std::is_same_v<Held, int> || std::is_same_v<Held, double>) texts.push_back(shortest(held));
    if constexpr (std::is_same_v<Held, Teuchos::Array<int>> || std::is_same_v<Held, Teuchos::Array<double>>)
      for (const auto number : held) texts.push_back(shortest(number));
  };
  std::visit(add, value);
  return texts;
}

std::string coordinate_name(int axis, const std::string& point) {
  return std::string(1, "xyz"[axis]) + "(" + point + ")";
}

}  // namespace

ListSpec variables_spec() {
  return ListSpec(
             "Numbers by names, which formulas in place of numbers may use, as \"=2*L*sin(theta)\", and formulas of "
             "loads, tapers and curves too. Not: " +
             quoted_list(kTakenNames) + " and names of functions, which mean something else there.")
      .with_named_parameters("variable", real("")
                                             .required()
                                             .or_other("a formula")
                                             .means("A number, or a formula of other variables, as 25 deg or 2*L."));
}

Variables::Variables(const Teuchos::ParameterList& scene, const ParameterSource& source, const ParameterPath& path)
    : scene_(scene), place_(source, path) {
  if (!scene.isSublist(kVariables)) return;
  const Teuchos::ParameterList& list = scene.sublist(kVariables);
  for (const std::string& name : names_of(list)) {
    if (list.isSublist(name)) continue;  // reported by validate()
    const std::vector<std::string> texts = texts_of(written_value(list.getEntry(name)).value);
    if (texts.size() != 1) continue;
    place_[kVariables][name].attempt([&] { check_name(name, place_[kVariables][name]); });
    names_.push_back(name);
    named_[name] = {
        texts.front(), [this, name](const std::string& p) { return place_[kVariables][name].error(p); }, {}};
  }
}

void Variables::check_name(const std::string& name, const InputPlace& place) const {
  const auto is_letter = [](unsigned char c) { return (c | 32) >= 'a' && (c | 32) <= 'z'; };
  const auto belongs = [&](unsigned char c) { return is_letter(c) || (c >= '0' && c <= '9') || c == '_'; };
  if (!is_letter(name.front()) || !std::all_of(name.begin(), name.end(), belongs))
    throw place.error("name of a variable; allowed: a letter, and letters, digits and _ behind it");
  if (contains(kTakenNames, name) || contains(formula_functions(), name))
    throw place.error("name that means something else in formulas; allowed: other names than those of functions and " +
                      quoted_list(kTakenNames));
}

double Variables::number(const std::string& text, ParameterType type, const Refusal& refusal) {
  double value = kStandIn;
  if (!place_.source().attempt([&] { value = evaluated(text, type, refusal); })) is_guess_ = true;
  if (!is_guess_) return value;
  if (!std::isfinite(value)) return kStandIn;
  return type == ParameterType::integer || type == ParameterType::integer_array ? std::round(value) : value;
}

double Variables::evaluated(const std::string& text, ParameterType type, const Refusal& refusal) {
  double value = 0.0;
  if (!is_formula(text) && parse_number(text, value).empty()) return value;
  const auto seen = "value \"" + excerpt(text) + "\"";
  if (const std::string slip = angle_in_degrees(text); !slip.empty()) throw refusal(seen + slip);
  try {
    value = value_of_formula(body_of(text), {[this](const std::string& name) { return variable(name); },
                                             [this](int axis, const std::string& p) { return coordinate(axis, p); }});
  } catch (const std::invalid_argument& problem) {
    throw refusal(seen + " is no formula: " + problem.what() + usual_slip(text, problem.what()));
  }
  if (is_guess_) return value;
  if (!std::isfinite(value)) throw refusal(seen + " is " + shortest(value) + "; allowed: a finite number");
  if (type != ParameterType::integer && type != ParameterType::integer_array) return value;
  const double whole = std::round(value);
  if (std::abs(value - whole) > kRoundingOfWhole * std::max(1.0, std::abs(whole)) ||
      std::abs(whole) > std::numeric_limits<int>::max())
    throw refusal(seen + " is " + shortest(value) + "; allowed: a whole number");
  return whole;
}

double Variables::value_of(const std::string& name, Named& named) {
  is_guess_ = is_guess_ || named.is_guess;
  if (named.value) return *named.value;
  const std::string seen = "value \"" + excerpt(named.text) + "\" needs ";
  if (named.is_open) {
    std::string circle;
    for (auto one = std::find(open_.begin(), open_.end(), name); one != open_.end(); ++one) circle += *one + " -> ";
    throw named.refusal(seen + "itself: " + circle + name);
  }
  if (open_.size() >= kDeepestFormulas)
    throw named.refusal(seen + "names that need others, more than " + std::to_string(kDeepestFormulas) + " deep");
  named.is_open = true;
  open_.push_back(name);
  const bool was_guess = std::exchange(is_guess_, false);
  named.value = number(named.text, ParameterType::real, named.refusal);
  named.is_guess = is_guess_;
  is_guess_ = is_guess_ || was_guess;
  open_.pop_back();
  named.is_open = false;
  return *named.value;
}

double Variables::variable(const std::string& name) {
  if (const auto found = named_.find(name); found != named_.end()) return value_of(name, found->second);
  if (points_.empty()) read_points();
  const bool is_point = contains(points_, name);
  std::vector<std::string> known = formula_functions();
  known.insert(known.begin(), names_.begin(), names_.end());
  throw std::invalid_argument(
      "unknown name \"" + excerpt(name) +
      "\"; allowed: " + (names_.empty() ? "no variables, the scene has none" : "the variables " + quoted_list(names_)) +
      ", functions, pi, e, deg" +
      (is_point ? "; coordinates of a point are x('" + name + "'), y('" + name + "'), z('" + name + "')"
                : did_you_mean(name, known)));
}

double Variables::coordinate(int axis, const std::string& point) {
  if (points_.empty()) read_points();
  const auto found = named_.find(coordinate_name(axis, point));
  if (found != named_.end()) return value_of(found->first, found->second);
  throw std::invalid_argument("\"" + excerpt(point) +
                              "\" is not a point of the scene whose coordinates are written; allowed: " +
                              quoted_list(points_) + did_you_mean(point, points_));
}

/// Points of the list, then those of the table that are not in the list.
void Variables::read_points() {
  const auto add = [this](const std::string& point, const std::vector<std::string>& texts, const auto& refusal) {
    points_.push_back(point);
    for (int i = 0; i < 3; ++i)
      named_.try_emplace(coordinate_name(i, point),
                         Named{texts[i], [=](const std::string& problem) { return refusal(i, problem); }, {}});
  };
  static const Teuchos::ParameterList kNone;
  const Teuchos::ParameterList& list = scene_.isSublist("Points") ? scene_.sublist("Points") : kNone;
  for (auto entry = list.begin(); entry != list.end(); ++entry) {
    const std::vector<std::string> texts = texts_of(written_value(list.entry(entry)).value);
    const InputPlace here = place_["Points"][list.name(entry)];
    if (texts.size() == 3) add(list.name(entry), texts, [here](int, const std::string& p) { return here.error(p); });
  }
  if (!scene_.isSublist("Import") || !scene_.sublist("Import").isType<std::string>("Points File")) return;
  table_.emplace(points_table(scene_.sublist("Import"), place_["Import"]));
  table_->for_each([&](const CsvRecord& record) {
    add(table_->cell(record, "name"), {table_->cell(record, "x"), table_->cell(record, "y"), table_->cell(record, "z")},
        [this, line = record.line](int i, const std::string& p) {
          return table_->error(line, std::string(1, "xyz"[i]), p);
        });
  });
}

ParameterValue Variables::value(const ParameterValue& written, ParameterType type, const Refusal& refusal) {
  std::vector<double> numbers;
  for (const std::string& text : texts_of(written)) {
    double plain = 0.0;
    if (is_array(type) && !is_formula(text) && !parse_number(text, plain).empty())
      throw refusal("value \"" + excerpt(text) + "\" in an array; allowed: a number, or a formula that begins with =");
    const bool was_guess = std::exchange(is_guess_, false);
    numbers.push_back(number(text, type, refusal));
    is_guess_ = is_guess_ || was_guess;
  }
  switch (type) {
    case ParameterType::integer:
      return static_cast<int>(numbers.front());
    case ParameterType::integer_array:
      return Teuchos::Array<int>(numbers.begin(), numbers.end());
    case ParameterType::real_array:
      return Teuchos::Array<double>(numbers);
    default:
      return numbers.front();
  }
}

/// Entries that cannot hold a formula or the name of a variable are skipped at once.
void Variables::resolve(Teuchos::ParameterList& list, const ListSpec& spec, const ParameterPath& path) {
  if (spec.unchecked) return;
  for (auto entry = list.begin(); entry != list.end(); ++entry) {
    const Teuchos::ParameterEntry& held = list.entry(entry);
    const std::string& name = list.name(entry);
    if (held.isList()) {
      if (const ListSpec* inner = spec.list(name)) resolve(list.sublist(name), *inner, child(path, name));
      continue;
    }
    if (held.docString().empty() && !held.isType<std::string>() && !held.isType<Teuchos::Array<std::string>>())
      continue;
    if (const ParameterSpec* declared = spec.parameter(name))
      resolve(list.getEntry(name), *declared, child(path, name));
  }
}

void Variables::resolve(Teuchos::ParameterEntry& entry, const ParameterSpec& spec, const ParameterPath& path) {
  WrittenValue written = written_value(entry);
  if (stands_for_number(written.value, spec)) {
    const std::vector<std::string>& types = xml_names();
    const auto type = static_cast<ParameterType>(std::find(types.begin(), types.end(), written.type) - types.begin());
    const bool is_said = !written.type.empty() && is_array(type) == is_array(spec.type) &&
                         type != ParameterType::text && type != ParameterType::text_array;
    const auto refusal = [&](const std::string& problem) { return place_.source().error(path, problem); };
    if (!is_said) written.type = xml_name(spec.type);
    ParameterValue result;
    is_guess_ = false;
    place_.source().attempt([&] { result = value(written.value, is_said ? type : spec.type, refusal); });
    if (is_guess_ && !problem_of(result, spec).empty()) result = something_allowed(spec);
    set_result(entry, result, written);
  } else if (!spec.other_words.empty() && spec.choices.empty() && !(names_.empty() && !holds_formula(written.value))) {
    Teuchos::Array<std::string> texts = texts_of(written.value);
    for (std::string& text : texts) text = with_values(body_of(text));
    written.type = xml_name(spec.type);
    if (has_type(written.value, spec.type))
      set_result(entry, is_array(spec.type) ? ParameterValue(texts) : ParameterValue(texts.front()), written);
  }
}

std::string Variables::with_values(const std::string& formula) {
  return with_names_replaced(formula, [this](const std::string& name) {
    return named_.count(name) > 0 ? "(" + shortest(variable(name)) + ")" : name;
  });
}

void set_number(Teuchos::ParameterEntry& entry, int component, double value) {
  WrittenValue written = written_value(entry);
  const auto set = [&](auto type) {
    using Number = decltype(type);
    if (component < 0) return static_cast<void>(entry = Teuchos::ParameterEntry(static_cast<Number>(value)));
    auto numbers = Teuchos::getValue<Teuchos::Array<Number>>(entry);
    numbers[component] = static_cast<Number>(value);
    entry.setValue(numbers);  // as a whole: a changed default is no longer one
    if (auto* texts = std::get_if<Teuchos::Array<std::string>>(&written.value)) {
      (*texts)[component] = shortest(value);
      set_result(entry, numbers, written);
    }
  };
  entry.isType<int>() || entry.isType<Teuchos::Array<int>>() ? set(0) : set(0.0);
}

void set_formula(Teuchos::ParameterEntry& entry, int component, const std::string& formula) {
  Teuchos::Array<std::string> texts = texts_of(written_value(entry).value);
  if (component < 0) return static_cast<void>(entry = Teuchos::ParameterEntry(formula));
  texts[component] = formula;
  entry = Teuchos::ParameterEntry(texts);
}

std::vector<ParameterPath> paths_of_formulas(const Teuchos::ParameterList& list, const ParameterPath& path) {
  std::vector<ParameterPath> paths;
  for (auto entry = list.begin(); entry != list.end(); ++entry) {
    const ParameterPath here = child(path, list.name(entry));
    if (!list.entry(entry).isList() && !list.entry(entry).docString().empty()) paths.push_back(here);
    if (!list.entry(entry).isList()) continue;
    const std::vector<ParameterPath> inside = paths_of_formulas(list.sublist(list.name(entry)), here);
    paths.insert(paths.end(), inside.begin(), inside.end());
  }
  return paths;
}

}  // namespace mixbeam
