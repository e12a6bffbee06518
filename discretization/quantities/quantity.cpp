#include "discretization/quantities/quantity.hpp"

#include "discretization/parameters/binding.hpp"
#include "discretization/parameters/validate.hpp"
#include "discretization/quantities/quantity_kind.hpp"
#include "discretization/text/message_text.hpp"
#include "discretization/text/result_names.hpp"

#include <algorithm>
#include <map>

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
  std::vector<std::string> kinds;
  for (const auto& [kind, allowed] : forms) kinds.push_back(kind);
  one.bind(
      &Quantity::kind, choice("Quantity", kinds).required(),
      "What it is. Material components refer to the axes of the section, spatial ones to the global axes; a strain "
      "is axial and shear strain, a curvature twist and bending, without those of the undeformed member; an angle "
      "is that at Corner between Point and Other Point [radian]; length is that of the deformed member; stresses are "
      "the largest over the section (Shape and Material), the utilisation von Mises stress over Strength.");
  one.bind(&Quantity::point, text("Point"),
           "Where: name of a point, MEMBER@s (arc length from the start of the member) or MEMBER@p% (share of its "
           "length), or a pattern with *: each place that fits, or what Take says. Of a reaction: supported points.");
  one.bind(&Quantity::other_point, text("Other Point"), "distance, angle: the second place.");
  one.bind(&Quantity::corner, text("Corner"), "angle: the place where its two sides meet.");
  one.bind(&Quantity::member, text("Member"),
           "Name of a member, or a pattern with *; without Position all of it, of which Take says what.");
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
  one.bind(&Quantity::formula, text("Formula"),
           "Of quantities above it: NAME, NAME_x, NAME_1, ..., with _ in place of what is no letter or digit.");
  one.bind(&Quantity::limit, real("Limit").at_least(0.0),
           "Largest absolute value that is allowed in any completed step; beyond it the run ends with exit code 1.");
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

/// Largest and smallest are those of numbers, and a whole member has no single value.
void check_take(const Quantity& quantity, const InputPlace& place) {
  const bool is_extreme = quantity.take != Take::each && quantity.take != Take::sum;
  const bool is_number = quantity.kind == "length" || is_stress(quantity.kind);
  const bool is_vector = quantity.component.empty() && !is_number;
  if (is_extreme && is_vector)
    throw place["Component"].error(
        "missing; needed for the largest or smallest of a vector: \"x\", \"y\", \"z\", or "
        "\"1\", \"2\", \"3\", or \"norm\"");
  const bool is_whole_member = quantity.point.empty() && !quantity.position && quantity.kind != "length";
  if (!quantity.member.empty() && is_whole_member && !is_extreme)
    throw place["Take"].error(
        "along a whole member; allowed without \"Position\": \"largest\", \"smallest\", \"largest size\"");
}

}  // namespace

ListSpec quantities_spec() {
  return ListSpec("What is asked of a run: in every completed step, in monitor, result file, summary and report.")
      .with_named_lists("quantity", quantity_parameters().spec);
}

std::vector<Quantity> read_quantities(Teuchos::ParameterList& list, const ParameterSource& source,
                                      const ParameterPath& path) {
  validate(list, quantities_spec(), source, path);
  std::vector<Quantity> quantities;
  for (auto entry = list.begin(); entry != list.end(); ++entry) {
    const InputPlace place = InputPlace(source, path)[list.name(entry)];
    Quantity quantity = quantity_parameters().read(list.sublist(list.name(entry)));
    quantity.name = list.name(entry);
    if (const Problem problem = result_name_problem(quantity.name); !problem.empty())
      throw place.error("name " + problem);
    check_component(quantity, place);
    check_take(quantity, place);
    quantities.push_back(quantity);
  }
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
