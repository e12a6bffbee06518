/// Scenes with an accuracy, as a user runs them.
#include "mixbeam_files.hpp"

#include <nlohmann/json.hpp>

#include <regex>
#include <utility>

namespace mixbeam {
namespace {

class AccuracyOfAScene : public MixbeamTest {
 protected:
  /// The elastica with an accuracy, its member with what `division` says in place of order and elements.
  static std::string elastica_with(const std::string& accuracy, const std::string& division = "") {
    const std::string free = std::regex_replace(text_in_repository("apps/gallery/elastica.xml"),
                                                std::regex("<Parameter name=\"(Elements|Order)\"[^>]*>"), "");
    return with(free, "Scene: {Accuracy: " + accuracy + ", Members: {strip: {" + division + "}}}");
  }

  nlohmann::json summary() const { return nlohmann::json::parse(text("summary.json")); }
  nlohmann::json chosen_mesh() const { return summary()["chosen_meshes"][0]; }
};

TEST_F(AccuracyOfAScene, IsReachedAndReported) {
  expect_in(expect_code(kOk, run_scene(elastica_with("1e-9"))).out,
            {"wanted accuracy of displacements 1.0e-09", ": reached", "load path", "order "});
  const nlohmann::json mesh = chosen_mesh();
  EXPECT_EQ(mesh["outcome"], "reached");
  EXPECT_LT(mesh["estimated"].get<double>(), 1e-9);
  EXPECT_GE(mesh["members"][0]["order"].get<int>(), 5);
  EXPECT_FALSE(mesh["meshes"].empty());
  const auto contents = contents_of(folder_ / "results/scene.h5");
  EXPECT_EQ(contents.count("members/order"), 1u);
}

// Three elements of order 2 are what they are; the expected values of the scene notice it, too.
TEST_F(AccuracyOfAScene, IsMissedWhereAMemberKeepsItsMesh) {
  expect_in(expect_code(kCheckFailed, run_scene(elastica_with("1e-9", "Order: 2, Elements: 3"))).out,
            {"orders or elements that members keep prevent it", "estimated error of displacements"});
  EXPECT_EQ(chosen_mesh()["members"][0]["order"], 2);
  EXPECT_EQ(chosen_mesh()["members"][0]["elements"], 3);
}

TEST_F(AccuracyOfAScene, RefusesBadValues) {
  for (const std::string value : {"0", "-1e-6", "1e-12", "1", "nan", "small"}) {
    expect_in(expect_code(kBadInput, run_scene(elastica_with(value))).err,
              {"scene.xml:", "\"Scene / Accuracy\"", value == "-1e-6" ? "-1e-06" : value});
  }
}

TEST_F(AccuracyOfAScene, CheckTellsTheStartMesh) {
  expect_in(expect_code(kOk, check_scene(elastica_with("1e-6"))).out,
            {"start mesh for an accuracy of 1.0e-06", "order ", "elements "});
}

TEST_F(AccuracyOfAScene, CannotBeResumed) {
  ASSERT_EQ(run_scene(elastica_with("1e-9")).exit_code, kOk);
  expect_in(expect_code(kBadInput, mixbeam({"resume", file("results/scene.h5")})).err,
            {"scene.h5", "cannot be resumed", "accuracy"});
}

// Programs with studies set the meshes themselves.
TEST_F(AccuracyOfAScene, IsForMixbeamOnly) {
  write_text(folder_ / "fork.xml", with(scene_of("fork"), "Scene: {Accuracy: 1e-6}"));
  expect_in(expect_code(kBadInput, run_process(program("fork"), {file("fork.xml"), "--single"}, folder_)).err,
            {"fork.xml:", "\"Scene / Accuracy\"", "mixbeam run"});
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
    ended_ = run_scene(scene);
    const nlohmann::json quantity = summary()["quantities"][0];
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
    EXPECT_EQ(ended_.exit_code, share < 1.0 ? kCheckFailed : kOk) << ended_.out;
  }
}

// In a batch as in a single run; inside of such an element nothing is estimated, and no limit is kept.
TEST_F(StressWithAnError, CountsInALimitOfABatch) {
  const auto [coarse, error] = stress(wire_with(", Order: 3, Elements: 1"));
  const auto batch_with = [&](const std::string& limit) {
    return mixbeam({"batch", write_scene(wire_with(", Order: 3, Elements: 1", limit) + R"(Batch:
  Output: quantities
  Vary:
    pull: {Parameter: "Point Loads/p/Force[2]", First: -2400, Last: -2399, Count: 2}
)")});
  };
  for (const double share : {0.5, 1.01}) {
    const Ended ended = batch_with(", Limit: " + std::to_string(coarse + share * error));
    EXPECT_EQ(ended.exit_code, share < 1.0 ? kCheckFailed : kOk) << ended.out;
  }
  expect_in(
      expect_code(kCheckFailed,
                  batch_with("}\n  inside: {Quantity: material moment, Member: rod, Component: \"2\", Position: 0.1, "
                             "Limit: 1e9"))
          .out,
      {"0 of 2 checks passed", "an error that is not known"});
}

/// Of a wire held at both ends, stretched by a thousandth, one element on either side of a weight in its middle.
std::string weighted_wire(const std::string& mesh) {
  return R"(Scene:
  Sections:
    wire: {Shape: circle, Diameter: 0.01, Material: {E: 160e9, nu: 0.3}}
  Points: {a: [0, 0, 0], m: [5, 0, 0], b: [10, 0, 0]}
  Members:
    left: {Start: a, End: m, Section: wire)" +
         mesh + R"(}
    right: {Start: m, End: b, Section: wire)" +
         mesh + R"(}
  Supports:
    a: {Point: a}
    b: {Point: b}
  Eigenstrains:
    e: {Member: "*", Strain: [-0.001, 0, 0]}
  Point Loads:
    p: {Point: m, Force: [0, 0, -1]}
Quantities:
  sag: {Quantity: displacement, Point: m, Component: z}
)";
}

// The clamped ends and the kink under the weight hold a wire up to N F^-1 w = L/4 - l tanh(L/4l), l = sqrt(EI/N); a
// difference of two orders saw a thirteenth of what the elements miss.
TEST_F(StressWithAnError, OfTheSagBesideLayers) {
  const double area = M_PI * 0.005 * 0.005, tension = 0.001 * 160e9 * area;
  const double layer = std::sqrt(0.25 * 160e9 * area * 0.005 * 0.005 / tension);
  const double exact = -(2.5 - layer * std::tanh(2.5 / layer)) / tension;
  constexpr double kOfStretching = 1e-4;  // and shear: the weight adds 3e-7 of strain
  for (const char* mesh : {", Order: 2, Elements: 1", ", Order: 3, Elements: 1", ", Order: 4, Elements: 2"}) {
    const auto [sag, error] = stress(weighted_wire(mesh));
    EXPECT_GT(std::abs(sag - exact), 10.0 * kOfStretching * std::abs(exact)) << mesh;
    EXPECT_LE(std::abs(sag - exact), error) << mesh;
    EXPECT_LE(error, 2.0 * std::abs(sag - exact)) << mesh;
  }
  const auto [fine, small] = stress(weighted_wire(", Order: 6, Elements: 16"));  // twin
  EXPECT_NEAR(fine, exact, kOfStretching * std::abs(exact));
  EXPECT_LE(small, kOfStretching * std::abs(exact));
}

// The force at the clamp is what hangs on it. Material components turn with the axis, and their polynomials of two
// orders missed it alike: the true error was 4.4 times the estimate.
TEST_F(StressWithAnError, OfTheLargestForceOfABentRod) {
  const auto [force, error] = stress(R"(Scene:
  Sections:
    rod: {Shape: circle, Diameter: 0.02, Material: {E: 160e9, nu: 0.3}}
  Points: {a: [0, 0, 0], b: [3.337, 0, 0]}
  Members:
    rod: {Start: a, End: b, Order: 2, Elements: 2}
  Supports:
    a: {Point: a}
  Point Loads:
    p: {Point: b, Force: [1672, 0, -348]}
  Distributed Loads:
    q: {Member: rod, Force: [0, 0, -165]}
Quantities:
  force: {Quantity: material force, Member: rod, Component: norm, Take: largest}
)");
  const double exact = std::hypot(1672.0, 348.0 + 165.0 * 3.337);
  EXPECT_GT(std::abs(force - exact), 0.005 * exact);
  EXPECT_LE(std::abs(force - exact), error);
  EXPECT_LE(error, 2.0 * std::abs(force - exact));
}

/// Tip of a clamped column of length and EI one under P that leans from its axis by `lean`: P = (K(k) - F(f, k))^2 with
/// k sin f = sin(lean/2). Its sideways displacement, in the frame of the axis.
double tip_of_column(double load, double lean) {
  const auto start = [&](double k) { return std::asin(std::sin(0.5 * lean) / k); };
  double low = std::sin(0.5 * lean) * (1.0 + 1e-12), high = 0.9;  // k, by halving
  for (int i = 0; i < 200; ++i) {
    const double k = 0.5 * (low + high);
    (std::comp_ellint_1(k) - std::ellint_1(k, start(k)) < std::sqrt(load) ? low : high) = k;
  }
  const double k = low, f = start(k), root = std::sqrt(load);
  const double along = 2.0 / root * (std::comp_ellint_2(k) - std::ellint_2(k, f)) - 1.0;
  const double across = 2.0 * k / root * std::cos(f);
  return across * std::cos(lean) - along * std::sin(lean);
}

// A residual within the tolerance leaves 8e-9 of the tip at 1.0005 P_cr, 3e-8 at 1.00005: over the smallest eigenvalue.
TEST_F(AccuracyOfAScene, IsReachedNextToACriticalLoad) {
  for (const auto& [over, push] : {std::pair(5e-4, 0.0), std::pair(5e-5, 0.0), std::pair(5e-4, 1e-6)}) {
    const double load = (1.0 + over) * 0.25 * M_PI * M_PI;
    std::ostringstream scene;
    scene.precision(17);
    scene
        << "Scene:\n  Accuracy: 1e-8\n  Sections:\n    rod: {Inextensible: true, Shear Rigid: true, GIt: 1, EI2: 1, "
           "EI3: 1}\n  Points: {a: [0, 0, 0], b: [0, 0, 1]}\n  Members:\n    rod: {Start: a, End: b, Second Axis: [0, "
           "1, "
           "0]}\n  Supports:\n    a: {Point: a}\n    b: {Point: b, Fixed Displacement: [y], Fixed Rotation: [x, z]}\n  "
           "Point Loads:\n    p: {Point: b, Force: ["
        << push << ", 0, " << -load << "]}\n"
        << (push > 0.0 ? "" : "Analysis: {Branch: positive}\n")
        << "Quantities:\n  tip: {Quantity: displacement, Point: b, Component: x}\n";
    expect_code(kOk, run_scene(scene.str()));
    const double tip = summary()["quantities"][0]["value"];
    const double exact = tip_of_column(std::hypot(load, push), std::atan2(push, load));
    EXPECT_NEAR(std::abs(tip), exact, 1e-8 * exact) << over << " " << push;
  }
}

TEST_F(StressWithAnError, IsMadeSmallWhereTheAccuracyIsOfIt) {
  const double exact = stress_of_wire(), wanted = 1e-4;
  const auto [value, error] = stress(wire_with("", "", "  Accuracy: 1e-4\n  Accuracy Of: stress\n"));
  EXPECT_EQ(ended_.exit_code, kOk) << ended_.err << ended_.out;
  EXPECT_NEAR(value, exact, wanted * exact);
  EXPECT_LE(error, wanted * exact);
  expect_in(ended_.out, {"wanted accuracy of \"stress\" 1.0e-04"});
  EXPECT_EQ(run_scene(elastica_with("1e-4\"/><Parameter name=\"Accuracy Of\" type=\"string\" value=\"strss")).exit_code,
            kBadInput);
}

// alpha = 10, elliptic integrals. Everything as accurate takes order 8; the tip converges with the power 2 k.
TEST_F(AccuracyOfAScene, OfTheTipAloneTakesACoarserMesh) {
  const std::string quantities = "Quantities: {tip: {Quantity: displacement, Point: tip, Component: y}}";
  int work[2];
  for (const bool of_tip : {false, true}) {
    const std::string scene = with(elastica_with("1e-8"), quantities);
    const Ended ended = expect_code(kOk, run_scene(of_tip ? with(scene, "Scene: {Accuracy Of: tip}") : scene));
    const nlohmann::json member = chosen_mesh()["members"][0];
    work[of_tip ? 1 : 0] = member["order"].get<int>() * member["elements"].get<int>();
    if (!of_tip) continue;
    expect_in(ended.out, {"wanted accuracy of \"tip\" 1.0e-08"});
    const double tip = summary()["quantities"][0]["value"];
    EXPECT_NEAR(tip, -0.810609024880296, 1e-8);
  }
  EXPECT_LT(3 * work[1], 2 * work[0]);
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
  const Ended ended = expect_code(kOk, run_scene(scene));
  std::smatch found;
  ASSERT_TRUE(
      std::regex_search(ended.out, found, std::regex(R"(load factors \S+ \([^)]*\) \S+ \([^)]*\) (\S+) \(error)")))
      << ended.out;
  const double third = 9.0 * M_PI * M_PI;
  EXPECT_NEAR(std::stod(found[1]), third, 1e-4 * third);
}

}  // namespace
}  // namespace mixbeam
