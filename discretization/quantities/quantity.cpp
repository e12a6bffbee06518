#include "discretization/quantities/quantity.hpp"

#include "discretization/parameters/binding.hpp"
#include "discretization/parameters/validate.hpp"
#include "discretization/parameters/value.hpp"
#include "discretization/quantities/quantity_kind.hpp"
#include "discretization/scene/load_cases.hpp"
#include "discretization/text/message_text.hpp"
#include "discretization/text/result_names.hpp"

#include <algorithm>
#include <map>
#include <tuple>

namespace mixbeam {

namespace {

std::vector<Form> forms_of(const QuantityKind& kind) {
  switch (kind.source) {
    case QuantitySource::motion:
    case QuantitySource::section:
      return {{{"Point"}, {"Component", "Take", "Side", "Limit"}},
              {{"Member", "Position"}, {"Side", "Component", "Take", "Limit"}},
              {{"Member", "Take", "Component"}, {"Limit"}}};
    case QuantitySource::triad:
      return {{{"Point"}, {"Component", "Side"}}, {{"Member", "Position"}, {"Component", "Side"}}};
    case QuantitySource::stress:
      return {{{"Point"}, {"Take", "Side", "Limit"}},
              {{"Member", "Position"}, {"Side", "Take", "Limit"}},
              {{"Member", "Take"}, {"Limit"}}};
    case QuantitySource::reaction:
      return {{{"Point"}, {"Component", "Take", "Limit"}}};
    case QuantitySource::between:
      if (kind.name == "distance") return {{{"Point", "Other Point"}, {"Limit"}}};
      return {{{"Point", "Other Point", "Corner"}, {"Limit"}}};
    case QuantitySource::length:
      return {{{"Member"}, {"Take", "Limit"}}};
    case QuantitySource::mode:
      return {{{"Mode"}, {"Limit"}}};
    case QuantitySource::structure:
      return {{{}, {"Limit"}}};
    case QuantitySource::formula:
      break;
  }
  return {{{"Formula"}, {"Limit"}}};
}

BoundList<Quantity> declared_quantity_parameters() {
  BoundList<Quantity> one("A number, or a vector, that is followed over the steps.");
  std::map<std::string, std::vector<Form>> forms;
  for (const QuantityKind& kind : quantity_kinds()) forms[kind.name] = forms_of(kind);
  for (auto& [kind, allowed] : forms)
    for (Form& form : allowed)
      if (kind != "triad")
        form.optional.insert(form.optional.end(), {"Span", "Span Ratio", "Case", "Stage", "Relative To"});
  std::vector<std::string> kinds;
  for (const auto& [kind, allowed] : forms) kinds.push_back(kind);
  one.bind(
      &Quantity::kind, choice("Quantity", kinds).required(),
      "What it is. Material components refer to the axes of the section, spatial ones to the global axes; a strain is "
      "axial and shear strain, a curvature twist and bending, without those of the undeformed member; an angle is that "
      "at Corner between Point and Other Point [radian]; length is that of the deformed member; stresses are the "
      "largest over the section (Shape and Material), the utilisation von Mises stress over Strength.");
  one.bind(
      &Quantity::point, text("Point"),
      "Where: name of a point, MEMBER@s (arc length from the start of the member) or MEMBER@p% (share of its length), "
      "or a pattern with *, ?, [abc]: each place that fits, or what Take says. Of a reaction: supported points.");
  one.bind(&Quantity::mode, integer("Mode").at_least(1),
           "natural frequency: number of the mode, one of those that the list Modes of Analysis asks for; omega / (2 "
           "pi), known in the steps that have modes.");
  one.bind(&Quantity::other_point, text("Other Point"), "distance, angle: the second place.");
  one.bind(&Quantity::corner, text("Corner"), "angle: the place where its two sides meet.");
  one.bind(&Quantity::member, text("Member"),
           "Name of a member, or a pattern with *, ?, [abc]; without Position all of it, of which Take says what.");
  one.bind(&Quantity::position, real("Position").at_least(0.0).at_most(1.0),
           "Where along the member: arc length from its start over its length.");
  one.bind(&Quantity::before_vertex, text("Side").by_default(),
           "At a vertex between two elements: the value of the element after it, or of the one before it.",
           {{"after", false}, {"before", true}});
  one.bind(&Quantity::component, choice("Component", {"x", "y", "z", "1", "2", "3", "norm", "g1", "g2", "g3"}),
           "x, y, z in global axes; 1 (along), 2, 3 in the axes of the section; norm; g1, g2, g3 of a triad; all of "
           "them if absent.");
  one.bind(&Quantity::take, text("Take").by_default(),
           "What is taken of several places, or along members: each, their sum (of moments: without the moments of "
           "forces about each other), the largest, the smallest, or the one of largest size with its sign.",
           {{"each", Take::each},
            {"sum", Take::sum},
            {"largest", Take::largest},
            {"smallest", Take::smallest},
            {"largest size", Take::largest_size}});
  one.bind(&Quantity::formula, text("Formula").or_other("a formula"),
           "Of variables and of quantities above it: NAME, NAME_x, NAME_1, ..., with _ in place of what is no letter "
           "or digit.");
  one.bind(&Quantity::limit, real("Limit").at_least(0.0),
           "Largest absolute value that is allowed in any completed step; beyond it the run ends with exit code 1.");
  one.bind(&Quantity::ratio, real("Span Ratio").above(0.0), "In place of Limit: it is Span over this number, as 300.");
  one.bind(&Quantity::span, real("Span").above(0.0),
           "With Span Ratio: the length that it is a part of, a number or a formula, as \"=x('right')-x('left')\" "
           "[length].");
  one.bind(&Quantity::load_case, text("Case"),
           "Load case or combination in which alone the limit counts; " + kWildcards + ".");
  one.bind(&Quantity::stage, integer("Stage").at_least(1), "Stage in whose steps alone the limit counts.");
  one.bind(&Quantity::relative_to, integer("Relative To").at_least(0),
           "Stage from whose end on the limit counts, for the change since then: deflection by live load, without that "
           "by dead load or by prestress.");
  one.spec.with_forms("Quantity", forms);
  return one;
}

const BoundList<Quantity>& quantity_parameters() {
  static const BoundList<Quantity> parameters = declared_quantity_parameters();
  return parameters;
}

void check_component(const Quantity& quantity, const InputPlace& place) {
  if (quantity.component.empty()) return;
  std::vector<std::string> allowed = {"x", "y", "z", "norm"};
  if (quantity_kind(quantity.kind).is_material()) allowed = {"1", "2", "3", "norm"};
  if (quantity.kind == "triad") allowed = {"g1", "g2", "g3"};
  if (std::find(allowed.begin(), allowed.end(), quantity.component) != allowed.end()) return;
  throw place["Component"].error("value \"" + quantity.component + "\" of the quantity \"" + quantity.kind +
                                 "\"; allowed: " + quoted_list(allowed));
}

/// Checks Take: only numbers have a largest and smallest, and a whole member has no single value.
void check_take(const Quantity& quantity, const InputPlace& place) {
  const bool is_extreme = quantity.take != Take::each && quantity.take != Take::sum;
  const bool is_number = quantity.kind == "length" || is_stress(quantity.kind);
  const bool is_vector = quantity.component.empty() && !is_number;
  if (is_extreme && is_vector)
    throw place["Component"].error(
        "missing; needed for the largest or smallest of a vector: \"x\", \"y\", \"z\", or \"1\", \"2\", \"3\", or "
        "\"norm\"");
  const bool is_whole_member = quantity.point.empty() && !quantity.position && quantity.kind != "length";
  if (!quantity.member.empty() && is_whole_member && !is_extreme)
    throw place["Take"].error(
        "along a whole member; allowed without \"Position\": \"largest\", \"smallest\", \"largest size\"");
}

void check_limit(const Quantity& quantity, const Teuchos::ParameterList& list, const InputPlace& place) {
  if (quantity.limit && quantity.ratio)
    throw place["Span Ratio"].error("given beside \"Limit\"; allowed: one of the two");
  if (quantity.ratio.has_value() != quantity.span.has_value())
    throw place[quantity.ratio ? "Span" : "Span Ratio"].error("missing; needed: \"Span\" and \"Span Ratio\", or none");
  for (const char* of_limit : {"Case", "Stage", "Relative To"})
    if (list.isParameter(of_limit) && !quantity.allowed())
      throw place[of_limit].error("given without a limit; allowed: with \"Limit\" or \"Span Ratio\"");
  if (quantity.stage && quantity.relative_to && *quantity.relative_to >= *quantity.stage)
    throw place["Relative To"].error("value " + std::to_string(*quantity.relative_to) +
                                     "; allowed: a stage before \"Stage\", or 0 for the state before any load");
}

}  // namespace

bool Quantity::is_limited_in(const std::string& one) const {
  return allowed() && (load_case.empty() || load_case == one || (has_wildcard(load_case) && matches(load_case, one)));
}

std::string Quantity::since() const {
  if (!relative_to) return "";
  return *relative_to == 0 ? " since before any load" : " since the end of stage " + std::to_string(*relative_to);
}

void check_limits(const std::vector<Quantity>& quantities, const Scene& scene, const InputPlace& place) {
  const std::vector<std::string> cases = alternatives(scene);
  for (const Quantity& quantity : quantities) {
    const InputPlace here = place[quantity.name];
    if (!quantity.load_case.empty() && names_meant(quantity.load_case, cases).empty())
      throw here["Case"].error("value \"" + excerpt(quantity.load_case) +
                               "\" is not a load case or combination of the scene; allowed: " + quoted_list(cases) +
                               did_you_mean(quantity.load_case, cases));
    for (const auto& [stage, name, last] : {std::tuple(quantity.stage, "Stage", scene.stages),
                                            std::tuple(quantity.relative_to, "Relative To", scene.stages - 1)})
      if (stage && *stage > last)
        throw here[name].error("value " + std::to_string(*stage) + "; allowed: up to " + std::to_string(last) +
                               ", as the scene has " + std::to_string(scene.stages) + " stage(s)");
  }
}

const ListSpec& quantities_spec() {
  static const ListSpec spec =
      ListSpec("What is asked of a run: in every completed step, in monitor, result file, summary and report.")
          .with_named_lists("quantity", quantity_parameters().spec);
  return spec;
}

std::vector<Quantity> read_quantities(Teuchos::ParameterList& list, const ParameterSource& source,
                                      const ParameterPath& path) {
  std::vector<Quantity> quantities;
  const auto read_one = [&](const std::string& name, const InputPlace& place) {
    Quantity quantity = quantity_parameters().read(list.sublist(name));
    quantity.name = name;
    if (const Problem problem = result_name_problem(quantity.name); !problem.empty())
      throw place.error("name " + problem);
    check_component(quantity, place);
    check_take(quantity, place);
    check_limit(quantity, list.sublist(name), place);
    quantities.push_back(quantity);
  };
  source.collect([&] {
    validate(list, quantities_spec(), source, path);
    for (const std::string& name : names_of(list)) {
      const InputPlace place = InputPlace(source, path)[name];
      place.attempt([&] { read_one(name, place); });
    }
  });
  return quantities;
}

Quantity quantity_of(const ExpectedValue& expected) {
  Quantity quantity;
  quantity.name = expected.name;
  quantity.kind = expected.quantity;
  quantity.point = expected.point;
  quantity.member = expected.member;
  if (!expected.member.empty()) quantity.position = expected.position;
  quantity.component = expected.component;
  return quantity;
}

}  // namespace mixbeam
