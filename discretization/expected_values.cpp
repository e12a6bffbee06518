#include "discretization/expected_values.hpp"

#include "discretization/validate.hpp"

#include <algorithm>
#include <cmath>

namespace mixbeam {

namespace {

const std::vector<std::string> kComponents = {"x", "y", "z", "norm"};

bool is_point_quantity(const std::string& quantity) {
  const std::vector<std::string>& known = point_quantities();
  return std::find(known.begin(), known.end(), quantity) != known.end();
}

void read_tolerance(const Teuchos::ParameterList& list, const ParameterSource& source, const ParameterPath& path,
                    ExpectedValue& expected) {
  const bool absolute = list.isParameter("Absolute Tolerance");
  if (absolute == list.isParameter("Relative Tolerance")) {
    throw source.error(path, std::string(absolute ? "both" : "neither") +
                                 R"( of "Absolute Tolerance" and "Relative Tolerance" given; allowed: exactly one)");
  }
  expected.kind = absolute ? ToleranceKind::absolute : ToleranceKind::relative;
  expected.tolerance = list.get<double>(absolute ? "Absolute Tolerance" : "Relative Tolerance");
  if (!absolute && expected.value == 0.0) {
    throw source.error(child(path, "Relative Tolerance"),
                       "no difference is small relative to the value 0; allowed: \"Absolute Tolerance\"");
  }
}

ExpectedValue read_one(const Teuchos::ParameterList& list, const std::string& name, const ParameterSource& source,
                       const ParameterPath& path) {
  ExpectedValue expected;
  expected.name = name;
  expected.quantity = list.get<std::string>("Quantity");
  for (const std::string parameter : {"Point", "Component"}) {
    if (!is_point_quantity(expected.quantity) || list.isParameter(parameter)) continue;
    throw source.error(child(path, parameter), "missing; needed for the quantity \"" + expected.quantity + "\"");
  }
  if (list.isParameter("Point")) expected.point = list.get<std::string>("Point");
  if (list.isParameter("Component")) expected.component = list.get<std::string>("Component");
  if (list.isParameter("Load Factor")) expected.load_factor = list.get<double>("Load Factor");
  expected.value = list.get<double>("Value");
  expected.source = list.get<std::string>("Source");
  read_tolerance(list, source, path, expected);
  return expected;
}

}  // namespace

const std::vector<std::string>& point_quantities() {
  static const std::vector<std::string> quantities = {"displacement", "position", "rotation"};
  return quantities;
}

ListSpec expected_values_spec(const std::vector<std::string>& own_quantities) {
  std::vector<std::string> quantities = point_quantities();
  quantities.insert(quantities.end(), own_quantities.begin(), own_quantities.end());
  ListSpec one("A value that the run must reproduce.");
  one.add(choice("Quantity", quantities).required().means("What is compared."));
  one.add(text("Point").means("Name of the point, for a quantity of a point."));
  one.add(choice("Component", kComponents).means("Component in global axes, or the norm; for vectors."));
  one.add(real("Load Factor").at_least(0.0).means("When it is compared; at the end of the run if absent."));
  one.add(real("Value").required().means("The expected value, in the scene's units."));
  one.add(real("Absolute Tolerance").above(0.0).means("Largest difference, in the units of the value."));
  one.add(real("Relative Tolerance").above(0.0).means("Largest difference, as a share of the value."));
  one.add(text("Source").required().means("Where the value comes from: paper and table, formula, other program."));
  return ListSpec("Expected answers; the run fails if one is missed.").with_named_lists("check", one);
}

std::vector<ExpectedValue> read_expected_values(Teuchos::ParameterList& list, const ParameterSource& source,
                                                const std::vector<std::string>& own_quantities,
                                                const ParameterPath& path) {
  validate(list, expected_values_spec(own_quantities), source, path);
  std::vector<ExpectedValue> expected;
  for (auto entry = list.begin(); entry != list.end(); ++entry) {
    const std::string& name = list.name(entry);
    expected.push_back(read_one(list.sublist(name), name, source, child(path, name)));
  }
  return expected;
}

ExpectationResult compare(const ExpectedValue& expected, double actual) {
  ExpectationResult comparison;
  comparison.difference = actual - expected.value;
  if (expected.kind == ToleranceKind::relative) comparison.difference /= std::abs(expected.value);
  comparison.pass = std::abs(comparison.difference) <= expected.tolerance;  // false for NaN
  return comparison;
}

}  // namespace mixbeam
