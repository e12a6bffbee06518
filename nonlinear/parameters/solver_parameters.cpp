#include "nonlinear/parameters/solver_parameters.hpp"

#include "discretization/parameters/validate.hpp"
#include "discretization/text/number_text.hpp"
#include "nonlinear/parameters/nox_spec.hpp"
#include "nonlinear/parameters/status_test_check.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <vector>

namespace mixbeam {
namespace {

using Teuchos::ParameterList;
using Teuchos::RCP;

constexpr int kMostSteps = 1'000'000;
constexpr int kIterationLimit = 10'000;
constexpr int kMostThreads = 1024;

const SolverParameters kSolverDefaults;
const std::map<std::string, LoadPathMethod> kMethods = {
    {"automatic", LoadPathMethod::automatic}, {"adaptive", LoadPathMethod::adaptive}, {"fixed", LoadPathMethod::fixed}};

ListSpec load_path_spec() {
  const LoadPathParameters& defaults = kSolverDefaults.load_path;
  ListSpec spec("Steps of the load factor, which runs from 0 to the number of stages; sizes are fractions of a stage.");
  spec.add(choice("Method", {"automatic", "adaptive", "fixed"})
               .by_default("automatic")
               .means("automatic: load steps as large as possible, and where one fails or the stability changes, along "
                      "the path by its length, through limit points; adaptive: steps of the load factor alone, larger "
                      "after easy steps, smaller after failed ones; fixed: equal steps."));
  spec.add(
      integer("Steps").at_least(1).at_most(kMostSteps).by_default(defaults.steps).means("fixed: steps per stage."));
  spec.add(real("Initial Step")
               .above(0.0)
               .at_most(1.0)
               .by_default(defaults.initial_step)
               .means("automatic, adaptive: first size tried."));
  spec.add(real("Minimum Step")
               .above(0.0)
               .at_most(1.0)
               .by_default(defaults.minimum_step)
               .means("adaptive: the run is given up when a smaller one would be needed."));
  spec.add(real("Maximum Step")
               .above(0.0)
               .at_most(1.0)
               .by_default(defaults.maximum_step)
               .means("automatic, adaptive: largest size."));
  spec.add(integer("Maximum Steps")
               .at_least(1)
               .at_most(kMostSteps)
               .by_default(defaults.maximum_steps)
               .means("The run is given up after this many steps; fixed: after as many on top of those that \"Steps\" "
                      "asks for, which failed ones and shorter ones take."));
  spec.add(
      real("Aggressiveness")
          .at_least(0.0)
          .at_most(1.0)
          .by_default(defaults.aggressiveness)
          .means(
              "adaptive: how fast steps grow; a step that takes no iteration lengthens the next one by this share."));
  return spec;
}

ListSpec newton_spec() {
  const NewtonParameters& defaults = kSolverDefaults.newton;
  ListSpec spec("Newton's method in each step.");
  spec.add(real("Residual Tolerance")
               .above(0.0)
               .below(1.0)
               .by_default(defaults.residual_tolerance)
               .means("Converged when the scaled residual (without dimension) is smaller."));
  spec.add(integer("Maximum Iterations")
               .at_least(1)
               .at_most(kIterationLimit)
               .by_default(defaults.maximum_iterations)
               .means("The step has failed after this many iterations."));
  spec.add(
      real("Maximum Rotation")
          .above(0.0)
          .at_most(3.0)
          .by_default(defaults.maximum_rotation)
          .means("Largest rotation of a vertex in one iteration [radian]; longer Newton steps are shortened to it."));
  spec.had_once("Tangent Reuse");
  return spec;
}

ListSpec linear_solver_spec() {
  const LinearSolverParameters& defaults = kSolverDefaults.linear;
  ListSpec spec("Solution of the linear systems.");
  spec.add(choice("Method", {"chains", "KLU2"})
               .by_default(defaults.method)
               .means("chains: elements in a row are condensed to the ends of their chain in parallel, and KLU2 solves "
                      "what is left; KLU2: sparse direct solver of Amesos2 for the whole matrix. KLU2 works on rank 0 "
                      "whatever the number of ranks."));
  spec.add(real("Residual Tolerance")
               .above(0.0)
               .below(1.0)
               .by_default(defaults.residual_tolerance)
               .means("A solve counts as failed if |b - A x| / (|A| |x| + |b|) is larger."));
  spec.had_once("Precision");
  spec.add(
      real("Force Stiffness Cap")
          .at_least(1e3)
          .at_most(1e14)
          .by_default(defaults.force_stiffness_cap)
          .means("Force stiffness in the tangent (never in the residual) is cut off at this number times the larger of "
                 "EI / L^2 and the forces at work, less where elements are shorter than 1e-4 of L; results do not "
                 "depend on it."));
  return spec;
}

bool is_given(const ParameterList& list, const std::string& name) { return !list.getEntry(name).isDefault(); }

/// A parameter of the other method would silently have no effect.
void refuse_meaningless(const ParameterList& list, const ParameterSource& source, const ParameterPath& path) {
  const auto& method = list.get<std::string>("Method");
  const std::vector<std::string> of_fixed = {"Steps"};
  const std::vector<std::string> of_adaptive = {"Initial Step", "Minimum Step", "Maximum Step", "Aggressiveness"};
  const std::string other = method == "fixed" ? "automatic" : "fixed";
  for (const std::string& name : method == "fixed" ? of_adaptive : of_fixed) {
    if (!is_given(list, name)) continue;
    throw source.error(child(path, name), R"(given, but has no meaning for "Method" = ")" + method +
                                              R"("; allowed: with ")" + other + "\"");
  }
}

LoadPathParameters read_load_path(const ParameterList& list, const ParameterSource& source, const ParameterPath& path) {
  refuse_meaningless(list, source, path);
  LoadPathParameters parameters;
  parameters.method = kMethods.at(list.get<std::string>("Method"));
  parameters.steps = list.get<int>("Steps");
  parameters.minimum_step = list.get<double>("Minimum Step");
  parameters.maximum_step = list.get<double>("Maximum Step");
  parameters.initial_step = list.get<double>("Initial Step");
  parameters.maximum_steps = list.get<int>("Maximum Steps");
  parameters.aggressiveness = list.get<double>("Aggressiveness");
  if (parameters.minimum_step > parameters.maximum_step) {
    throw source.error(child(path, "Minimum Step"),
                       "value " + shortest(parameters.minimum_step) +
                           "; allowed: at most \"Maximum Step\" = " + shortest(parameters.maximum_step));
  }
  const double nearest = std::clamp(parameters.initial_step, parameters.minimum_step, parameters.maximum_step);
  if (is_given(list, "Initial Step") && parameters.initial_step != nearest) {
    throw source.error(child(path, "Initial Step"),
                       "value " + shortest(parameters.initial_step) +
                           "; allowed: from \"Minimum Step\" = " + shortest(parameters.minimum_step) +
                           " to \"Maximum Step\" = " + shortest(parameters.maximum_step));
  }
  parameters.initial_step = nearest;  // the default follows the bounds
  return parameters;
}

NewtonParameters read_newton(const ParameterList& list) {
  NewtonParameters parameters;
  parameters.residual_tolerance = list.get<double>("Residual Tolerance");
  parameters.maximum_iterations = list.get<int>("Maximum Iterations");
  parameters.maximum_rotation = list.get<double>("Maximum Rotation");
  return parameters;
}

LinearSolverParameters read_linear_solver(const ParameterList& list) {
  LinearSolverParameters parameters;
  parameters.method = list.get<std::string>("Method");
  parameters.residual_tolerance = list.get<double>("Residual Tolerance");
  parameters.force_stiffness_cap = list.get<double>("Force Stiffness Cap");
  return parameters;
}

/// A copy that does not depend on the list it was found in; null if the user gave none.
RCP<ParameterList> given_list(const ParameterList& list, const std::string& name) {
  if (!list.isSublist(name)) return Teuchos::null;
  return Teuchos::rcp(new ParameterList(list.sublist(name)));
}

RCP<ParameterList> given_status_tests(const ParameterList& list, const ParameterSource& source,
                                      const ParameterPath& path) {
  RCP<ParameterList> tests = given_list(list, "Status Tests");
  const std::string problem = tests.is_null() ? "" : problem_of_status_tests(*tests);
  if (!problem.empty()) throw source.error(child(path, "Status Tests"), "NOX refuses this list: " + problem);
  return tests;
}

}  // namespace

ListSpec solver_spec() {
  ListSpec spec("How the equations are solved.");
  spec.add_list("Load Path", load_path_spec());
  spec.add_list("Newton", newton_spec());
  spec.add_list("Linear Solver", linear_solver_spec());
  spec.add(integer("Threads")
               .at_least(0)
               .at_most(kMostThreads)
               .by_default(kSolverDefaults.threads)
               .means("OpenMP threads; 0: as the environment variable OMP_NUM_THREADS says."));
  spec.add(
      boolean("Planar")
          .by_default(kSolverDefaults.planar)
          .means(
              "Scenes in a plane are recognised and solved with three unknowns per vertex, about three times as fast; "
              "their last digits are not those of the solution in space."));
  spec.had_once("Symmetric Tangent");
  spec.add_list("NOX", nox_spec(), Presence::optional);
  spec.add_list(
      "Status Tests",
      ListSpec("Convergence tests in place of the program's own, in the form of NOX (NOX_StatusTest_Factory.H), "
               "which checks this list itself.")
          .without_checks(),
      Presence::optional);
  spec.add_list("LOCA", loca_spec(), Presence::optional);
  return spec;
}

SolverParameters read_solver_parameters(ParameterList& list, const ParameterSource& source, const ParameterPath& path) {
  validate(list, solver_spec(), source, path);
  SolverParameters parameters;
  parameters.load_path = read_load_path(list.sublist("Load Path"), source, child(path, "Load Path"));
  parameters.newton = read_newton(list.sublist("Newton"));
  parameters.linear = read_linear_solver(list.sublist("Linear Solver"));
  parameters.threads = list.get<int>("Threads");
  parameters.planar = list.get<bool>("Planar");
  parameters.nox = given_list(list, "NOX");
  parameters.status_tests = given_status_tests(list, source, path);
  parameters.loca = given_list(list, "LOCA");
  // LOCA's own parameters are for LOCA's stepper
  if (!parameters.loca.is_null() && parameters.load_path.method == LoadPathMethod::automatic)
    parameters.load_path.method = LoadPathMethod::adaptive;
  return parameters;
}

int LoadPathParameters::most_steps(int stages) const {
  if (method != LoadPathMethod::fixed) return maximum_steps;
  const long long asked = static_cast<long long>(steps) * stages;
  return static_cast<int>(std::min<long long>(asked + maximum_steps, std::numeric_limits<int>::max()));
}

}  // namespace mixbeam
