#include "nonlinear/parameters/analysis_parameters.hpp"

#include "discretization/parameters/binding.hpp"
#include "discretization/parameters/validate.hpp"
#include "discretization/scene/load_cases.hpp"
#include "discretization/scene/scene.hpp"
#include "discretization/text/message_text.hpp"
#include "discretization/text/number_text.hpp"

#include <algorithm>
#include <cmath>

namespace mixbeam {

namespace {

constexpr int kMostBucklingModes = 100;
const std::vector<std::pair<std::string, int>> kComponents = {{"x", 0}, {"y", 1}, {"z", 2}};

BoundList<MonitoredComponent> control_parameters() {
  BoundList<MonitoredComponent> control(
      "Displacement control: a displacement grows to a target, and the load factor follows from equilibrium; in place "
      "of the load factor's own range, for scenes of one stage.");
  control.bind(&MonitoredComponent::point, text("Point").required(), "Name of the point that is followed.");
  control.bind(&MonitoredComponent::component, text("Component").required(), "Component of its displacement.",
               kComponents);
  control.bind(&MonitoredComponent::target, real("Target").required(),
               "The path ends where the component has this value [length].");
  return control;
}

BoundList<ModesParameters> modes_parameters() {
  constexpr int kMostModes = 1000;
  BoundList<ModesParameters> modes(
      "Natural frequencies and modes about states in equilibrium, lowest first. Needs masses: Density of Material, or "
      "Mass, of sections, Point Masses. The structure may lack supports where nothing acts.");
  modes.bind(&ModesParameters::number, integer("Number").at_least(1).at_most(kMostModes).required(),
             "How many; fewer are found where not as many unknowns carry mass.");
  modes.bind(&ModesParameters::every_step, text("At").by_default(),
             "States about which the structure vibrates: that at the end of the path, or each converged one.",
             {{"end", false}, {"every step", true}});
  modes.bind(&ModesParameters::load_factors, array("Load Factors", ParameterType::real_array).at_least(0.0),
             "Load factors about whose states the structure vibrates, too: the path stops at each, where it first gets "
             "there.");
  modes.bind(&ModesParameters::in_plane, boolean("In Plane").by_default(),
             "Of a scene in a plane: leave out the modes that leave it.");
  return modes;
}

const BoundList<AnalysisParameters> kAnalysisParameters = [] {
  BoundList<AnalysisParameters> analysis("Questions about the path, beyond the state at its end.");
  analysis.bind(&AnalysisParameters::stability, boolean("Stability"),
                "Count the negative eigenvalues of the tangent in every converged state (zero: stable), and find limit "
                "points and bifurcations where the count changes. Default: true up to 100,000 vertices, false beyond, "
                "where it costs more than the rest of a load step.");
  analysis.bind(&AnalysisParameters::trace, boolean("Trace").by_default(),
                "Follow the path closely from the start, by its length. Otherwise load steps are as large as the test "
                "of a step permits.");
  analysis.bind(&AnalysisParameters::branch, text("Branch").by_default(),
                "Path after the first bifurcation: primary: the primary path; positive, negative: the branch along the "
                "buckling mode or against it. The mode counts as positive where it moves \"Branch Point\" along "
                "\"Branch Component\"; where these are not given, in its mean displacement over the structure (the "
                "first component x, y, z that is nearly the largest), or that of the first half of a member.",
                {{"primary", Branch::primary}, {"positive", Branch::positive}, {"negative", Branch::negative}});
  analysis.bind(&AnalysisParameters::snap, text("Snap").by_default(),
                "Where the stable path ends or turns unstable: follow: the path, through unstable states; jump: down "
                "the total potential to a stable state at the next load, for dead forces and prescribed motions. Each "
                "jump is reported, with its load and the energy that it releases.",
                {{"follow", Snap::follow}, {"jump", Snap::jump}});
  analysis.spec.add(text("Branch Point"), "Name of the point whose displacement is positive on the positive branch.");
  analysis.spec.add(choice("Branch Component", {"x", "y", "z"}), "Component of that displacement; default: y.");
  analysis.bind(
      &AnalysisParameters::buckling_modes,
      integer("Buckling Modes").at_least(0).at_most(kMostBucklingModes).by_default(),
      "Linear buckling analysis: this many critical load factors of the undeformed structure, a quick estimate.");
  analysis.bind(&AnalysisParameters::error_estimate, text("Error Estimate").by_default(),
                "Estimate the discretization error of the state at the end of the path, for about two Newton "
                "iterations; auto: in structures of at most 100,000 elements.",
                {{"auto", ErrorEstimation::automatic}, {"on", ErrorEstimation::on}, {"off", ErrorEstimation::off}});
  analysis.bind(&AnalysisParameters::stresses, text("Stresses").by_default(),
                "Compute the largest normal, shear and von Mises stress along members whose section is given by Shape "
                "and Material, and look at strains (Largest Strain); auto: at the end of the path, in structures of at "
                "most 20,000 elements.",
                {{"auto", StressesOf::automatic}, {"every step", StressesOf::every_step}, {"off", StressesOf::none}});
  analysis.bind_list(&AnalysisParameters::modes, "Modes", modes_parameters(), Presence::optional);
  analysis.bind_list(&AnalysisParameters::control, "Control", control_parameters(), Presence::optional);
  const Form with_branch{{}, {"Branch Point", "Branch Component"}};
  analysis.spec.with_forms("Branch", {{"primary", {Form{}}}, {"positive", {with_branch}}, {"negative", {with_branch}}});
  return analysis;
}();

/// Cosine below which two directions are perpendicular, apart from rounding.
constexpr double kNoFreedom = 1e-12;

void require_point(const std::string& name, const Scene& scene, const InputPlace& place) {
  std::vector<std::string> points;
  for (const Point& point : scene.points) points.push_back(point.name);
  if (std::find(points.begin(), points.end(), name) == points.end())
    throw place.error("value \"" + name + "\" is no point of the scene; did you mean \"" + nearest_name(name, points) +
                      "\"?");
}

/// Throws if a support fixes the controlled component.
void require_free(const MonitoredComponent& control, const Scene& scene, const InputPlace& place) {
  for (const Support& support : scene.supports) {
    if (support.point != control.point) continue;
    double freedom = 0.0;
    for (int i = 0; i < 3; ++i)
      if (!support.displacement_fixed[i]) freedom = std::max(freedom, std::abs(support.axes[i][control.component]));
    if (freedom <= kNoFreedom)
      throw place.error("value \"" + std::string(1, "xyz"[control.component]) + "\", but a support fixes it at \"" +
                        control.point + "\"; allowed: a displacement that is free (a point that is moved " +
                        "has a \"Prescribed Displacement\")");
  }
}

/// Throws if nothing acts in some load case: the load factor is the unknown of displacement control.
void require_loads(const Scene& scene, const InputPlace& place) {
  std::vector<std::string> cases = alternatives(scene);
  if (cases.empty()) cases.emplace_back();
  for (const std::string& name : cases) {
    if (!anything_acts(scene_of_case(scene, name)))
      throw place.error("given, but nothing acts" + (name.empty() ? "" : " in \"" + name + "\"") +
                        "; allowed: with loads, whose factor is then found (a force at the point, say), or " +
                        "\"Prescribed Displacement\" of a support in its place");
  }
}

/// Reads the displacement that is positive on the positive branch.
std::optional<MonitoredComponent> read_branch_point(const Teuchos::ParameterList& list, const Scene& scene,
                                                    const InputPlace& place) {
  if (!list.isParameter("Branch Point") && list.isParameter("Branch Component"))
    throw place["Branch Component"].error("given without \"Branch Point\"");
  if (!list.isParameter("Branch Point")) return std::nullopt;
  MonitoredComponent branch{list.get<std::string>("Branch Point"), 1, 0.0};
  for (const auto& [word, component] : kComponents)
    if (list.isParameter("Branch Component") && list.get<std::string>("Branch Component") == word)
      branch.component = component;
  require_point(branch.point, scene, place["Branch Point"]);
  return branch;
}

/// Rejects options that a rotating frame excludes: buckling factors of proportional stresses, and planar modes.
void require_rest(const AnalysisParameters& parameters, const InputPlace& place) {
  if (parameters.buckling_modes > 0)
    throw place["Buckling Modes"].error(
        "given, but in \"Rotating Frame\" loads grow with the square of the load factor; allowed: "
        "without one of them (the path itself meets critical speeds)");
  if (parameters.modes.in_plane)
    throw place["Modes"]["In Plane"].error(
        "value true with \"Rotating Frame\"; allowed: false (its modes are those in space)");
}

constexpr size_t kMostLoadFactors = 1000;
/// Relative difference below which load factors are the same: the path stops at them up to rounding.
constexpr double kSameFactor = 1e-12;

void require_load_factors(const AnalysisParameters& parameters, const Scene& scene, const InputPlace& place) {
  const std::vector<double>& given = parameters.modes.load_factors;
  const std::string range = "0 to " + std::to_string(scene.stages);
  if (!given.empty() && parameters.control)
    throw place.error("given with \"Control\", where the load factor is an unknown; allowed: \"At\" alone");
  if (given.size() > kMostLoadFactors)
    throw place.error("has " + std::to_string(given.size()) + " entries; allowed: up to " +
                      std::to_string(kMostLoadFactors));
  for (const double one : given)
    if (!(one <= scene.stages))
      throw place.error("value " + shortest(one) + " is no load factor of the path; allowed: " + range);
}

}  // namespace

bool asks_for_modes(const ModesParameters& modes, double load_factor, bool end_of_path) {
  if (modes.number == 0 || modes.every_step || end_of_path) return modes.number > 0;
  return std::any_of(modes.load_factors.begin(), modes.load_factors.end(),
                     [&](double asked) { return std::abs(load_factor - asked) <= kSameFactor * asked; });
}

ListSpec analysis_spec() { return kAnalysisParameters.spec; }

AnalysisParameters read_analysis_parameters(Teuchos::ParameterList& list, const Scene& scene,
                                            const ParameterSource& source, const ParameterPath& path) {
  validate(list, kAnalysisParameters.spec, source, path);
  AnalysisParameters parameters = kAnalysisParameters.read(list);
  const InputPlace place(source, path), control = place["Control"];
  if (parameters.control) require_point(parameters.control->point, scene, control["Point"]);
  if (parameters.control && scene.stages > 1)
    throw control.error("given, but the scene has " + std::to_string(scene.stages) + " stages; allowed: one");
  if (parameters.control) require_free(*parameters.control, scene, control["Component"]);
  if (parameters.control) require_loads(scene, control);
  parameters.branch_point = read_branch_point(list, scene, place);
  require_load_factors(parameters, scene, place["Modes"]["Load Factors"]);
  if (!scene.rotating_frames.empty()) require_rest(parameters, place);
  if (parameters.branch != Branch::primary && !parameters.stability.value_or(true))
    throw place["Branch"].error("given, but bifurcations are not looked for with \"Stability\" = false");
  return parameters;
}

}  // namespace mixbeam
