#include "nonlinear/parameters/analysis_parameters.hpp"

#include "discretization/parameters/validate.hpp"
#include "discretization/scene/names.hpp"
#include "discretization/scene/scene.hpp"
#include "discretization/text/nearest_name.hpp"

#include <algorithm>
#include <map>
#include <vector>

namespace mixbeam {

namespace {

const AnalysisParameters kDefaults;
constexpr int kMostBucklingModes = 100;
const std::map<std::string, Branch> kBranches = {
    {"primary", Branch::primary}, {"positive", Branch::positive}, {"negative", Branch::negative}};
const std::map<std::string, ErrorEstimation> kErrorEstimation = {
    {"auto", ErrorEstimation::automatic}, {"on", ErrorEstimation::on}, {"off", ErrorEstimation::off}};
const std::vector<std::string> kComponents = {"x", "y", "z"};

ListSpec control_spec() {
  ListSpec spec(
      "A displacement that grows to a target while the load factor is whatever equilibrium needs; in place of the load "
      "factor's own range, for scenes of one stage.");
  spec.add(text("Point").required().means("Name of the point that is followed."));
  spec.add(choice("Component", kComponents).required().means("Component of its displacement."));
  spec.add(real("Target").required().means("The path ends where the component has this value [length]."));
  return spec;
}

int component_of(const std::string& name) {
  return static_cast<int>(std::find(kComponents.begin(), kComponents.end(), name) - kComponents.begin());
}

void require_point(const std::string& name, const Scene& scene, const ParameterSource& source,
                   const ParameterPath& path) {
  std::vector<std::string> points;
  for (const Point& point : scene.points) points.push_back(point.name);
  if (std::find(points.begin(), points.end(), name) == points.end())
    throw source.error(
        path, "value \"" + name + "\" is no point of the scene; did you mean \"" + nearest_name(name, points) + "\"?");
}

MonitoredComponent read_control(const Teuchos::ParameterList& list, const Scene& scene, const ParameterSource& source,
                                const ParameterPath& path) {
  MonitoredComponent control;
  control.point = list.get<std::string>("Point");
  control.target = list.get<double>("Target");
  control.component = component_of(list.get<std::string>("Component"));
  require_point(control.point, scene, source, child(path, "Point"));
  if (scene.stages > 1)
    throw source.error(path, "given, but the scene has " + std::to_string(scene.stages) + " stages; allowed: one");
  return control;
}

}  // namespace

ListSpec analysis_spec() {
  ListSpec spec("What is asked about the path, beyond the state at its end.");
  spec.add(boolean("Stability")
               .means("Count the negative eigenvalues of the tangent in every converged state (zero: stable), and find "
                      "limit points and bifurcations where the count changes. Default: true up to 100,000 vertices, "
                      "false beyond, where it costs more than the rest of a load step."));
  spec.add(boolean("Trace")
               .by_default(kDefaults.trace)
               .means("Follow the path closely from the start, by its length. Without, load steps are as large as the "
                      "test of a step lets them be."));
  spec.add(
      choice("Branch", {"primary", "positive", "negative"})
          .by_default("primary")
          .means("Path after the first bifurcation: primary: straight on; positive, negative: the branch along the "
                 "buckling mode or against it. The mode counts as positive where it moves \"Branch Point\" along "
                 "\"Branch Component\"; where these are not given, in its mean displacement over the structure (the "
                 "first component x, y, z that is nearly the largest), or that of the first half of a member."));
  spec.add(text("Branch Point").means("Name of the point whose displacement is positive on the positive branch."));
  spec.add(choice("Branch Component", kComponents).means("Component of that displacement; default: y."));
  spec.add(integer("Buckling Modes")
               .at_least(0)
               .at_most(kMostBucklingModes)
               .by_default(kDefaults.buckling_modes)
               .means("Linear buckling analysis: this many critical load factors of the undeformed structure, a quick "
                      "estimate."));
  spec.add(choice("Error Estimate", {"auto", "on", "off"})
               .by_default("auto")
               .means("Estimate the discretization error of the state at the end of the path, for about two Newton "
                      "iterations; auto: in structures of at most 100,000 elements."));
  spec.add_list("Control", control_spec(), Presence::optional);
  return spec;
}

AnalysisParameters read_analysis_parameters(Teuchos::ParameterList& list, const Scene& scene,
                                            const ParameterSource& source, const ParameterPath& path) {
  validate(list, analysis_spec(), source, path);
  AnalysisParameters parameters;
  if (list.isParameter("Stability")) parameters.stability = list.get<bool>("Stability");
  parameters.trace = list.get<bool>("Trace");
  parameters.branch = kBranches.at(list.get<std::string>("Branch"));
  parameters.buckling_modes = list.get<int>("Buckling Modes");
  parameters.error_estimate = kErrorEstimation.at(list.get<std::string>("Error Estimate"));
  if (list.isSublist("Control"))
    parameters.control = read_control(list.sublist("Control"), scene, source, child(path, "Control"));
  for (const std::string name : {"Branch Point", "Branch Component"}) {
    if (!list.isParameter(name)) continue;
    if (parameters.branch == Branch::primary)
      throw source.error(child(path, name), "given, but has no meaning for \"Branch\" = \"primary\"");
    if (!list.isParameter("Branch Point")) throw source.error(child(path, name), "given without \"Branch Point\"");
  }
  if (list.isParameter("Branch Point")) {
    parameters.branch_point = MonitoredComponent{list.get<std::string>("Branch Point"), 1, 0.0};
    if (list.isParameter("Branch Component"))
      parameters.branch_point->component = component_of(list.get<std::string>("Branch Component"));
    require_point(parameters.branch_point->point, scene, source, child(path, "Branch Point"));
  }
  if (parameters.branch != Branch::primary && !parameters.stability.value_or(true))
    throw source.error(child(path, "Branch"), "given, but bifurcations are not looked for with \"Stability\" = false");
  return parameters;
}

}  // namespace mixbeam
