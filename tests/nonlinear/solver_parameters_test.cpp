#include "nonlinear/parameters/solver_parameters.hpp"

#include "discretization/parameters/parameter_file.hpp"
#include "discretization/parameters/print.hpp"
#include "discretization/parameters/validate.hpp"
#include "tests/discretization/input_text.hpp"

#include <sstream>

namespace mixbeam {
namespace {

XmlParameters given(const std::string& inside) {
  ListSpec root("file");
  root.add_list("Solver", solver_spec(), Presence::required);
  return parse_yaml("Solver: {" + inside + "}", "scene.yaml", root);
}

SolverParameters solver_from(const std::string& inside) {
  const XmlParameters file = given(inside);
  return read_solver_parameters(file.list->sublist("Solver"), file.source);
}

std::string refusal(const std::string& inside) {
  return message_of([&] { solver_from(inside); });
}

TEST(SolverParameters, AnEmptyListMeansTheDefaults) {
  const SolverParameters read = solver_from("");
  const SolverParameters defaults;
  EXPECT_EQ(read.load_path.method, defaults.load_path.method);
  EXPECT_EQ(read.load_path.steps, defaults.load_path.steps);
  EXPECT_EQ(read.load_path.initial_step, defaults.load_path.initial_step);
  EXPECT_EQ(read.load_path.minimum_step, defaults.load_path.minimum_step);
  EXPECT_EQ(read.load_path.maximum_step, defaults.load_path.maximum_step);
  EXPECT_EQ(read.load_path.maximum_steps, defaults.load_path.maximum_steps);
  EXPECT_EQ(read.load_path.aggressiveness, defaults.load_path.aggressiveness);
  EXPECT_EQ(read.newton.residual_tolerance, defaults.newton.residual_tolerance);
  EXPECT_EQ(read.newton.maximum_iterations, defaults.newton.maximum_iterations);
  EXPECT_EQ(read.newton.maximum_rotation, defaults.newton.maximum_rotation);
  EXPECT_EQ(read.linear.method, defaults.linear.method);
  EXPECT_EQ(read.linear.residual_tolerance, defaults.linear.residual_tolerance);
  EXPECT_EQ(read.linear.force_stiffness_cap, defaults.linear.force_stiffness_cap);
  EXPECT_EQ(read.threads, defaults.threads);
  EXPECT_TRUE(read.nox.is_null());
  EXPECT_TRUE(read.status_tests.is_null());
  EXPECT_TRUE(read.loca.is_null());
}

TEST(SolverParameters, ThatWereRemovedHaveNoEffect) {
  const auto warnings_of = [](const std::string& inside) {
    const XmlParameters file = given(inside);
    return validate(file.list->sublist("Solver"), solver_spec(), file.source, {"Solver"});
  };
  const std::vector<std::string> warnings =
      warnings_of("Newton: {Tangent Reuse: 3}, Linear Solver: {Precision: single}, Symmetric Tangent: true");
  ASSERT_EQ(warnings.size(), 3);
  expect_in(warnings[0], {"scene.yaml:1:74: YAML path \"Solver / Symmetric Tangent\": ", "was removed"});
  expect_in(warnings[1], {"scene.yaml:1:19: YAML path \"Solver / Newton / Tangent Reuse\": ", "was removed"});
  expect_in(warnings[2], {"scene.yaml:1:54: YAML path \"Solver / Linear Solver / Precision\": ", "was removed"});
  EXPECT_TRUE(warnings_of("Newton: {Maximum Rotation: 0.3}").empty());
  expect_in(refusal("Newton: {Tangent Reus: 3}"), {"Tangent Reus", "unknown name"});
}

TEST(SolverParameters, AreRead) {
  const SolverParameters read = solver_from(
      "Load Path: {Method: fixed, Steps: 7}, Newton: {Residual Tolerance: 1e-8, Maximum Rotation: 0.25}, Linear "
      "Solver: {Method: KLU2}, Threads: 2");
  EXPECT_EQ(read.load_path.method, LoadPathMethod::fixed);
  EXPECT_EQ(read.load_path.steps, 7);
  EXPECT_EQ(read.newton.residual_tolerance, 1e-8);
  EXPECT_EQ(read.newton.maximum_rotation, 0.25);
  EXPECT_EQ(read.linear.method, "KLU2");
  EXPECT_EQ(read.threads, 2);
}

TEST(SolverParameters, StepSizesMustFitTogether) {
  const auto path = [](const std::string& inside) { return "Load Path: {" + inside + "}, "; };
  EXPECT_EQ(solver_from(path("Maximum Step: 0.1")).load_path.initial_step, 0.1);
  expect_in(refusal(path("Maximum Step: 0.1, Initial Step: 0.5")),
            {"scene.yaml:1:41: ", "\"Solver / Load Path / Initial Step\"", "value 0.5", "\"Maximum Step\" = 0.1"});
  expect_in(refusal(path("Maximum Step: 0.1, Minimum Step: 0.2")), {"Minimum Step", "value 0.2"});
  expect_in(refusal(path("Steps: 3")), {"Steps", "no meaning for \"Method\" = \"automatic\""});
  expect_in(refusal(path("Method: fixed, Aggressiveness: 1")),
            {"Aggressiveness", "no meaning for \"Method\" = \"fixed\""});
}

TEST(SolverParameters, AreRefusedWithAPlaceAndTheNearestName) {
  expect_in(
      refusal("Newton: {Maximum Iteration: 3}"),
      {"scene.yaml:1:19: YAML path \"Solver / Newton / Maximum Iteration\"", "did you mean \"Maximum Iterations\"?"});
  expect_in(refusal("Newtn: {}"), {"did you mean \"Newton\"?"});
  expect_in(refusal("Linear Solver: {Method: KLU}"), {"\"KLU\"", "did you mean \"KLU2\"?"});
  expect_in(refusal("Linear Solver: {Force Stiffness Cap: 1e20}"), {"value 1e+20", "<= 1e+14"});
  expect_in(refusal("Threads: -1"), {"value -1"});
}

TEST(SolverParameters, HandOverWhatWasGivenToNoxAndLoca) {
  const SolverParameters read = solver_from(
      "NOX: {Line Search: {Method: Backtrack, Backtrack: {Max Iters: 4}}, Printing: {Output Information: {Outer "
      "Iteration: true}}}, LOCA: {Stepper: {Continuation Method: Natural}}, Status Tests: {Test Type: Combo, Combo "
      "Type: OR, Number of Tests: 1, Test 0: {Test Type: NormF}}");
  ASSERT_FALSE(read.nox.is_null());
  EXPECT_EQ(read.nox->sublist("Line Search").sublist("Backtrack").get<int>("Max Iters"), 4);
  EXPECT_TRUE(read.nox->sublist("Printing").sublist("Output Information").get<bool>("Outer Iteration"));
  EXPECT_FALSE(read.nox->isSublist("Direction"));  // nothing that was not given
  EXPECT_EQ(read.nox->sublist("Line Search").numParams(), 2);
  ASSERT_FALSE(read.loca.is_null());
  EXPECT_EQ(read.loca->sublist("Stepper").get<std::string>("Continuation Method"), "Natural");
  ASSERT_FALSE(read.status_tests.is_null());
  EXPECT_TRUE(read.status_tests->isSublist("Test 0"));
}

TEST(SolverParameters, CatchMisspeltNamesOfNoxAndLoca) {
  const auto step_size = [](const std::string& inside) { return "LOCA: {Step Size: {" + inside + "}}, "; };
  expect_in(refusal(step_size("Failed Step Reduction Facter: 0.5")),
            {"\"Solver / LOCA / Step Size / ", "did you mean \"Failed Step Reduction Factor\"?"});
  expect_in(refusal("NOX: {Line Search: {Method: Full-Step}}"),
            {"\"Rotation Limited\"", "did you mean \"Full Step\"?"});
  expect_in(refusal("NOX: {Direction: {Newton: {Forcing Term Methd: Constant}}}"),
            {"did you mean \"Forcing Term Method\"?"});
  expect_in(refusal("LOCA: {Stepper: {Bordered Solver Method: Nested}}"), {"\"Nested\"", "\"Bordering\""});
}

TEST(SolverParameters, RefuseStatusTestsThatNoxRefuses) {
  const auto tests = [](const std::string& inside) { return "Status Tests: {" + inside + "}, "; };
  expect_in(refusal(tests("Test Type: NormG")),
            {"scene.yaml:1:10: YAML path \"Solver / Status Tests\": NOX refuses", "\"NormG\" is invalid"});
  expect_in(refusal(tests("Test Type: NormF, Tolerence: 1e-9")),
            {"Status Tests", "\"Tolerence\"", "\"Tolerance\" : double"});
  const std::string wrong_type = refusal(tests("Test Type: NormF, Tolerance: '1e-9'"));
  expect_in(wrong_type, {"Status Tests", "\"Tolerance\"", "wrong type"});
  EXPECT_EQ(std::count(wrong_type.begin(), wrong_type.end(), '\n'), 2);  // the line of the scene and its mark
  EXPECT_EQ(wrong_type.find("Throw number"), std::string::npos);
  expect_in(refusal(tests("")), {"Status Tests", "Test Type"});
}

TEST(SolverParameters, ManualNamesEveryList) {
  std::ostringstream out;
  print_parameters(out, solver_spec(), "Solver");
  expect_in(out.str(), {"[Load Path]", "[Newton]", "[Linear Solver]", "[NOX] optional", "[Status Tests] optional",
                        "(any parameters and lists)", "[LOCA] optional", "Maximum Rotation: double, 0 < value"});
}

}  // namespace
}  // namespace mixbeam
