/// Scenes with an accuracy, as a user runs them.
#include "mixbeam_files.hpp"

#include <nlohmann/json.hpp>

#include <cmath>
#include <regex>
#include <utility>

namespace mixbeam {
namespace {

class AccuracyOfAScene : public ::testing::Test {
 protected:
  enum { kFine = 0, kMissed = 1, kRefused = 2 };

  static std::string elastica() { return text_of(fs::path(MIXBEAM_SOURCE_DIR) / "apps/gallery/elastica.xml"); }
  /// The elastica with an accuracy, its member with what `division` says in place of order and elements.
  static std::string elastica_with(const std::string& accuracy, const std::string& division = "") {
    std::string text = std::regex_replace(elastica(), std::regex("<Parameter name=\"Elements\"[^>]*>"), "");
    text = std::regex_replace(text, std::regex("<Parameter name=\"Order\"[^>]*>"), division);
    const std::string scene = "<ParameterList name=\"Scene\">";
    return changed(text, scene, scene + "<Parameter name=\"Accuracy\" type=\"double\" value=\"" + accuracy + "\"/>");
  }

  Ended run(const std::string& command, const std::string& scene, std::vector<std::string> more = {}) {
    write_text(folder_ / "scene.xml", scene);
    std::vector<std::string> arguments = {command, (folder_ / "scene.xml").string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_process(program("mixbeam"), arguments, folder_);
  }
  Ended run_and_sum_up(const std::string& scene) {
    return run("run", scene, {"--output", (folder_ / "results").string(), "--summary", summary_file()});
  }
  std::string summary_file() const { return (folder_ / "summary.json").string(); }
  nlohmann::json chosen_mesh() const { return nlohmann::json::parse(text_of(summary_file()))["chosen_meshes"][0]; }

  TemporaryFolder folder_;
};

TEST_F(AccuracyOfAScene, IsReachedAndReported) {
  const Ended ended = run_and_sum_up(elastica_with("1e-9"));
  EXPECT_EQ(ended.exit_code, kFine) << ended.err << ended.out;
  expect_in(ended.out, {"wanted accuracy of displacements 1.0e-09", ": reached", "load path", "order "});
  const nlohmann::json mesh = chosen_mesh();
  EXPECT_EQ(mesh["outcome"], "reached");
  EXPECT_LT(mesh["estimated"].get<double>(), 1e-9);
  EXPECT_GE(mesh["members"][0]["order"].get<int>(), 5);
  EXPECT_FALSE(mesh["meshes"].empty());
  const auto contents = contents_of(folder_ / "results" / "scene.h5");
  ASSERT_TRUE(contents);
  EXPECT_EQ(contents->count("members/order"), 1u);
}

// Three elements of order 2 are what they are; the expected values of the scene notice it, too.
TEST_F(AccuracyOfAScene, IsMissedWhereAMemberKeepsItsMesh) {
  const std::string division = R"(<Parameter name="Order" type="int" value="2"/>)"
                               R"(<Parameter name="Elements" type="int" value="3"/>)";
  const Ended ended = run_and_sum_up(elastica_with("1e-9", division));
  EXPECT_EQ(ended.exit_code, kMissed) << ended.err << ended.out;
  expect_in(ended.out, {"orders or elements that members keep prevent it", "estimated error of displacements"});
  EXPECT_EQ(chosen_mesh()["members"][0]["order"], 2);
  EXPECT_EQ(chosen_mesh()["members"][0]["elements"], 3);
}

TEST_F(AccuracyOfAScene, RefusesBadValues) {
  for (const std::string value : {"0", "-1e-6", "1e-12", "1", "nan", "small"}) {
    const Ended ended = run("run", elastica_with(value));
    EXPECT_EQ(ended.exit_code, kRefused) << value << ended.out;
    expect_in(ended.err, {"scene.xml:", "\"Scene / Accuracy\"", value == "-1e-6" ? "-1e-06" : value});
  }
}

TEST_F(AccuracyOfAScene, CheckTellsTheStartMesh) {
  const Ended ended = run("check", elastica_with("1e-6"));
  EXPECT_EQ(ended.exit_code, kFine) << ended.err;
  expect_in(ended.out, {"start mesh for an accuracy of 1.0e-06", "order ", "elements "});
}

TEST_F(AccuracyOfAScene, CannotBeResumed) {
  ASSERT_EQ(run_and_sum_up(elastica_with("1e-9")).exit_code, kFine);
  const Ended resumed =
      run_process(program("mixbeam"), {"resume", (folder_ / "results" / "scene.h5").string()}, folder_);
  EXPECT_EQ(resumed.exit_code, kRefused);
  expect_in(resumed.err, {"scene.h5", "cannot be resumed", "accuracy"});
}

// Programs with studies set the meshes themselves.
TEST_F(AccuracyOfAScene, IsForMixbeamOnly) {
  const std::string scene = "<ParameterList name=\"Scene\">";
  write_text(folder_ / "fork.xml",
             changed(scene_of("fork"), scene, scene + R"(<Parameter name="Accuracy" type="double" value="1e-6"/>)"));
  const Ended ended = run_process(program("fork"), {(folder_ / "fork.xml").string(), "--single"}, folder_);
  EXPECT_EQ(ended.exit_code, kRefused);
  expect_in(ended.err, {"fork.xml:", "\"Scene / Accuracy\"", "mixbeam run"});
}

/// A wire of 20 mm that a force bends at its clamp within 0.2 m.
constexpr double kPull = 38000.0, kAcross = 2400.0, kYoung = 160e9, kPoisson = 0.3, kRadius = 0.01, kLengthOfWire = 2.0;

std::string wire_with(const std::string& mesh, const std::string& limit = "", const std::string& scene = "") {
  return "Scene:\n" + scene + R"(  Sections:
    rod: {Shape: circle, Diameter: 0.02, Material: {E: 160e9, nu: 0.3, Strength: 1.5e9}}
  Points: {a: [0, 0, 0], b: [2, 0, 0]}
  Members:
    rod: {Start: a, End: b)" +
         mesh + R"(}
  Supports:
    a: {Point: a}
  Point Loads:
    p: {Point: b, Force: [38000, 0, -2400]}
Quantities:
  stress: {Quantity: von Mises stress, Member: rod, Take: largest)" +
         limit + "}\n";
}

/// At the clamp. Along a beam without line loads M^2/2EI + N + N^2/2EA + Q^2/2GA is constant (theory (69)); at the free
/// end of one that is ten layers long M = 0 and it points along the force, to exp(-20) of the moment.
double stress_of_wire() {
  const double area = M_PI * kRadius * kRadius, bending = kYoung * 0.25 * area * kRadius * kRadius;
  const double shear_factor = 6.0 * (1.0 + kPoisson) / (7.0 + 6.0 * kPoisson);
  const double shear = shear_factor * kYoung / (2.0 * (1.0 + kPoisson)) * area;
  const auto without_moment = [&](double n, double q) {
    return n + 0.5 * n * n / (kYoung * area) + 0.5 * q * q / shear;
  };
  const double difference = without_moment(std::hypot(kPull, kAcross), 0.0) - without_moment(kPull, kAcross);
  const double moment = std::sqrt(2.0 * bending * difference);
  return kPull / area + moment * kRadius / (0.25 * area * kRadius * kRadius);
}

class StressWithAnError : public AccuracyOfAScene {
 protected:
  /// Value and error.
  std::pair<double, double> stress(const std::string& scene) {
    write_text(folder_ / "scene.yaml", scene);
    ended_ = run_process(program("mixbeam"), {"run", (folder_ / "scene.yaml").string(), "--summary", summary_file()},
                         folder_);
    const nlohmann::json quantity = nlohmann::json::parse(text_of(summary_file()))["quantities"][0];
    return {quantity["value"], quantity.value("error", std::nan(""))};
  }
  Ended ended_{};
};

// One element cannot bend within a twelfth of its length, whatever its order; the closed form of the layer tells.
TEST_F(StressWithAnError, OfAWireInOneElement) {
  const double exact = stress_of_wire();
  const auto [coarse, error] = stress(wire_with(", Order: 3, Elements: 1"));
  const double missed = exact - coarse;
  EXPECT_GT(missed, 0.05 * exact);
  EXPECT_LE(missed, error);
  EXPECT_LE(error, 2.0 * missed);  // 1.5 times the difference, and what the formula leaves out
  expect_in(ended_.out, {"bends within sqrt(EI/N) = 0.18", "closed form"});
  // twin: what sees the layer has no such warning, and a small error
  const auto [fine, small] = stress(wire_with(", Order: 6, Elements: 8"));
  EXPECT_NEAR(fine, exact, 1e-6 * exact);
  EXPECT_LE(small, 1e-3 * exact);
  EXPECT_EQ(ended_.out.find("bends within"), std::string::npos);
}

TEST_F(StressWithAnError, CountsInALimit) {
  const auto [coarse, error] = stress(wire_with(", Order: 3, Elements: 1"));
  for (const double share : {0.5, 1.01}) {
    stress(wire_with(", Order: 3, Elements: 1", ", Limit: " + std::to_string(coarse + share * error)));
    EXPECT_EQ(ended_.exit_code, share < 1.0 ? kMissed : kFine) << ended_.out;
  }
}

TEST_F(StressWithAnError, IsMadeSmallWhereTheAccuracyIsOfIt) {
  const double exact = stress_of_wire(), wanted = 1e-4;
  const auto [value, error] = stress(wire_with("", "", "  Accuracy: 1e-4\n  Accuracy Of: stress\n"));
  EXPECT_EQ(ended_.exit_code, kFine) << ended_.err << ended_.out;
  EXPECT_NEAR(value, exact, wanted * exact);
  EXPECT_LE(error, wanted * exact);
  expect_in(ended_.out, {"wanted accuracy of \"stress\" 1.0e-04"});
  EXPECT_EQ(
      run("run", elastica_with("1e-4\"/><Parameter name=\"Accuracy Of\" type=\"string\" value=\"strss")).exit_code,
      kRefused);
}

// Two guided ends: P_n = (n pi)^2 EI / L^2.
TEST_F(AccuracyOfAScene, ReachesFactorsOfLinearBuckling) {
  const std::string scene = R"(Scene:
  Accuracy: 1e-4
  Sections:
    rod: {Inextensible: true, Shear Rigid: true, GIt: 200, EI2: 1, EI3: 200}
  Points: {foot: [0, 0, 0], head: [1, 0, 0]}
  Members:
    column: {Start: foot, End: head, Second Axis: [0, 0, 1]}
  Supports:
    foot: {Point: foot, Fixed Rotation: [x, y]}
    head: {Point: head, Fixed Displacement: [y, z], Fixed Rotation: [x, y]}
  Point Loads:
    load: {Point: head, Force: [-1, 0, 0]}
Analysis: {Buckling Modes: 3}
)";
  write_text(folder_ / "scene.yaml", scene);
  const Ended ended = run_process(program("mixbeam"), {"run", (folder_ / "scene.yaml").string()}, folder_);
  EXPECT_EQ(ended.exit_code, kFine) << ended.err << ended.out;
  std::smatch found;
  ASSERT_TRUE(
      std::regex_search(ended.out, found, std::regex(R"(load factors \S+ \([^)]*\) \S+ \([^)]*\) (\S+) \(error)")))
      << ended.out;
  const double third = 9.0 * M_PI * M_PI;
  EXPECT_NEAR(std::stod(found[1]), third, 1e-4 * third);
}

}  // namespace
}  // namespace mixbeam
