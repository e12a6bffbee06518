#include "discretization/checks/expected_values.hpp"

#include "discretization/parameters/binding.hpp"
#include "discretization/parameters/validate.hpp"
#include "discretization/parameters/value.hpp"
#include "discretization/scene/load_cases.hpp"
#include "discretization/scene/names.hpp"
#include "discretization/text/message_text.hpp"
#include "discretization/text/number_text.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace mixbeam {

namespace {

const std::vector<std::string> kSpatial = {"x", "y", "z", "norm"};
const std::vector<std::string> kMaterial = {"1", "2", "3", "norm"};
const std::vector<std::string> kComponents = {"x", "y", "z", "1", "2", "3", "norm"};

/// Parameters that a quantity needs.
struct ExpectedKind {
  std::vector<std::string> needs;       ///< of "Point", "Member", "Position", "Component"; no others are allowed
  std::vector<std::string> components;  ///< allowed ones
};

const ExpectedKind kOfPoint = {{"Point", "Component"}, kSpatial};
const ExpectedKind kOfSection = {{"Member", "Position", "Component"}, kMaterial};
const std::vector<std::pair<std::string, ExpectedKind>> kKinds = {
    {"displacement", kOfPoint},      {"position", kOfPoint},        {"rotation", kOfPoint},
    {"reaction force", kOfPoint},    {"reaction moment", kOfPoint}, {"material force", kOfSection},
    {"material moment", kOfSection}, {"strain energy", {{}, {}}},   {"force energy", {{}, {}}},
    {"moment energy", {{}, {}}},     {"load factor", {{}, {}}},     {"jumps", {{}, {}}},
    {kStableName, {{}, {}}}};
const std::vector<std::string> kVerdicts = {"true", "false", "neutral", "unknown"};

bool contains(const std::vector<std::string>& words, const std::string& word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

void check_quantity(std::vector<std::string> known, const std::vector<std::string>& asked,
                    const ExpectedValue& expected, const InputPlace& place) {
  if (expected.is_asked || contains(known, expected.quantity)) return;
  known.insert(known.end(), asked.begin(), asked.end());
  throw place["Quantity"].error("value \"" + excerpt(expected.quantity) + "\"; allowed: " + quoted_list(known) +
                                did_you_mean(expected.quantity, known));
}

/// Checks the parameters of common quantities. Applications check their own; one of the list "Quantities" takes none.
void check_description(const Teuchos::ParameterList& list, const ExpectedValue& expected, const InputPlace& place) {
  const std::string& quantity = expected.quantity;
  const auto found =
      std::find_if(kKinds.begin(), kKinds.end(), [&](const auto& kind) { return kind.first == quantity; });
  if (found == kKinds.end() && !expected.is_asked) return;
  const ExpectedKind kind = expected.is_asked ? ExpectedKind{} : found->second;
  for (const std::string parameter : {"Point", "Member", "Position", "Component"}) {
    const bool needed = contains(kind.needs, parameter);
    if (needed == list.isParameter(parameter)) continue;
    throw place[parameter].error(std::string(needed ? "missing; needed" : "given, but has no meaning") +
                                 " for the quantity \"" + quantity + "\", which takes " + quoted_list(kind.needs));
  }
  if (!list.isParameter("Component")) return;
  const auto& component = list.get<std::string>("Component");
  if (contains(kind.components, component)) return;
  throw place["Component"].error("value \"" + component + "\" of the quantity \"" + quantity +
                                 "\"; allowed: " + quoted_list(kind.components));
}

/// Reads the value of `stable`: a word, compared without a tolerance.
void read_word(const Teuchos::ParameterList& list, const InputPlace& place, ExpectedValue& expected) {
  if (!list.isType<std::string>("Value"))
    throw place["Value"].error("a number for the quantity \"stable\"; allowed: " + quoted_list(kVerdicts));
  expected.word = list.get<std::string>("Value");
  for (const char* parameter : {"Absolute Tolerance", "Relative Tolerance", "Critical Point"})
    if (list.isParameter(parameter))
      throw place[parameter].error("given, but has no meaning for the quantity \"stable\"");
}

void read_tolerance(const Teuchos::ParameterList& list, const InputPlace& place, ExpectedValue& expected) {
  const bool absolute = list.isParameter("Absolute Tolerance");
  if (absolute == list.isParameter("Relative Tolerance")) {
    throw place.error(std::string(absolute ? "both" : "neither") +
                      R"( of "Absolute Tolerance" and "Relative Tolerance" given; allowed: exactly one)");
  }
  expected.kind = absolute ? ToleranceKind::absolute : ToleranceKind::relative;
  expected.tolerance = list.get<double>(absolute ? "Absolute Tolerance" : "Relative Tolerance");
  if (!absolute && expected.value == 0.0) {
    throw place["Relative Tolerance"].error(
        "no difference is small relative to the value 0; allowed: \"Absolute Tolerance\"");
  }
}

BoundList<ExpectedValue> parameters_of_one(const std::vector<std::string>& own_quantities) {
  std::vector<std::string> quantities = common_quantities();
  quantities.insert(quantities.end(), own_quantities.begin(), own_quantities.end());
  BoundList<ExpectedValue> one("A value that the run must reproduce.");
  one.bind(
      &ExpectedValue::quantity,
      choice("Quantity", quantities)
          .required()
          .or_other("a name of the list \"Quantities\", with .x, .y, .z or .1, .2, .3 for one component of a vector"),
      "The compared quantity.");
  one.bind(&ExpectedValue::point, text("Point"),
           "Name of the point, for a quantity of a point; for a reaction: a supported one.");
  one.bind(&ExpectedValue::member, text("Member"), "Name of the member, for a material force or moment.");
  one.bind(&ExpectedValue::position, real("Position").at_least(0.0).at_most(1.0),
           "Where along the member: arc length from its start over its length; between two elements the value of the "
           "second one counts.");
  one.bind(&ExpectedValue::component, choice("Component", kComponents),
           "For vectors: component x, y, z in global axes, or 1 (along), 2, 3 of a material force or moment in the "
           "axes of the section, or the norm.");
  one.bind(&ExpectedValue::load_case, text("Case"),
           "Load case in which it is compared; needed where the scene has load cases.");
  one.bind(&ExpectedValue::load_factor, real("Load Factor").at_least(0.0),
           "When it is compared; at the end of the run if absent.");
  one.bind(&ExpectedValue::critical_point, integer("Critical Point").at_least(1),
           "The value belongs to the state at the critical point (limit point or bifurcation) of this number on the "
           "path, counted from 1.");
  one.spec.add(real("Value").or_one_of(kVerdicts).required(),
               "The expected value, in the scene's units; a word for the quantity stable.");
  one.spec.add(real("Absolute Tolerance").above(0.0), "Largest difference, in the units of the value.");
  one.spec.add(real("Relative Tolerance").above(0.0), "Largest difference, as a share of the value.");
  one.bind(&ExpectedValue::source, text("Source").required(),
           "Where the value comes from: paper and table, formula, other program.");
  return one;
}

ExpectedValue read_one(const BoundList<ExpectedValue>& parameters, const Teuchos::ParameterList& list,
                       const std::string& name, const InputPlace& place, const std::vector<std::string>& asked) {
  ExpectedValue expected = parameters.read(list);
  expected.name = name;
  expected.is_asked = contains(asked, expected.quantity);
  check_quantity(parameters.spec.find_parameter("Quantity")->choices, asked, expected, place);
  check_description(list, expected, place);
  if (expected.source.empty())
    throw place["Source"].error("value \"\"; allowed: where the value comes from (paper and table, formula, program)");
  if (expected.critical_point && expected.load_factor)
    throw place["Load Factor"].error(R"(given besides "Critical Point", which has its own; allowed: one of them)");
  if (expected.quantity == kStableName) {
    read_word(list, place, expected);
    return expected;
  }
  if (list.isType<std::string>("Value"))
    throw place["Value"].error("value \"" + list.get<std::string>("Value") + "\" for the quantity \"" +
                               expected.quantity + "\"; allowed: a number");
  expected.value = list.get<double>("Value");
  read_tolerance(list, place, expected);
  return expected;
}

bool is_reaction(const std::string& quantity) { return quantity == "reaction force" || quantity == "reaction moment"; }

void check_case(const ExpectedValue& value, const Scene& scene, const InputPlace& place) {
  const std::vector<std::string> cases = alternatives(scene);
  if (value.load_case.empty() && cases.empty()) return;
  if (contains(cases, value.load_case)) return;
  const std::string seen = value.load_case.empty() ? "missing" : "value \"" + excerpt(value.load_case) + "\"";
  throw place["Case"].error(seen + "; allowed: a load case or combination of the scene: " + quoted_list(cases) +
                            did_you_mean(value.load_case, cases));
}

void check_supported(const ExpectedValue& value, const Scene& scene, const InputPlace& place) {
  std::vector<std::string> supported;
  for (const Support& support : scene.supports) supported.push_back(support.point);
  if (contains(supported, value.point)) return;
  throw place["Point"].error("value \"" + excerpt(value.point) +
                             "\" has no support, so no reaction; allowed: " + quoted_list(supported));
}

}  // namespace

const std::vector<std::string>& common_quantities() {
  static const std::vector<std::string> quantities = [] {
    std::vector<std::string> names;
    for (const auto& [name, kind] : kKinds) names.push_back(name);
    return names;
  }();
  return quantities;
}

ListSpec expected_values_spec(const std::vector<std::string>& own_quantities) {
  return ListSpec("Expected answers; the run fails if one is missed.")
      .with_named_lists("check", parameters_of_one(own_quantities).spec);
}

std::vector<ExpectedValue> read_expected_values(Teuchos::ParameterList& list, const ParameterSource& source,
                                                const std::vector<std::string>& own_quantities,
                                                const ParameterPath& path, const std::vector<std::string>& asked) {
  if (list.numParams() == 0) return {};
  const BoundList<ExpectedValue> parameters = parameters_of_one(own_quantities);
  std::vector<ExpectedValue> expected;
  source.collect([&] {
    validate(list, expected_values_spec(own_quantities), source, path);
    for (const std::string& name : names_of(list)) {
      const InputPlace place = InputPlace(source, path)[name];
      place.attempt([&] { expected.push_back(read_one(parameters, list.sublist(name), name, place, asked)); });
    }
  });
  return expected;
}

void check_expected_values(const std::vector<ExpectedValue>& expected, const Scene& scene,
                           const ParameterSource& source, const ParameterPath& path) {
  if (expected.empty()) return;  // the names of 75,000 members take a hundredth of their run
  const SceneNames names(scene);
  const auto check = [&](const ExpectedValue& value, const InputPlace& place) {
    check_case(value, scene, place);
    const bool is_apart = !value.point.empty() && names.members_at(value.point) == nullptr;
    if (is_apart && names.has_point(value.point) && source.has_mistakes()) throw InputError("");  // of members
    if (is_apart) throw unknown_name(place["Point"], "point", value.point, names.point_names());
    if (!value.member.empty() && names.member(value.member) == nullptr)
      throw unknown_name(place["Member"], "member", value.member, names.member_names());
    if (is_reaction(value.quantity)) check_supported(value, scene, place);
    const int stages = alternatives(scene).empty() ? scene.stages : scene_of_case(scene, value.load_case).stages;
    if (value.load_factor.value_or(0.0) <= stages) return;
    throw place["Load Factor"].error("value " + shortest(*value.load_factor) + "; allowed: at most " +
                                     std::to_string(stages) + ", where the load path of the scene ends");
  };
  source.collect([&] {
    for (const ExpectedValue& value : expected) {
      const InputPlace place = InputPlace(source, path)[value.name];
      place.attempt([&] { check(value, place); });
    }
  });
}

ExpectationResult compare(const ExpectedValue& expected, double actual) {
  ExpectationResult comparison;
  comparison.difference = actual - expected.value;
  if (expected.kind == ToleranceKind::relative) comparison.difference /= std::abs(expected.value);
  comparison.pass = std::abs(comparison.difference) <= expected.tolerance;  // false for NaN
  return comparison;
}

}  // namespace mixbeam
