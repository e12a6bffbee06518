/// Quantities of solved structures: against closed forms, and extremes against 1e5 points of the same fields.
#include "discretization/quantities/quantity_set.hpp"
#include "discretization/scene/section_shape.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/scene_numbers.hpp"
#include "tests/support/solve.hpp"

namespace mixbeam::test {
namespace {

using Numbers = std::map<std::string, double>;

Numbers numbers_of(const std::vector<Quantity>& quantities, const Simulation& simulation, bool has_samples = true) {
  const ParameterSource source("scene.xml");
  const QuantitySet set(quantities, simulation.scene(), {source, {"Quantities"}});
  const std::vector<Reaction> reactions = simulation.reactions();
  const SampledMembers samples = simulation.samples(kPointsByOrder);
  const std::vector<double> values = set.values({simulation.model(), simulation.state(), simulation.load_factor(),
                                                 reactions, simulation.strain_energy(), simulation.stability().negative,
                                                 simulation.jumps(), has_samples ? &samples : nullptr});
  Numbers numbers;
  for (std::size_t i = 0; i < values.size(); ++i) numbers[set.names()[i]] = values[i];
  return numbers;
}

std::string refusal(const std::vector<Quantity>& quantities, const Scene& scene) {
  const ParameterSource source("scene.xml");
  return error_of<InputError>([&] { QuantitySet(quantities, scene, {source, {"Quantities"}}); });
}

/// Beam on two supports under a load that grows linearly from one end, so small that the theory of first order holds.
Scene beam_under_triangle(double load, int order, const std::vector<double>& stations) {
  Scene scene = cantilever(section(1e6, kRigid, 20.0, 20.0), 4.0, order, static_cast<int>(stations.size()) - 1);
  scene.members[0].stations = stations;
  scene.supports = {support("clamp", kHeld, {true, true, false}),
                    support("tip", {false, true, true}, {true, true, false})};
  scene.distributed_loads = {{"beam"}};
  scene.distributed_loads[0].force_formula = {"0", std::to_string(-load) + " * x", "0"};
  return scene;
}

/// A cubic in each element is the moment itself; what remains is second order in the deflection.
constexpr double kSmallDeflection = 1e-6;

TEST(Quantities, LargestMomentLiesBetweenSamples) {
  const double q = 1e-2, length = 4.0;
  const Simulation beam = solved(beam_under_triangle(q, 4, {0.0, 0.31, 0.47, 1.0}));
  const Quantity moment = quantity("M", "material moment", {{"Member", "*"}, {"Component", "3"}, {"Take", "largest"}});
  for (const bool has_samples : {true, false}) {
    Numbers at = numbers_of({moment}, beam, has_samples);
    const double exact = q * length * length / (9.0 * std::sqrt(3.0));
    EXPECT_NEAR(at["M"], exact, kSmallDeflection * exact);
    EXPECT_NEAR(at["M.arc_length"], length / std::sqrt(3.0), 1e-3);
    EXPECT_EQ(at["M.side"], 0.0);
    EXPECT_EQ(at["M.member"], 0.0);
    double sampled = 0.0;
    constexpr int kPoints = 100'000;
    for (int i = 0; i <= kPoints; ++i)
      sampled = std::max(sampled, beam.sample("beam", static_cast<double>(i) / kPoints).moment[2]);
    EXPECT_LE(sampled, at["M"] * (1.0 + 1e-13));
    EXPECT_NEAR(sampled, at["M"], 1e-9 * exact);  // 1e-5 of the length beside the peak
    double coarse = 0.0;                          // the twin: the samples of the file alone are not the extreme
    for (const double m : {0.0, 0.25, 0.5, 0.75, 1.0}) coarse = std::max(coarse, beam.sample("beam", m).moment[2]);
    EXPECT_LT(coarse, at["M"] * (1.0 - 1e-3));
  }
}

TEST(Quantities, ExtremesOfEveryFieldAreNeverExceeded) {
  const Simulation beam = solved(slope_discontinuity(3, 2));
  std::vector<Quantity> quantities;
  const std::vector<std::string> kinds = {"displacement",  "position",           "rotation",       "material force",
                                          "spatial force", "material curvature", "spatial moment", "spatial strain"};
  for (const std::string& kind : kinds)
    for (const std::string take : {"largest", "smallest", "largest size"})
      quantities.push_back(
          quantity(kind + take, kind,
                   {{"Member", "leg *"}, {"Component", kind.rfind("material", 0) == 0 ? "2" : "y"}, {"Take", take}}));
  Numbers at = numbers_of(quantities, beam);
  for (const std::string& kind : kinds) {
    double largest = -HUGE_VAL, smallest = HUGE_VAL;
    const std::string component = kind.rfind("material", 0) == 0 ? "2" : "y";
    for (const char* member : {"leg 1", "leg 2", "leg 3"}) {
      Quantity here = quantity("here", kind, {{"Member", member}, {"Component", component}, {"Position", "0"}});
      for (int i = 0; i <= 40; ++i) {
        here.position = i / 40.0;
        for (const bool before : {false, true}) {
          here.before_vertex = before;
          const double value = numbers_of({here}, beam)["here"];
          largest = std::max(largest, value);
          smallest = std::min(smallest, value);
        }
      }
    }
    const double size = std::max(std::abs(largest), std::abs(smallest)), rounding = 1e-12 * size;
    EXPECT_LE(largest, at[kind + "largest"] + rounding) << kind;
    EXPECT_GE(smallest, at[kind + "smallest"] - rounding) << kind;
    EXPECT_NEAR(largest, at[kind + "largest"], 1e-2 * size) << kind;  // 40 points for each member are near it
    EXPECT_NEAR(smallest, at[kind + "smallest"], 1e-2 * size) << kind;
    const bool is_up = at[kind + "largest"] > -at[kind + "smallest"];
    EXPECT_EQ(at[kind + "largest size"], at[kind + (is_up ? "largest" : "smallest")]) << kind;
  }
}

TEST(Quantities, OfARodThatIsBentToAQuarterAndStretched) {
  const double length = 2.0, bending = 20.0, axial = 1e3, angle = kPi / 2.0;
  Scene bent = cantilever(section(axial, kRigid, bending, bending), length, 4, 4);
  bent.point_loads = {dead_load("tip", {}, {0, 0, bending * angle / length})};
  const Simulation circle = solved(bent);
  const double radius = length / angle;
  Numbers at = numbers_of(
      {quantity("chord", "distance", {{"Point", "clamp"}, {"Other Point", "tip"}}),
       quantity("at the middle", "angle", {{"Point", "clamp"}, {"Other Point", "tip"}, {"Corner", "beam@50%"}}),
       quantity("arc", "length", {{"Member", "beam"}}), quantity("axes", "triad", {{"Point", "tip"}}),
       quantity("axes there", "triad", {{"Point", "beam@2"}, {"Component", "g2"}}),
       quantity("turned", "rotation", {{"Point", "beam@0.5"}, {"Component", "z"}}),
       quantity("held", "reaction moment", {{"Point", "*"}, {"Take", "sum"}}),
       quantity("twice", "formula", {{"Formula", "2 * chord + held_z"}})},
      circle);
  const double rounding = 1e-9;  // Newton's method ends below it
  EXPECT_NEAR(at["chord"], radius * std::sqrt(2.0), rounding);
  EXPECT_NEAR(at["at the middle"], kPi - angle / 2.0, rounding);  // of the inscribed angle
  EXPECT_NEAR(at["arc"], length, rounding);
  EXPECT_NEAR(at["axes.g1.y"], 1.0, rounding);
  EXPECT_NEAR(at["axes.g2.x"], -1.0, rounding);
  EXPECT_NEAR(at["axes there.x"], -1.0, rounding);
  EXPECT_NEAR(at["turned"], angle / 4.0, rounding);
  EXPECT_NEAR(at["held.z"], -bending * angle / length, rounding);
  EXPECT_NEAR(at["twice"], 2.0 * radius * std::sqrt(2.0) - bending * angle / length, 3.0 * rounding);
  Scene pulled = cantilever(section(axial, kRigid, bending, bending), length, 2, 3);
  pulled.point_loads = {dead_load("tip", {30.0, 0, 0})};
  EXPECT_NEAR(numbers_of({quantity("L", "length", {{"Member", "beam"}})}, solved(pulled))["L"], length * 1.03,
              rounding);
}

TEST(Quantities, SidesOfAVertexDiffer) {  // a force at an inner point: the shear force jumps
  Scene scene = cantilever(section(1e6, 1e6, 20.0, 20.0), 2.0, 2, 2);
  scene.members[0].inner_points = {{"middle", 0.5}};
  scene.point_loads = {dead_load("middle", {0, 1e-3, 0})};
  const Simulation beam = solved(scene);
  const auto shear = [](const std::string& name, const std::string& side) {
    return quantity(name, "material force", {{"Point", "middle"}, {"Component", "2"}, {"Side", side}});
  };
  Numbers at = numbers_of({shear("before", "before"), shear("after", "after")}, beam);
  EXPECT_NEAR(at["before"], 1e-3, 1e-9);
  EXPECT_NEAR(at["after"], 0.0, 1e-9);
}

TEST(Quantities, PatternsMeanEachOrOneOfAll) {
  const Simulation beam = solved(slope_discontinuity(2, 2));
  Numbers at =
      numbers_of({quantity("u", "displacement", {{"Point", "*corner"}, {"Component", "z"}}),
                  quantity("sum", "displacement", {{"Point", "*corner"}, {"Component", "z"}, {"Take", "sum"}}),
                  quantity("least", "displacement", {{"Point", "*corner"}, {"Component", "z"}, {"Take", "smallest"}}),
                  quantity("M", "material moment", {{"Point", "leg *@50%"}})},
                 beam);
  const double first = beam.displacement("first corner")[2], second = beam.displacement("second corner")[2];
  EXPECT_EQ(at["u[first corner]"], first);
  EXPECT_EQ(at["u[second corner]"], second);
  EXPECT_EQ(at["sum"], first + second);
  EXPECT_EQ(at["least"], std::min(first, second));
  EXPECT_EQ(at["M[leg 3@50%].2"], beam.sample("leg 3", 0.5).moment[1]);
  EXPECT_EQ(at.count("M[leg 3@50%].3"), 1U);
}

TEST(Quantities, StressesAreThoseOfTheForces) {  // cantilever of square section: 6 M / a^3 at the clamp, below it N / A
  SectionShape square;
  square.kind = SectionShapeKind::rectangle;
  square.size2 = square.size3 = 0.1;
  square.youngs_modulus = 1e9;
  square.strength = 1e6;
  Scene scene = cantilever(make_section("square", square), 1.0, 3, 4);
  scene.members[0].section = "square";
  scene.point_loads = {dead_load("tip", {0, -1.0, 0})};
  const Simulation bent = solved(scene);
  Numbers at = numbers_of({quantity("s", "normal stress", {{"Member", "*"}, {"Take", "largest size"}}),
                           quantity("v", "von Mises stress", {{"Point", "beam@0%"}}),
                           quantity("u", "utilisation", {{"Member", "beam"}, {"Take", "largest"}})},
                          bent);
  EXPECT_NEAR(std::abs(at["s"]), 6.0 / 1e-3, 1e-4 * 6e3);  // the arm is shorter by the deflection squared
  EXPECT_EQ(at["s.arc_length"], 0.0);
  EXPECT_NEAR(at["v"], 6e3, 1e-4 * 6e3);
  EXPECT_NEAR(at["u"], 6e-3, 1e-4 * 6e-3);
  const Quantity stress = quantity("s", "von Mises stress", {{"Member", "*"}, {"Take", "largest"}});
  expect_in(refusal({stress}, slope_discontinuity(2, 2)), {"/ s / Member", "known shape", "\"Shape\""});
}

TEST(Quantities, NamesThatMatchNothingAreRefused) {
  const Scene scene = slope_discontinuity(2, 2);
  const auto of_point = [](const std::string& point) { return quantity("u", "displacement", {{"Point", point}}); };
  expect_in(refusal({of_point("tpi")}, scene), {"\"Quantities / u / Point\"", "\"tpi\"", "did you mean \"tip\"?"});
  expect_in(refusal({of_point("legg*@50%")}, scene), {"is not a member", "\"leg 1\""});
  expect_in(refusal({of_point("leg 1@1.5")}, scene), {"beyond the end", "up to 1"});
  expect_in(refusal({of_point("leg 1@x")}, scene), {"allowed after @"});
  expect_in(refusal({quantity("R", "reaction force", {{"Point", "tip"}})}, scene), {"no support", "\"clamp\""});
  expect_in(refusal({quantity("N", "material force", {{"Point", "first corner"}})}, scene),
            {"several members meet", "MEMBER@s"});
  expect_in(refusal({quantity("f", "formula", {{"Formula", "2 * u"}})}, scene), {"/ f / Formula", "\"u\""});
  EXPECT_EQ(refusal({of_point("tip")}, scene), "no error");
}

}  // namespace
}  // namespace mixbeam::test
