#include "apps/common/run/scene_gradients.hpp"

#include "apps/common/run/quantity_values.hpp"
#include "discretization/parameters/binding.hpp"
#include "discretization/parameters/parameter_file.hpp"
#include "discretization/parameters/value.hpp"
#include "discretization/quantities/quantity.hpp"
#include "discretization/reading/read_scene.hpp"
#include "discretization/reading/variables.hpp"
#include "discretization/scene/load_cases.hpp"
#include "discretization/text/message_text.hpp"
#include "discretization/text/number_text.hpp"
#include "nonlinear/linear/linear_solver.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mixbeam {

namespace {

/// Difference step relative to the size of a number, of points to the length of the shortest member: at fourth order,
/// truncation and rounding are both 1e-12.
constexpr double kStep = 0.0005;
/// Limit on the numbers, each of which costs four evaluations of the equations.
constexpr std::size_t kMostNumbers = 10'000;

const std::string kQuantities = "Quantities", kAnyName = "*";
/// Prefix of the number of a critical point on the path, counted from 1, or of a pattern.
const std::string kCriticalLoad = "load factor at critical point ";

bool means_critical_points(const std::string& text) { return text.rfind(kCriticalLoad, 0) == 0; }

BoundList<GradientParameters> gradient_parameters() {
  BoundList<GradientParameters> gradient(
      "Gradients of quantities with respect to numbers of the scene, at the end of the path at its load factor: one "
      "solution for each quantity, a few evaluations for each number, no further run.");
  gradient.bind(&GradientParameters::of, array("Of", ParameterType::text_array).required(),
                "Names of quantities, as the list Quantities gives them (\"tip.y\"), or patterns: " + kWildcards +
                    "; \"" + kCriticalLoad + "1\": of the first limit point or bifurcation of the path.");
  gradient.bind(&GradientParameters::by, array("With Respect To", ParameterType::text_array).by_default(),
                "Paths of numbers below the list Scene (\"Sections/*/EI2\", \"Points/tip[0]\", \"Variables/L\"), or "
                "patterns of each name in them; without [...] all numbers of an array.");
  gradient.bind(&GradientParameters::by_element, boolean("By Element").by_default(),
                "Also with respect to stiffnesses, compliances and natural strains of each element by itself.");
  return gradient;
}

const BoundList<GradientParameters> kGradientParameters = gradient_parameters();

/// Adds the numbers of a parameter that a path matches; default values only if named exactly.
void add_numbers(const Teuchos::ParameterEntry& entry, const NumberPath& wanted, const NumberPath& found,
                 std::vector<NumberPath>& paths) {
  if (entry.isDefault() && has_wildcard(wanted.names.back())) return;
  const std::vector<double> values = numbers_in(entry);
  const bool is_array = !entry.isType<double>();
  for (std::size_t i = 0; i < values.size(); ++i) {
    const int component = is_array ? static_cast<int>(i) : -1;
    if ((wanted.component != -1 && wanted.component != component) || !std::isfinite(values[i])) continue;
    paths.push_back({found.names, component});
  }
}

/// Descends into the lists with matching names.
void find_numbers(const Teuchos::ParameterList& list, const NumberPath& wanted, const NumberPath& above,
                  std::vector<NumberPath>& paths) {
  const std::size_t depth = above.names.size();
  const bool is_last = depth + 1 == wanted.names.size();
  for (const std::string& name : names_meant(wanted.names[depth], names_of(list))) {
    if (list.isSublist(name) == is_last) continue;
    NumberPath here = above;
    here.names.push_back(name);
    if (is_last)
      add_numbers(*list.getEntryPtr(name), wanted, here, paths);
    else
      find_numbers(list.sublist(name), wanted, here, paths);
  }
}

/// The requested numbers, each once, in the order of the list.
std::vector<NumberPath> all_numbers(const Teuchos::ParameterList& scene, const GradientParameters& asked) {
  std::vector<NumberPath> all;
  std::vector<std::string> known;
  for (const std::string& text : asked.by)
    for (const NumberPath& path : numbers_meant(scene, text)) {
      if (std::find(known.begin(), known.end(), path.text()) != known.end()) continue;
      known.push_back(path.text());
      all.push_back(path);
    }
  return all;
}

/// Matching names, each once; texts without a match are kept. `of_points`: only critical points, otherwise only others.
std::vector<std::string> all_meant(const std::vector<std::string>& names, const std::vector<std::string>& texts,
                                   bool of_points) {
  std::vector<std::string> all;
  for (const std::string& text : texts) {
    if (means_critical_points(text) != of_points) continue;
    std::vector<std::string> meant = names_meant(text, names);
    if (meant.empty()) meant = {text};
    for (const std::string& name : meant)
      if (std::count(all.begin(), all.end(), name) == 0) all.push_back(name);
  }
  return all;
}

/// Size of a number or of the other components; if all are zero, a typical size of its kind.
double size_of(const NumberPath& path, const Teuchos::ParameterEntry& entry, const Simulation& at) {
  const std::vector<double>& lengths = at.model().mesh().member_length;
  const double shortest = *std::min_element(lengths.begin(), lengths.end());
  const double length = at.model().structure().length;
  const std::string &list = path.names.front(), &name = path.names.back();
  if (list == "Points") return shortest;
  double size = 0.0;
  for (const double value : numbers_in(entry))
    if (std::isfinite(value)) size = std::max(size, std::abs(value));
  if (size > 0.0) return size;
  if (list == "Members" && path.component >= 0) return shortest;
  const ResidualScales scales = scales_of(at.model(), at.state(), at.load_factor());
  const double per_length = list == "Distributed Loads" ? 1.0 / length : 1.0;
  if (name == "Force") return per_length * scales.force;
  if (name == "Moment" || name == "Couple") return per_length * scales.moment;
  if (name == "Prescribed Displacement") return length;
  return name == "Curvature" ? 1.0 / length : 1.0;
}

/// The list "Scene" with `more` added to a number.
Teuchos::ParameterList list_with(const XmlParameters& xml, const NumberPath& path, double more) {
  Teuchos::ParameterList list(xml.list->sublist("Scene"));
  auto& entry = const_cast<Teuchos::ParameterEntry&>(entry_of(list, path));
  const double value = numbers_in(entry)[static_cast<std::size_t>(std::max(0, path.component))];
  set_number(entry, path.component, value + more);
  return list;
}

/// The scene with `more` added to a number, on the mesh of the solved scene.
std::shared_ptr<const Scene> scene_with(const XmlParameters& xml, const NumberPath& path, double more,
                                        const Scene& solved, const std::string& load_case) {
  Teuchos::ParameterList list = list_with(xml, path, more);
  try {
    Scene scene = scene_of_case(read_scene(list, xml.source), load_case);
    if (scene.members.size() == solved.members.size())
      for (std::size_t i = 0; i < scene.members.size(); ++i) {
        scene.members[i].order = solved.members[i].order;
        scene.members[i].elements = solved.members[i].elements;
        if (scene.members[i].stations.empty()) scene.members[i].stations = solved.members[i].stations;
      }
    return std::make_shared<const Scene>(std::move(scene));
  } catch (const InputError& error) {
    throw InputError("the gradient with respect to \"" + path.text() + "\": " + error.what());
  }
}

/// Quantities with another number; empty unless their formulas may depend on it (variables and points).
std::function<QuantitySet(double)> quantities_with(const XmlParameters& xml, const NumberPath& path,
                                                   const Scene& solved) {
  const bool may_be_named = path.names.front() == "Variables" || path.names.front() == "Points";
  if (!may_be_named || !xml.list->isSublist(kQuantities) ||
      paths_of_formulas(xml.list->sublist(kQuantities), {kQuantities}).empty())
    return {};
  return [&xml, &solved, path](double more) { return quantities_of(list_with(xml, path, more), xml, solved); };
}

std::vector<SceneNumber> scene_numbers(const Simulation& at, const GradientParameters& asked, const XmlParameters& xml,
                                       const std::string& load_case) {
  const Teuchos::ParameterList& list = xml.list->sublist("Scene");
  std::vector<SceneNumber> numbers;
  for (const NumberPath& path : all_numbers(list, asked)) {
    SceneNumber& number = numbers.emplace_back();
    number.name = path.text();
    number.step = kStep * size_of(path, entry_of(list, path), at);
    number.scene_with = [&xml, &at, path, load_case](double more) {
      return scene_with(xml, path, more, at.scene(), load_case);
    };
    number.quantities_with = quantities_with(xml, path, at.scene());
    number.is_of_pattern = std::none_of(asked.by.begin(), asked.by.end(), [&](const std::string& text) {
      return number_path(text).text() == path.text();
    });
  }
  return numbers;
}

}  // namespace

std::vector<double> numbers_in(const Teuchos::ParameterEntry& entry) {
  if (entry.isType<double>()) return {Teuchos::getValue<double>(entry)};
  if (!entry.isType<Teuchos::Array<double>>()) return {};
  const auto& values = Teuchos::getValue<Teuchos::Array<double>>(entry);
  return {values.begin(), values.end()};
}

const Teuchos::ParameterEntry& entry_of(const Teuchos::ParameterList& scene, const NumberPath& path) {
  const Teuchos::ParameterList* here = &scene;
  for (std::size_t i = 0; i + 1 < path.names.size(); ++i) here = &here->sublist(path.names[i]);
  return *here->getEntryPtr(path.names.back());
}

std::vector<std::string> names_of_values(const QuantitySet& quantities) {
  std::vector<std::string> names;
  for (const QuantitySet::Column& column : quantities.columns())
    if (column.is_value) names.push_back(column.name);
  return names;
}

QuantitySet quantities_of(const Teuchos::ParameterList& scene_list, const XmlParameters& xml, const Scene& scene) {
  Teuchos::ParameterList list(xml.list->sublist(kQuantities));
  Variables(scene_list, xml.source).resolve(list, quantities_spec(), {kQuantities});
  return QuantitySet(read_quantities(list, xml.source), scene, {xml.source, {kQuantities}});
}

std::vector<NumberPath> numbers_meant(const Teuchos::ParameterList& scene, const std::string& text) {
  std::vector<NumberPath> paths;
  find_numbers(scene, number_path(text), {}, paths);
  return paths;
}

std::string unknown_number(const Teuchos::ParameterList& scene, const std::string& text) {
  std::string any = kAnyName;
  for (std::size_t i = 1; i < number_path(text).names.size(); ++i) any += "/" + kAnyName;
  std::vector<std::string> known;
  for (const NumberPath& path : numbers_meant(scene, any)) known.push_back(path.text());
  return "value \"" + excerpt(text) +
         "\" is no path of a finite real number of the list \"Scene\"; allowed: paths as \"Sections/NAME/EI2\" or "
         "\"Points/NAME[0]\", patterns of them" +
         did_you_mean(text, known);
}

ListSpec gradient_spec() { return kGradientParameters.spec; }

GradientParameters read_gradient(XmlParameters& xml, const QuantitySet& quantities, const Scene& scene) {
  const GradientParameters asked = kGradientParameters.read(xml.list->sublist("Gradient"));
  require_known(asked, xml, quantities, scene);
  return asked;
}

void require_known(const GradientParameters& asked, const XmlParameters& xml, const QuantitySet& quantities,
                   const Scene& scene) {
  const ParameterPath path = {"Gradient"};
  const auto refuse = [&](const std::string& name, const std::string& why) {
    throw xml.source.error(child(path, name), why);
  };
  const std::vector<std::string> names = names_of_values(quantities);
  for (const std::string& text : asked.of)
    if (!means_critical_points(text) && names_meant(text, names).empty())
      refuse("Of", "value \"" + excerpt(text) + "\" is no number that a quantity has; allowed: " +
                       (names.empty() ? "" : quoted_list(names) + ", ") + "\"" + kCriticalLoad + "1\"");
  for (const std::string& text : asked.by)
    if (numbers_meant(xml.list->sublist("Scene"), text).empty())
      refuse("With Respect To", unknown_number(xml.list->sublist("Scene"), text));
  if (const std::size_t count = all_numbers(xml.list->sublist("Scene"), asked).size(); count > kMostNumbers)
    refuse("With Respect To", "it means " + std::to_string(count) + " numbers; allowed: up to " +
                                  std::to_string(kMostNumbers) + ", and \"By Element\" for those of elements");
  if (asked.by.empty() && !asked.by_element)
    throw xml.source.error(path, R"(it asks for nothing; allowed: "With Respect To" or "By Element")");
  if (!scene.imperfection_modes.empty())
    throw xml.source.error(path,
                           "given, but the geometry has modes laid on it; allowed: scenes without such imperfections");
}

bool asks_for_critical_points(const GradientParameters& asked) {
  return std::any_of(asked.of.begin(), asked.of.end(), means_critical_points);
}

RecordedGradients gradients_at(const Simulation& simulation, const GradientParameters& asked, const Differentiable& of,
                               const XmlParameters& xml, const std::string& load_case) {
  RecordedGradients recorded;
  for (const NumberPath& path : all_numbers(xml.list->sublist("Scene"), asked)) recorded.numbers.push_back(path.text());
  GradientRequest request{of.quantities, {}, {}, asked.by_element};
  const std::vector<std::string> all = of.quantities.names();
  for (const std::string& name : all_meant(names_of_values(of.quantities), asked.of, false)) {
    request.columns.push_back(static_cast<std::size_t>(std::find(all.begin(), all.end(), name) - all.begin()));
    if (std::count(asked.of.begin(), asked.of.end(), name) == 0) request.of_patterns.push_back(request.columns.back());
  }
  if (!request.columns.empty()) {
    request.numbers = scene_numbers(simulation, asked, xml, load_case);
    recorded.quantities = simulation.gradients(request);
    for (std::size_t i = 0; i < request.columns.size(); ++i)  // values that gradients() does not compute
      if (double& value = recorded.quantities[i].value; std::isnan(value))
        value = values_of(of.quantities, simulation)[request.columns[i]];
  }
  std::vector<std::string> names;
  for (std::size_t i = 1; i <= of.points.size(); ++i) names.push_back(kCriticalLoad + std::to_string(i));
  for (const std::string& name : all_meant(names, asked.of, true)) {
    const std::size_t i = static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
    double load_factor = std::numeric_limits<double>::quiet_NaN();
    try {
      if (i == names.size())
        throw InputError("it did not come; critical points on the path: " + std::to_string(names.size()));
      load_factor = of.points[i].load_factor;
      const Simulation there = simulation.at(of.points[i].state, load_factor);
      const std::vector<SceneNumber> numbers = scene_numbers(there, asked, xml, load_case);
      const std::string point = "critical point " + std::to_string(i + 1);
      for (RecordedGradient& one : there.gradients(of.points[i], {point, numbers, asked.by_element}))
        recorded.quantities.push_back(std::move(one));
    } catch (const InputError& error) {
      const std::vector<double> none(recorded.numbers.size(), std::numeric_limits<double>::quiet_NaN());
      recorded.quantities.push_back({name, load_factor, none});
      recorded.quantities.back().note = error.what();
    }
  }
  return recorded;
}

RecordedGradients gradients_or_reason(const Simulation& simulation, const GradientParameters& asked,
                                      const Differentiable& of, const XmlParameters& xml,
                                      const std::string& load_case) {
  RecordedGradients none;
  try {
    return gradients_at(simulation, asked, of, xml, load_case);
  } catch (const InputError& error) {
    none.not_found = error.what();
  } catch (const LinearSolverError& error) {
    none.not_found = error.what();
  }
  return none;
}

}  // namespace mixbeam
