#include "nonlinear/parameters/nox_spec.hpp"

#include "nonlinear/parameters/solver_parameters.hpp"

namespace mixbeam {
namespace {

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
  ListSpec information("What NOX and LOCA write to the terminal.");
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
  spec.add(choice("Bordered Solver Method", {"Bordering"}), "How the arc length equation is solved along.");
  spec.add(boolean("Skip Parameter Derivative"), "No separate derivative by the parameter (LOCA: true).");
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
  ListSpec spec("First guess of the next step.");
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

}  // namespace

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

ListSpec loca_spec() {
  ListSpec spec("Parameters handed to LOCA, on top of the program's own.");
  spec.add_list("Stepper", stepper_spec(), Presence::optional);
  spec.add_list("Predictor", predictor_spec(), Presence::optional);
  spec.add_list("Step Size", step_size_spec(), Presence::optional);
  return spec;
}

}  // namespace mixbeam
