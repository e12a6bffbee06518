/// Imperfect structures: no stress without loads, and the closed form of a bowed column.
#include "discretization/scene/section_shape.hpp"
#include "nonlinear/run/imperfect_scene.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/scene_file.hpp"
#include "tests/support/solve.hpp"

namespace mixbeam::test {
namespace {

constexpr double kNoForce = 1e-12;       // of EI / L^2 = 1: rounding of rows that are sums of some hundred terms
constexpr double kArcAndChord = 1e-4;    // arc length is not height: 0.02 times the square of its slope 0.063
constexpr double kMiddleOfArc = 1e-6;    // half of the arc is not half of the chord: the offset times its slope squared
constexpr double kCritical = kPi * kPi;  // of the column: EI = L = 1

/// A pinned column along z from "foot" to "head", pressed by `force`, with a list "Imperfection".
std::string column(double force, const std::string& imperfection) {
  return R"yaml(Scene:
  Sections: {s: {Inextensible: true, Shear Rigid: true, GIt: 1, EI2: 1, EI3: 1}}
  Points: {foot: [0, 0, 0], head: [0, 0, 1]}
  Members: {strut: {Start: foot, End: head, Section: s, Order: 4, Elements: 8}}
  Supports:
    a: {Point: foot, Fixed Displacement: [x, y, z], Fixed Rotation: [x, z]}
    b: {Point: head, Fixed Displacement: [x, y], Fixed Rotation: [x, z]}
  Point Loads: {p: {Point: head, Force: [0, 0, )yaml" +
         std::to_string(-force) + "]}}\n" + (imperfection.empty() ? "" : "  Imperfection: {" + imperfection + "}\n");
}

Scene scene_from(const std::string& text) {
  XmlParameters xml = parsed(text);
  return with_mode_shapes(read_scene(xml.list->sublist("Scene"), xml.source), {}, this_rank(), {xml.source, {"Scene"}});
}

std::string refusal(const std::string& imperfection) {
  return error_of<InputError>([&] { scene_from(column(1.0, imperfection)); });
}

std::string bow(double amplitude, const std::string& direction = "[1, 0, 0]") {
  return "Bows: {b: {Member: '*', Amplitude: " + std::to_string(amplitude) + ", Direction: " + direction + "}}, ";
}
std::string mode(int number, double amplitude) {
  return "Modes: {m: {Mode: " + std::to_string(number) + ", Amplitude: " + std::to_string(amplitude) + "}}, ";
}

std::string mode_at_critical_point(int number, double amplitude) {
  return changed(mode(number, amplitude), "Mode:", "Critical Point:");
}

TEST(Imperfections, AreFreeOfStress) {
  for (const std::string& imperfection : {bow(0.02), mode(1, 0.02), mode(2, -0.02)}) {
    const Simulation unloaded(scene_from(column(1.0, imperfection)), {}, this_rank());
    for (const Reaction& reaction : unloaded.reactions()) {
      EXPECT_LE(largest_component(reaction.force), kNoForce);
      EXPECT_LE(largest_component(reaction.moment), kNoForce);
    }
    const StrainEnergy energy = unloaded.strain_energy();
    EXPECT_EQ(energy.force + energy.moment, 0.0);
    EXPECT_NEAR(std::abs(unloaded.sample("strut", 0.5).position[0]), imperfection == mode(2, -0.02) ? 0.0 : 0.02,
                kMiddleOfArc);
  }
}

TEST(Imperfections, ABowedColumnBendsAsItsAmplification) {  // a / (1 - P / P_cr), to the square of the slope
  const double a = 1e-3;
  for (const double share : {0.2, 0.5, 0.8})
    for (const std::string& imperfection : {bow(a), bow(-a), mode(1, a), mode(1, -a)}) {
      const Simulation loaded = solved(scene_from(column(share * kCritical, imperfection)));
      const double deflection = std::abs(loaded.sample("strut", 0.5).position[0]);
      const double expected = a / (1.0 - share), slope = kPi * expected;
      EXPECT_NEAR(deflection, expected, slope * slope * expected) << imperfection << share;
    }
  const Simulation perfect = solved(scene_from(column(0.5 * kCritical, "")));  // the twin
  EXPECT_LE(std::abs(perfect.sample("strut", 0.5).position[0]), 1e-12);
}

/// The path of a straight column that cannot be strained is straight: its bifurcation is that of linear buckling.
TEST(Imperfections, FollowModesOfCriticalPoints) {
  const auto offset = [](const std::string& imperfection, double s) {
    return Simulation(scene_from(column(2.0 * kCritical, imperfection)), {}, this_rank())
        .sample("strut", s)
        .position[0];
  };
  const std::string of_path = mode_at_critical_point(1, 0.02);
  const double sign = offset(mode(1, 0.02), 0.5) * offset(of_path, 0.5) > 0.0 ? 1.0 : -1.0;
  for (const double s : {0.1, 0.25, 0.5, 0.7}) {
    EXPECT_NEAR(offset(of_path, s), sign * offset(mode(1, 0.02), s), kMiddleOfArc) << s;
    EXPECT_NEAR(std::abs(offset(of_path, s)), 0.02 * std::sin(kPi * s), kArcAndChord) << s;
  }
  EXPECT_NEAR(offset(mode_at_critical_point(1, -0.02), 0.5), -offset(of_path, 0.5), kMiddleOfArc);
  const Simulation unloaded(scene_from(column(2.0 * kCritical, of_path)), {}, this_rank());
  const StrainEnergy energy = unloaded.strain_energy();
  EXPECT_EQ(energy.force + energy.moment, 0.0);
}

TEST(Imperfections, SignsFollowTheAmplitude) {
  const auto side = [](const std::string& imperfection) {
    return solved(scene_from(column(0.5 * kCritical, imperfection))).sample("strut", 0.5).position[0] > 0.0;
  };
  EXPECT_TRUE(side(bow(1e-3)));
  EXPECT_FALSE(side(bow(-1e-3)));
  EXPECT_NE(side(mode(1, 1e-3)), side(mode(1, -1e-3)));
}

TEST(Imperfections, SwayLeansTheStructure) {
  const std::string sway = "Sway: {Ratio: 0.005, Direction: [2, 0, 0]}, ";
  const Scene scene = scene_from(column(1.0, sway));
  EXPECT_EQ(scene.points[1].position, (Vector3{0.005, 0, 1}));
  EXPECT_EQ(scene.points[0].position, (Vector3{0, 0, 0}));
}

TEST(Imperfections, AreRefusedWithThePlace) {
  expect_in(refusal(bow(0.1, "[0, 0, 1]")), {"Imperfection / Bows / b / Direction", "along the member"});
  expect_in(refusal(bow(1e27)), {"Imperfection / Bows / b", "member \"strut\"", "no tangent"});
  EXPECT_EQ(refusal(bow(0.1)), "no error");
  expect_in(refusal(mode(100, 0.1)), {"Imperfection / Modes / m / Mode", "value 100; allowed: 1 to "});
  expect_in(refusal(changed(mode(1, 0.1), "Mode: 1, ", "")), {"Imperfection / Modes / m / Mode", "missing"});
  expect_in(refusal(mode_at_critical_point(1, 0.1)),
            {"Imperfection / Modes / m / Critical Point", "value 1; allowed: none", "meets none"});
  expect_in(refusal(changed(mode(1, 0.1), "Mode: 1", "Critical Point: 1, Mode: 1")),
            {"Imperfection / Modes / m", "both of", "exactly one"});
  expect_in(refusal("Sway: {Ratio: 0.005, Direction: [0, 0, -2]}"),
            {"Imperfection / Sway / Direction", "along \"Up\""});
  expect_in(refusal("Points: {hed: [0,0,1]}"), {"Imperfection / Points / hed", "did you mean \"head\"?"});
  expect_in(refusal("Case: x, " + mode(1, 0.1)), {"no load cases"});
}

}  // namespace
}  // namespace mixbeam::test
