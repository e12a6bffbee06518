/// The list "Gradient" as a user meets it: terminal, table, summary, result file, refusals.
#include "mixbeam_files.hpp"

namespace mixbeam::gradients_test {
namespace {

/// Derivative of the tip's deflection by the force: elliptic integrals, F L^2 / EI = 10.
constexpr double kOfForce = 0.0105359712168047, kTolerance = 1e-11;
constexpr double kOfCriticalLoad = 1e-8;

class GradientList : public MixbeamTest {
 protected:
  Ended run(const std::string& lists) {
    return run_scene(with(text_in_repository("apps/gallery/elastica.xml"), lists), {"--quiet"});
  }
  Ended asking(const std::string& gradient) {
    return run(
        "{Quantities: {tip: {Quantity: displacement, Point: tip}, count: {Quantity: negative eigenvalues}}, "
        "Gradient: {" +
        gradient + "}}");
  }
};

TEST_F(GradientList, StandsInTableFileAndSummary) {
  expect_in(
      expect_code(kOk,
                  asking("Of: [tip.y], With Respect To: ['Point Loads/*/Force[1]', Sections/*/EI3], By Element: true"))
          .out,
      {"gradient of tip.y", "by Point Loads/weight/Force[1]"});
  expect_in(text("summary.json"), {"\"gradients\"", "\"Sections/strip/EI3\""});
  std::istringstream lines(text("results/scene-gradients.csv"));
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(line, "quantity,value,number,derivative");
  for (const double wanted : {kOfForce, 10.0 * kOfForce}) {  // of F and of EI: one number, F / EI
    std::getline(lines, line);
    EXPECT_NEAR(std::stod(line.substr(line.rfind(',') + 1)), wanted, 10.0 * kTolerance) << line;
  }
  const auto contents = contents_of(folder_ / "results/scene.h5");
  for (const char* name : {"numbers", "0/derivative", "0/stiffness", "0/compliance", "0/natural"})
    EXPECT_EQ(contents.count(std::string("steps/000001/gradients/") + name), 1U) << name;
}

/// Numbers that cannot move to both sides: of a pattern they have no derivative, by themselves they are a mistake.
TEST_F(GradientList, LeavesOutNumbersAtTheirBounds) {
  const std::string scene =
      "{Scene: {Sections: {strip: {Mass: 1, Rotary Inertia: [0, 1, 1]}}}, Quantities: {tip: {Quantity: displacement, "
      "Point: tip}}, Gradient: {Of: [tip.y], With Respect To: [";
  Ended ended = run(scene + "'Sections/*/*']}}");
  EXPECT_EQ(ended.exit_code, kOk) << ended.err << ended.out;
  expect_in(ended.out,
            {"no derivative  by Sections/strip/Rotary Inertia[0]", "  by Sections/strip/EI3",
             "no derivative: the gradient with respect to \"Sections/strip/Rotary Inertia[0]\"", "value >= 0"});
  ended = run(scene + "'Sections/strip/Rotary Inertia[0]']}}");
  EXPECT_EQ(ended.exit_code, kCheckFailed) << ended.err << ended.out;
}

TEST_F(GradientList, FollowsVariablesIntoFormulasOfQuantities) {
  constexpr double kTip = -0.810609024880296;  // elliptic integrals, F L^2 / EI = 10
  expect_code(
      kOk,
      run("{Scene: {Variables: {c: 3}}, Quantities: {tip: {Quantity: displacement, Point: tip}, f: {Quantity: formula, "
          "Formula: c^2 * tip_y}}, Gradient: {Of: [f], With Respect To: [Variables/c]}}"));
  const std::string table = text("results/scene-gradients.csv");
  EXPECT_NEAR(std::stod(table.substr(table.rfind(',') + 1)), 2.0 * 3.0 * kTip, kTolerance) << table;
}

TEST_F(GradientList, RefusesWhatTheSceneDoesNotHave) {
  const std::vector<std::pair<std::string, std::string>> wrong = {
      {"Of: [top], With Respect To: [Sections/*/EI3]", R"(value "top" is no number that a quantity has)"},
      {"Of: [tip.x], With Respect To: [Sections/strip/EJ]", R"(value "Sections/strip/EJ" is no path)"},
      {"Of: [tip.x], With Respect To: ['Points/tip[-1]']", R"(value "Points/tip[-1]" is no path)"},
      {"Of: [tip.x]", "it asks for nothing"}};
  for (const auto& [gradient, message] : wrong) {
    expect_refused(asking(gradient), {message, "allowed"});
  }
}

/// The strip as a column: P L^2 = pi^2 EI / 4; a force across it is an imperfection.
TEST_F(GradientList, OfACriticalLoad) {
  const Ended ended =
      run("{Scene: {Sections: {strip: {EI2: 6}}, Point Loads: {weight: {Force: [-5, 0, 0]}}}, Gradient: {Of: [load "
          "factor at critical point 1], "
          "With Respect To: [Sections/*/EI3, 'Point Loads/*/Force[1]']}}");
  expect_in(ended.out, {"gradient of load factor at critical point 1", "no derivative  by Point Loads/weight/Force[1]",
                        "gradient of imperfection sensitivity at critical point 1"});
  std::istringstream lines(text("results/scene-gradients.csv"));
  std::string line;
  std::getline(lines, line);
  std::getline(lines, line);
  const double critical = 0.25 * std::acos(-1.0) * std::acos(-1.0) / 5.0;
  EXPECT_NEAR(std::stod(line.substr(line.rfind(',') + 1)), critical, kOfCriticalLoad) << line;
  const auto contents = contents_of(folder_ / "results/scene.h5");
  EXPECT_EQ(contents.count("steps/000001/gradients/1/derivative"), 1U);
}

TEST_F(GradientList, OfACriticalLoadBeforeTheStopOfARunThatIsResumed) {
  run("{Scene: {Sections: {strip: {EI2: 6}}, Point Loads: {weight: {Force: [-5, 0, 0]}}}, Solver: {Load Path: {Maximum "
      "Step: 0.2}}, Gradient: {Of: [load factor at critical point 1], With Respect To: [Sections/*/EI3]}}");
  const std::string table = text("results/scene-gradients.csv");
  fs::remove(folder_ / "results/scene-gradients.csv");
  mixbeam({"resume", "results/scene.h5", "--from", "4", "--quiet"});
  EXPECT_EQ(text("results/scene-gradients.csv"), table);
}

TEST_F(GradientList, OfACriticalLoadThatDidNotComeIsACheckThatFailed) {
  expect_in(expect_code(kCheckFailed,
                        asking("Of: [tip.y, load factor at critical point 2], With Respect To: [Sections/*/EI3]"))
                .out,
            {"gradient of tip.y", "it did not come; critical points on the path: 0"});
}

TEST_F(GradientList, LeavesOutQuantitiesThatAPatternMeans) {
  expect_in(
      expect_code(kOk, run(R"yaml({Quantities: {tip: {Quantity: displacement, Point: tip}, far: {Quantity: formula,
  Formula: tip_y / tip_z}, none: {Quantity: formula, Formula: tip_z / tip_z}, count: {Quantity: negative eigenvalues}},
  Gradient: {Of: ['*'], With Respect To: [Sections/*/EI3]}})yaml"))
          .out,
      {"gradient of tip.y", "no derivative: the gradient of \"count\": the quantity",
       "no derivative: the gradient of \"far\": it has no finite value", "unknown"});
  const std::string table = text("results/scene-gradients.csv");
  const std::size_t at = table.find("tip.y,");
  EXPECT_NEAR(std::stod(table.substr(table.find("EI3,", at) + 4)), 10.0 * kOfForce, 10.0 * kTolerance) << table;
}

/// The results stay.
TEST_F(GradientList, WithoutAnswerIsACheckThatFailed) {
  expect_in(expect_code(kCheckFailed, asking("Of: [count], With Respect To: [Sections/*/EI3]")).out,
            {"gradients", R"("negative eigenvalues" has no derivative)"});
  EXPECT_EQ(contents_of(folder_ / "results/scene.h5").count("steps/000001"), 1U);
}

}  // namespace
}  // namespace mixbeam::gradients_test
