#include "nonlinear/parameters/solver_parameters.hpp"

#include "discretization/parameters/binding.hpp"
#include "discretization/parameters/validate.hpp"
#include "discretization/parameters/value.hpp"
#include "discretization/text/errors.hpp"
#include "discretization/text/number_text.hpp"

#include <NOX_StatusTest_Generic.H>
// needs the header above
#include <NOX_StatusTest_Factory.H>
#include <NOX_Utils.H>

#include <algorithm>
#include <exception>
#include <limits>
#include <sstream>

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
            "adaptive: the run ends when a smaller one would be needed.");
  path.bind(&LoadPathParameters::maximum_step, real("Maximum Step").above(0.0).at_most(1.0).by_default(),
            "automatic, adaptive: largest size.");
  path.bind(&LoadPathParameters::maximum_steps, integer("Maximum Steps").at_least(1).at_most(kMostSteps).by_default(),
            "The run ends after this many steps; fixed: after as many on top of those that \"Steps\" asks for, which "
            "failed ones and shorter ones take.");
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
      &LinearSolverParameters::method, choice("Method", {"automatic", "chains", "iterative", "KLU2"}).by_default(),
      "automatic: chains, and iterative where factors of a network would take too much memory, or more time from a "
      "stable state; chains: elements in a row are condensed to the ends of their chain in parallel; the remaining "
      "system is solved by KLU2 where it has few loops, as L D L^T by MUMPS where it is a network; iterative: the "
      "remaining system is solved by conjugate gradients with coarse spaces, and of stability only its sign at the end "
      "of each stage is determined; KLU2: sparse direct solver of Amesos2 for the whole matrix. Of several ranks all "
      "make the factors of large networks, rank 0 makes those of everything else.");
  linear.bind(&LinearSolverParameters::residual_tolerance,
              real("Residual Tolerance").above(0.0).below(1.0).by_default(),
              "A solve counts as failed if |b - A x| / (|A| |x| + |b|) is larger.");
  linear.spec.had_once("Precision");
  linear.bind(&LinearSolverParameters::force_stiffness_cap,
              real("Force Stiffness Cap").at_least(1e3).at_most(1e14).by_default(),
              "Force stiffness in the tangent (never in the residual) is cut off at this number times the larger of EI "
              "/ L^2 and the forces at work, less where elements are shorter than 1e-4 of L, up to 1000 times as much "
              "in networks; results do not depend on it.");
  return linear;
}

ListSpec backtrack_spec() {
  ListSpec spec("Shorten the step until the residual decreases.");
  spec.add(real("Minimum Step").above(0.0), "Shortest length tried (NOX: 1e-12).");
  spec.add(real("Recovery Step").above(0.0), "Length taken when the search fails (NOX: 1).");
  spec.add(integer("Max Iters").at_least(1), "Lengths tried at most (NOX: 100).");
  spec.add(real("Reduction Factor").above(0.0).below(1.0), "From one length to the next (NOX: 0.5).");
  return spec;
}

ListSpec line_search_spec() {
  ListSpec spec("How much of Newton's step is taken.");
  // "Polynomial", "More'-Thuente" and the like ask for J d of any direction d, and the mixed tangent J is never
  // formed. Lengths other than 1 for every first step have no quadratic convergence and use up all steps.
  spec.add(choice("Method", {kRotationLimited, "Full Step", "Backtrack"}),
           "The program's own is Rotation Limited: the full step, shortened so that no vertex turns by more than "
           "Newton / Maximum Rotation.");
  spec.add_list("Backtrack", backtrack_spec(), Presence::optional);
  return spec;
}

ListSpec direction_spec() {
  ListSpec newton("Newton's direction.");
  newton.add(choice("Forcing Term Method", {"Constant"}), "Linear systems are solved exactly.");
  newton.add(boolean("Rescue Bad Newton Solve"), "Use a direction whose linear solve was inexact (NOX: true).");
  ListSpec spec("Search direction.");
  spec.add(choice("Method", {"Newton"}), "Newton's method.");
  spec.add_list("Newton", newton, Presence::optional);
  return spec;
}

ListSpec printing_spec() {
  ListSpec information("Messages of NOX and LOCA on the terminal.");
  for (const char* const name : {"Error", "Warning", "Outer Iteration", "Inner Iteration", "Parameters", "Details",
                                 "Outer Iteration StatusTest", "Linear Solver Details", "Test Details",
                                 "Stepper Iteration", "Stepper Details", "Stepper Parameters", "Debug"}) {
    information.add(boolean(name), "Print this kind of message.");
  }
  ListSpec spec("Output of NOX and LOCA.");
  spec.add_list("Output Information", information, Presence::optional);
  spec.add(integer("Output Precision").at_least(1).at_most(17), "Digits of numbers (NOX: 3).");
  return spec;
}

ListSpec stepper_spec() {
  ListSpec spec("Continuation in the load factor.");
  spec.add(choice("Continuation Method", {"Natural", "Arc Length"}), "Step in the load factor or along the curve.");
  // "Nested", "Householder" and "LAPACK Direct Solve" need groups of another kind.
  spec.add(choice("Bordered Solver Method", {"Bordering"}),
           "Solution of the system bordered by the arc length equation.");
  spec.add(boolean("Skip Parameter Derivative"), "No separate derivative with respect to the parameter (LOCA: true).");
  spec.add(boolean("Enable Arc Length Scaling"), "Balance parameter and solution in the arc length (LOCA: true).");
  spec.add(real("Goal Arc Length Parameter Contribution").above(0.0).below(1.0), "Share of the parameter (LOCA: 0.5).");
  spec.add(real("Max Arc Length Parameter Contribution").at_least(0.0).at_most(1.0), "Rescale above it (LOCA: 0.8).");
  spec.add(real("Initial Scale Factor").above(0.0), "First weight of the parameter (LOCA: 1).");
  spec.add(real("Min Scale Factor").above(0.0), "Least weight of the parameter (LOCA: 1e-3).");
  spec.add(boolean("Enable Tangent Factor Step Size Scaling"), "Shorter steps where the curve turns (LOCA: false).");
  spec.add(real("Min Tangent Factor").at_least(-1.0).at_most(1.0), "Least cosine between tangents (LOCA: 0.1).");
  spec.add(real("Tangent Factor Exponent").at_least(0.0), "Strength of that scaling (LOCA: 1).");
  return spec;
}

ListSpec predictor_spec() {
  ListSpec spec("Predictor of the next step.");
  spec.add(choice("Method", {"Constant", "Tangent", "Secant"}), "Predictor (LOCA: Secant).");
  ListSpec single("For one step.");
  single.add(choice("Method", {"Constant", "Tangent"}), "Predictor.");
  spec.add_list("First Step Predictor", single, Presence::optional);
  spec.add_list("Last Step Predictor", single, Presence::optional);
  return spec;
}

ListSpec step_size_spec() {
  ListSpec spec("Size of the steps; first, least and largest size follow from Load Path.");
  spec.add(choice("Method", {"Constant", "Adaptive"}), "Step size control.");
  spec.add(real("Failed Step Reduction Factor").above(0.0).below(1.0), "After a failed step (LOCA: 0.5).");
  spec.add(real("Successful Step Increase Factor").at_least(1.0), "Constant: after a step that worked (LOCA: 1.26).");
  return spec;
}

/// Declares the parameters of NOX that a user may set (names: NOX_LineSearch_*.H, NOX_Direction_Newton.H, NOX_Utils.H
/// of Trilinos 13.2). NOX and LOCA silently ignore unknown names, so a misspelt one would have no effect. Their own
/// defaults apply unless this program sets others.
ListSpec nox_spec() {
  ListSpec spec("Parameters handed to NOX, on top of the program's own.");
  spec.add(choice("Nonlinear Solver", {"Line Search Based"}), "The only solver that the element's state supports.");
  spec.add_list("Line Search", line_search_spec(), Presence::optional);
  spec.add_list("Direction", direction_spec(), Presence::optional);
  spec.add_list("Printing", printing_spec(), Presence::optional);
  ListSpec options("General options.");
  options.add(choice("Status Test Check Type", {"Complete", "Minimal"}), "How far tests are evaluated.");
  spec.add_list("Solver Options", options, Presence::optional);
  return spec;
}

/// Declares the parameters of LOCA that a user may set (names: LOCA_Stepper, LOCA_MultiContinuation_ArcLengthGroup.H,
/// LOCA_StepSize_*.H, LOCA_MultiPredictor_Factory.H). The program itself sets the continuation parameter, its range
/// and the limits of steps and iterations, from the scene and from "Load Path" and "Newton".
ListSpec loca_spec() {
  ListSpec spec("Parameters handed to LOCA, on top of the program's own.");
  spec.add_list("Stepper", stepper_spec(), Presence::optional);
  spec.add_list("Predictor", predictor_spec(), Presence::optional);
  spec.add_list("Step Size", step_size_spec(), Presence::optional);
  return spec;
}

const BoundList<SolverParameters> kSolverParameters = [] {
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
}();

/// Checks the three sizes; clamps the initial step to the bounds if it is not given.
void check_steps(LoadPathParameters& parameters, const ParameterList& list, const InputPlace& place) {
  if (parameters.minimum_step > parameters.maximum_step)
    throw place["Minimum Step"].error("value " + shortest(parameters.minimum_step) +
                                      "; allowed: at most \"Maximum Step\" = " + shortest(parameters.maximum_step));
  const double nearest = std::clamp(parameters.initial_step, parameters.minimum_step, parameters.maximum_step);
  if (is_given(list, "Initial Step") && parameters.initial_step != nearest)
    throw place["Initial Step"].error("value " + shortest(parameters.initial_step) +
                                      "; allowed: from \"Minimum Step\" = " + shortest(parameters.minimum_step) +
                                      " to \"Maximum Step\" = " + shortest(parameters.maximum_step));
  parameters.initial_step = nearest;
}

/// An independent copy of a sublist; null if the user gave none.
RCP<ParameterList> given_list(const ParameterList& list, const std::string& name) {
  if (!list.isSublist(name)) return Teuchos::null;
  return Teuchos::rcp(new ParameterList(list.sublist(name)));
}

bool begins_with(const std::string& line, const std::string& beginning) { return line.rfind(beginning, 0) == 0; }

/// Recognises lines that Teuchos adds to a message: the place in its own source, and how often it has thrown.
bool is_decoration(const std::string& line) {
  return begins_with(line, "Throw number") || begins_with(line, "Throw test that evaluated") ||
         (line.find(".C:") != std::string::npos && line.back() == ':') ||
         (line.find(".hpp:") != std::string::npos && line.back() == ':');
}

std::string one_line(const std::string& message) {
  std::istringstream lines(message);
  std::string result;
  for (std::string line; std::getline(lines, line);) {
    const std::size_t begin = line.find_first_not_of(" \t");
    if (begin == std::string::npos || is_decoration(line)) continue;
    result += (result.empty() ? "" : " ") + line.substr(begin);
  }
  return result;
}

/// Returns NOX's complaint about the list "Status Tests", in one line; empty if it can build the tests. NOX checks
/// names, types and test types itself, but only when it builds the tests, and its messages are not meant for users.
std::string problem_of_status_tests(const ParameterList& tests) {
  ParameterList tried(tests);  // NOX fills in defaults
  const NOX::Utils silent;
  try {
    NOX::StatusTest::buildStatusTests(tried, silent);
  } catch (const std::exception& error) {
    if (is_out_of_memory(error)) throw;
    return one_line(error.what());
  } catch (const char* error) {  // NOX throws C strings too
    return error;
  }
  return "";
}

}  // namespace

ListSpec solver_spec() { return kSolverParameters.spec; }

SolverParameters read_solver_parameters(ParameterList& list, const ParameterSource& source, const ParameterPath& path) {
  validate(list, kSolverParameters.spec, source, path);
  const InputPlace place(source, path);
  SolverParameters parameters = kSolverParameters.read(list);
  check_steps(parameters.load_path, list.sublist("Load Path"), place["Load Path"]);
  parameters.nox = given_list(list, "NOX");
  parameters.status_tests = given_list(list, "Status Tests");
  const std::string refusal =
      parameters.status_tests.is_null() ? "" : problem_of_status_tests(*parameters.status_tests);
  if (!refusal.empty()) throw place["Status Tests"].error("NOX refuses this list: " + refusal);
  parameters.loca = given_list(list, "LOCA");
  // The list "LOCA" has an effect only with LOCA's stepper.
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
