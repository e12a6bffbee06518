#include "nonlinear/parameters/solver_parameters.hpp"

#include "discretization/parameters/access.hpp"
#include "discretization/parameters/binding.hpp"
#include "discretization/parameters/validate.hpp"
#include "discretization/text/number_text.hpp"
#include "nonlinear/parameters/nox_spec.hpp"
#include "nonlinear/parameters/status_test_check.hpp"

#include <algorithm>
#include <limits>

namespace mixbeam {
namespace {

using Teuchos::ParameterList;
using Teuchos::RCP;

constexpr int kMostSteps = 1'000'000;
constexpr int kIterationLimit = 10'000;
constexpr int kMostThreads = 1024;

BoundList<LoadPathParameters> load_path_parameters() {
  BoundList<LoadPathParameters> path(
      "Steps of the load factor, which runs from 0 to the number of stages; sizes are fractions of a stage.");
  path.bind(&LoadPathParameters::method, text("Method").by_default(),
            "automatic: load steps as large as possible, and where one fails or the stability changes, along the path "
            "by its length, through limit points; adaptive: steps of the load factor alone, larger after easy steps, "
            "smaller after failed ones; fixed: equal steps.",
            {{"automatic", LoadPathMethod::automatic},
             {"adaptive", LoadPathMethod::adaptive},
             {"fixed", LoadPathMethod::fixed}});
  path.bind(&LoadPathParameters::steps, integer("Steps").at_least(1).at_most(kMostSteps).by_default(),
            "fixed: steps per stage.");
  path.bind(&LoadPathParameters::initial_step, real("Initial Step").above(0.0).at_most(1.0).by_default(),
            "automatic, adaptive: first size tried.");
  path.bind(&LoadPathParameters::minimum_step, real("Minimum Step").above(0.0).at_most(1.0).by_default(),
            "adaptive: the run is given up when a smaller one would be needed.");
  path.bind(&LoadPathParameters::maximum_step, real("Maximum Step").above(0.0).at_most(1.0).by_default(),
            "automatic, adaptive: largest size.");
  path.bind(&LoadPathParameters::maximum_steps, integer("Maximum Steps").at_least(1).at_most(kMostSteps).by_default(),
            "The run is given up after this many steps; fixed: after as many on top of those that \"Steps\" asks for, "
            "which failed ones and shorter ones take.");
  path.bind(&LoadPathParameters::aggressiveness, real("Aggressiveness").at_least(0.0).at_most(1.0).by_default(),
            "adaptive: how fast steps grow; a step that takes no iteration lengthens the next one by this share.");
  const Form with_size{{}, {"Initial Step", "Minimum Step", "Maximum Step", "Aggressiveness"}};
  path.spec.with_forms("Method",
                       {{"automatic", {with_size}}, {"adaptive", {with_size}}, {"fixed", {Form{{}, {"Steps"}}}}});
  return path;
}

BoundList<NewtonParameters> newton_parameters() {
  BoundList<NewtonParameters> newton("Newton's method in each step.");
  newton.bind(&NewtonParameters::residual_tolerance, real("Residual Tolerance").above(0.0).below(1.0).by_default(),
              "Converged when the scaled residual (without dimension) is smaller.");
  newton.bind(&NewtonParameters::maximum_iterations,
              integer("Maximum Iterations").at_least(1).at_most(kIterationLimit).by_default(),
              "The step has failed after this many iterations.");
  newton.bind(&NewtonParameters::maximum_rotation, real("Maximum Rotation").above(0.0).at_most(3.0).by_default(),
              "Largest rotation of a vertex in one iteration [radian]; longer Newton steps are shortened to it.");
  newton.spec.had_once("Tangent Reuse");
  return newton;
}

BoundList<LinearSolverParameters> linear_parameters() {
  BoundList<LinearSolverParameters> linear("Solution of the linear systems.");
  linear.bind(
      &LinearSolverParameters::method, choice("Method", {"chains", "KLU2"}).by_default(),
      "chains: elements in a row are condensed to the ends of their chain in parallel, and KLU2 solves what is left; "
      "KLU2: sparse direct solver of Amesos2 for the whole matrix. KLU2 works on rank 0 whatever the number of ranks.");
  linear.bind(&LinearSolverParameters::residual_tolerance,
              real("Residual Tolerance").above(0.0).below(1.0).by_default(),
              "A solve counts as failed if |b - A x| / (|A| |x| + |b|) is larger.");
  linear.spec.had_once("Precision");
  linear.bind(
      &LinearSolverParameters::force_stiffness_cap,
      real("Force Stiffness Cap").at_least(1e3).at_most(1e14).by_default(),
      "Force stiffness in the tangent (never in the residual) is cut off at this number times the larger of EI / L^2 "
      "and the forces at work, less where elements are shorter than 1e-4 of L; results do not depend on it.");
  return linear;
}

BoundList<SolverParameters> solver_parameters() {
  BoundList<SolverParameters> solver("How the equations are solved.");
  solver.bind_list(&SolverParameters::load_path, "Load Path", load_path_parameters());
  solver.bind_list(&SolverParameters::newton, "Newton", newton_parameters());
  solver.bind_list(&SolverParameters::linear, "Linear Solver", linear_parameters());
  solver.bind(&SolverParameters::threads, integer("Threads").at_least(0).at_most(kMostThreads).by_default(),
              "OpenMP threads; 0: as the environment variable OMP_NUM_THREADS says.");
  solver.bind(&SolverParameters::planar, boolean("Planar").by_default(),
              "Scenes in a plane are recognised and solved with three unknowns per vertex, about three times as fast; "
              "their last digits are not those of the solution in space.");
  solver.spec.had_once("Symmetric Tangent");
  solver.spec.add_list("NOX", nox_spec(), Presence::optional);
  solver.spec.add_list("Status Tests",
                       ListSpec("Convergence tests in place of the program's own, in the form of NOX "
                                "(NOX_StatusTest_Factory.H), which checks this list itself.")
                           .without_checks(),
                       Presence::optional);
  solver.spec.add_list("LOCA", loca_spec(), Presence::optional);
  return solver;
}

/// Of the three sizes; the default of the first follows the bounds.
void check_steps(LoadPathParameters& parameters, const ParameterList& list, const ParameterSource& source,
                 const ParameterPath& path) {
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
  parameters.initial_step = nearest;
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

const BoundList<SolverParameters> kSolverParameters = solver_parameters();

}  // namespace

ListSpec solver_spec() { return kSolverParameters.spec; }

SolverParameters read_solver_parameters(ParameterList& list, const ParameterSource& source, const ParameterPath& path) {
  validate(list, kSolverParameters.spec, source, path);
  SolverParameters parameters = kSolverParameters.read(list);
  check_steps(parameters.load_path, list.sublist("Load Path"), source, child(path, "Load Path"));
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
