#include "nonlinear/parameters/solver_parameters.hpp"

#include "discretization/parameters/print.hpp"
#include "discretization/parameters/validate.hpp"
#include "tests/discretization/input_text.hpp"

#include <sstream>

namespace mixbeam {
namespace {

std::string list(const std::string& name, const std::string& inside) {
  return "<ParameterList name=\"" + name + "\">" + inside + "</ParameterList>\n";
}

std::string entry(const std::string& name, const std::string& type, const std::string& value) {
  return "<Parameter name=\"" + name + "\" type=\"" + type + "\" value=\"" + value + "\"/>\n";
}

SolverParameters solver_from(const std::string& inside) {
  XmlParameters xml = parse_xml(
      "<ParameterList name=\"root\"><ParameterList name=\"Solver\">\n" + inside + "</ParameterList></ParameterList>",
      "scene.xml");
  return read_solver_parameters(xml.list->sublist("Solver"), xml.source);
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
    XmlParameters given = parse_xml("<ParameterList name=\"root\">\n" + inside + "</ParameterList>", "scene.xml");
    return validate(*given.list, solver_spec(), given.source, {});
  };
  const std::vector<std::string> warnings = warnings_of(list("Newton", entry("Tangent Reuse", "int", "3")) +
                                                        list("Linear Solver", entry("Precision", "string", "single")) +
                                                        entry("Symmetric Tangent", "bool", "true"));
  ASSERT_EQ(warnings.size(), 3);
  expect_in(warnings[0], {"scene.xml:6: XML path \"Symmetric Tangent\": ", "was removed"});
  expect_in(warnings[1], {"scene.xml:2: XML path \"Newton / Tangent Reuse\": ", "was removed"});
  expect_in(warnings[2], {"scene.xml:4: XML path \"Linear Solver / Precision\": ", "was removed"});
  EXPECT_TRUE(warnings_of(list("Newton", entry("Maximum Rotation", "double", "0.3"))).empty());
  expect_in(refusal(list("Newton", entry("Tangent Reus", "int", "3"))), {"Tangent Reus", "unknown name"});
}

TEST(SolverParameters, AreRead) {
  const SolverParameters read = solver_from(
      list("Load Path", entry("Method", "string", "fixed") + entry("Steps", "int", "7")) +
      list("Newton", entry("Residual Tolerance", "double", "1e-8") + entry("Maximum Rotation", "double", "0.25")) +
      list("Linear Solver", entry("Method", "string", "KLU2")) + entry("Threads", "int", "2"));
  EXPECT_EQ(read.load_path.method, LoadPathMethod::fixed);
  EXPECT_EQ(read.load_path.steps, 7);
  EXPECT_EQ(read.newton.residual_tolerance, 1e-8);
  EXPECT_EQ(read.newton.maximum_rotation, 0.25);
  EXPECT_EQ(read.linear.method, "KLU2");
  EXPECT_EQ(read.threads, 2);
}

TEST(SolverParameters, StepSizesMustFitTogether) {
  const auto path = [](const std::string& inside) { return list("Load Path", inside); };
  EXPECT_EQ(solver_from(path(entry("Maximum Step", "double", "0.1"))).load_path.initial_step, 0.1);
  expect_in(refusal(path(entry("Maximum Step", "double", "0.1") + entry("Initial Step", "double", "0.5"))),
            {"scene.xml:3: ", "\"Solver / Load Path / Initial Step\"", "value 0.5", "\"Maximum Step\" = 0.1"});
  expect_in(refusal(path(entry("Maximum Step", "double", "0.1") + entry("Minimum Step", "double", "0.2"))),
            {"Minimum Step", "value 0.2"});
  expect_in(refusal(path(entry("Steps", "int", "3"))), {"Steps", "no meaning for \"Method\" = \"automatic\""});
  expect_in(refusal(path(entry("Method", "string", "fixed") + entry("Aggressiveness", "double", "1"))),
            {"Aggressiveness", "no meaning for \"Method\" = \"fixed\""});
}

TEST(SolverParameters, AreRefusedWithAPlaceAndTheNearestName) {
  expect_in(refusal(list("Newton", "\n" + entry("Maximum Iteration", "int", "3"))),
            {"scene.xml:3: XML path \"Solver / Newton / Maximum Iteration\"", "did you mean \"Maximum Iterations\"?"});
  expect_in(refusal(list("Newtn", "")), {"did you mean \"Newton\"?"});
  expect_in(refusal(list("Linear Solver", entry("Method", "string", "KLU"))), {"\"KLU\"", "did you mean \"KLU2\"?"});
  expect_in(refusal(list("Linear Solver", entry("Force Stiffness Cap", "double", "1e20"))),
            {"value 1e+20", "<= 1e+14"});
  expect_in(refusal(entry("Threads", "int", "-1")), {"value -1"});
}

TEST(SolverParameters, HandOverWhatWasGivenToNoxAndLoca) {
  const SolverParameters read = solver_from(
      list("NOX", list("Line Search",
                       entry("Method", "string", "Backtrack") + list("Backtrack", entry("Max Iters", "int", "4"))) +
                      list("Printing", list("Output Information", entry("Outer Iteration", "bool", "true")))) +
      list("LOCA", list("Stepper", entry("Continuation Method", "string", "Natural"))) +
      list("Status Tests", entry("Test Type", "string", "Combo") + entry("Combo Type", "string", "OR") +
                               entry("Number of Tests", "int", "1") +
                               list("Test 0", entry("Test Type", "string", "NormF"))));
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
  const auto step_size = [](const std::string& inside) { return list("LOCA", list("Step Size", inside)); };
  expect_in(refusal(step_size(entry("Failed Step Reduction Facter", "double", "0.5"))),
            {"\"Solver / LOCA / Step Size / ", "did you mean \"Failed Step Reduction Factor\"?"});
  expect_in(refusal(list("NOX", list("Line Search", entry("Method", "string", "Full-Step")))),
            {"\"Rotation Limited\"", "did you mean \"Full Step\"?"});
  expect_in(refusal(list("NOX", list("Direction", list("Newton", entry("Forcing Term Methd", "string", "Constant"))))),
            {"did you mean \"Forcing Term Method\"?"});
  expect_in(refusal(list("LOCA", list("Stepper", entry("Bordered Solver Method", "string", "Nested")))),
            {"\"Nested\"", "\"Bordering\""});
}

TEST(SolverParameters, RefuseStatusTestsThatNoxRefuses) {
  const auto tests = [](const std::string& inside) { return "\n" + list("Status Tests", inside); };
  expect_in(refusal(tests(entry("Test Type", "string", "NormG"))),
            {"scene.xml:3: XML path \"Solver / Status Tests\": NOX refuses", "\"NormG\" is invalid"});
  expect_in(refusal(tests(entry("Test Type", "string", "NormF") + entry("Tolerence", "double", "1e-9"))),
            {"Status Tests", "\"Tolerence\"", "\"Tolerance\" : double"});
  const std::string wrong_type =
      refusal(tests(entry("Test Type", "string", "NormF") + entry("Tolerance", "string", "1e-9")));
  expect_in(wrong_type, {"Status Tests", "\"Tolerance\"", "wrong type"});
  EXPECT_EQ(wrong_type.find('\n'), std::string::npos);
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
