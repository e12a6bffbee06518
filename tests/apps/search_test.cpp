/// Scenes with the lists "Identification" and "Design": numbers found, their covariance, ends.
#include "apps/mixbeam/commands.hpp"
#include "tests/support/random_numbers.hpp"
#include "tests/support/ranks.hpp"
#include "tests/support/text.hpp"

namespace mixbeam::search_test {
namespace {

/// The bend of 45 degrees under 600: EI and GIt from the motion of its tip, which shooting on the equations of the rod
/// gives for 5e6 / 6 of both.
constexpr double kStiffness = 2.5e6 / 3.0, kTip[3] = {-23.560239545026, 13.604521347307, 53.474858791825};
constexpr const char* kArc = R"(Name: arc
Scene:
  Variables: {EI: 1.2e6, GIt: 4.0e5}
  Sections: {rod: {EA: 1.0e7, GA2: 5.0e6, GA3: 5.0e6, GIt: "=GIt", EI2: "=EI", EI3: "=EI"}}
  Points: {clamp: [0, 0, 0]}
  Members:
    arc: {Start: clamp, End: tip, Section: rod, Order: 4, Elements: 8,
          Curve: {Shape: arc, Center: [0, -100, 0], Axis: [0, 0, -1], Angle: "=45 deg"}}
  Supports: {clamp: {Point: clamp}}
  Point Loads: {force: {Point: tip, Force: [0, 0, 600]}}
Quantities:
  tip: {Quantity: displacement, Point: tip}
Identification:
  Parameters:
    bending: {Number: Variables/EI, At Least: 1}
    torsion: {Number: Variables/GIt, At Least: 1}
  Measurements:
    x: {Quantity: tip.x, Value: -23.560239545026, Standard Deviation: 0.02}
    y: {Quantity: tip.y, Value: 13.604521347307, Standard Deviation: 0.02}
    z: {Quantity: tip.z, Value: 53.474858791825, Standard Deviation: 0.02}
)";

/// A scene in this process.
struct Read {
  Application app;
  std::ostringstream said;

  explicit Read(const std::string& text) {
    app.communicator = test::this_rank();
    app.terminal = &said;
    read_scene_file(app, parse_parameters(text, "scene.yaml", mixbeam_root_spec()), mixbeam_definition(),
                    mixbeam_root_spec());
  }
  FoundScene found() {
    return search_scene(app, mixbeam_root_spec(), [](const SearchStep&) {});
  }
};

TEST(Identification, FindsStiffnessesOfTheSpatialArc) {
  constexpr double kExact = 1e-8;
  const FoundScene found = Read(kArc).found();
  EXPECT_EQ(found.end, SearchEnd::found);
  ASSERT_EQ(found.numbers.size(), 2U);
  for (const SearchedNumber& number : found.numbers) EXPECT_NEAR(number.value / kStiffness, 1.0, kExact) << number.name;
  // the twin with another measurement
  const FoundScene other = Read(changed(kArc, "53.47485", "53.47486")).found();
  EXPECT_GT(std::abs(other.numbers[1].value / kStiffness - 1.0), kExact);
}

TEST(Identification, CovarianceCoversNoise) {
  constexpr std::uint64_t kSeed = 20251128;
  constexpr int kSamples = 200;
  constexpr double kPi = 3.14159265358979323846, kWithinTwoSigma = 0.95, kTolerance = 0.03;
  std::string text = changed(changed(kArc, "EI: 1.2e6", "EI: 8.34e5"), "GIt: 4.0e5", "GIt: 8.32e5");
  Read read(changed(changed(text, "Order: 4", "Order: 2"), "Elements: 8", "Elements: 4"));
  std::vector<WantedQuantity>& wanted = read.app.search->wanted;
  for (WantedQuantity& one : wanted) one.deviation = 1e-6;
  const FoundScene exact = read.found();  // for this mesh
  RandomNumbers random(kSeed);
  double covered[2] = {0.0, 0.0};
  for (int sample = 0; sample < kSamples; ++sample) {
    for (std::size_t k = 0; k < wanted.size(); ++k) {
      const double radius = std::sqrt(-2.0 * std::log(random.between(1e-12, 1.0)));
      const double angle = random.between(0.0, 2.0 * kPi);
      wanted[k].deviation = 0.001 * static_cast<double>(k + 1);
      wanted[k].value = exact.values[k] + wanted[k].deviation * radius * std::cos(angle);
    }
    const FoundScene found = read.found();
    ASSERT_EQ(found.end, SearchEnd::found) << "sample " << sample << " of seed " << kSeed << ": " << found.failure;
    for (std::size_t i = 0; i < 2; ++i)
      if (std::abs(found.numbers[i].value - exact.numbers[i].value) <= 2.0 * found.numbers[i].deviation)
        covered[i] += 1.0 / kSamples;
  }
  for (const double share : covered) EXPECT_NEAR(share, kWithinTwoSigma, kTolerance) << "seed " << kSeed;
}

/// A strut whose Euler load bounds what it bears without moving aside.
constexpr const char* kPlane = R"(Name: plane
Scene:
  Variables: {EI: 1.5, P: 2}
  Sections: {rod: {EA: inf, GA2: inf, GA3: inf, GIt: 1, EI2: 1, EI3: "=EI"}}
  Points: {a: [0, 0, 0], b: [1, 0, 0]}
  Members: {rod: {Start: a, End: b, Order: 4, Elements: 8}}
  Supports: {wall: {Point: a}}
  Point Loads: {weight: {Point: b, Force: [0, "=-P", 0]}}
Quantities: {tip: {Quantity: displacement, Point: b}}
Identification:
  Parameters: {EI: {Number: Variables/EI}}
  Measurements: {down: {Quantity: tip.y, Value: -0.301720773799814, Standard Deviation: 0.01}}
)";

TEST(Identification, TellsWhatMeasurementsDoNotTellApart) {
  const FoundScene found =
      Read(changed(kPlane, "{EI: {Number: Variables/EI}}",
                   "{EI: {Number: Variables/EI}, load: {Number: Variables/P}, torsion: {Number: Sections/rod/GIt}}"))
          .found();
  EXPECT_NEAR(found.numbers[1].value / found.numbers[0].value, 1.0, 1e-8);  // P L^2 / EI of the elastica
  EXPECT_EQ(found.numbers[2].value, 1.0);
  for (const SearchedNumber& number : found.numbers) EXPECT_TRUE(std::isinf(number.deviation)) << number.name;
  ASSERT_EQ(found.remarks.size(), 2U);
  expect_in(found.remarks[0] + found.remarks[1],
            {"do not tell the parameters apart", "EI by", "load by", "torsion by"});
}

TEST(Identification, StopsAtBounds) {
  const FoundScene found =
      Read(changed(kPlane, "{Number: Variables/EI}", "{Number: Variables/EI, At Most: 1.75}")).found();
  EXPECT_EQ(found.end, SearchEnd::found);
  EXPECT_EQ(found.numbers[0].value, 1.75);
  EXPECT_TRUE(found.numbers[0].is_held && std::isnan(found.numbers[0].deviation));
  const FoundScene free =
      Read(changed(kPlane, "{Number: Variables/EI}", "{Number: Variables/EI, At Most: 2.5}")).found();
  EXPECT_NEAR(free.numbers[0].value, 2.0, 1e-8);
  EXPECT_FALSE(free.numbers[0].is_held);
}

/// Two halves of a cantilever whose stiffnesses are paid for, by a small load: of the linear theory 7 / EI1 + 1 / EI2 =
/// 24 w / (P L^3), so the least sum has EI1 = sqrt(7) EI2.
constexpr const char* kStepped = R"(Name: stepped
Scene:
  Variables: {root: 3, end: 3}
  Sections:
    root: {EA: inf, GA2: inf, GA3: inf, GIt: 1, EI2: 1, EI3: "=root"}
    end: {EA: inf, GA2: inf, GA3: inf, GIt: 1, EI2: 1, EI3: "=end"}
  Points: {a: [0, 0, 0], middle: [0.5, 0, 0], b: [1, 0, 0]}
  Members:
    root: {Start: a, End: middle, Section: root, Order: 3, Elements: 2}
    end: {Start: middle, End: b, Section: end, Order: 3, Elements: 2}
  Supports: {wall: {Point: a}}
  Point Loads: {weight: {Point: b, Force: [0, -1.0e-4, 0]}}
Quantities:
  tip: {Quantity: displacement, Point: b, Component: y}
  price: {Quantity: formula, Formula: "root + end"}
Design:
  Parameters:
    root: {Number: Variables/root, At Least: 0.01}
    end: {Number: Variables/end, At Least: 0.01}
  Objective: {Quantity: price}
  Constraints:
    sag: {Quantity: tip, At Least: -1.0e-5}
)";

class Design : public ::testing::Test {
 protected:
  static constexpr double kNear = 1e-7;  ///< of the linear theory: squares of rotations are 1e-10
  static void expect_numbers(const FoundScene& found, double root, double end) {
    EXPECT_EQ(found.end, SearchEnd::found) << found.failure;
    EXPECT_NEAR(found.numbers[0].value, root, kNear * root);
    EXPECT_NEAR(found.numbers[1].value, end, kNear * end);
  }
};

TEST_F(Design, IsTheBestThatConstraintsAllow) {
  const double end = (1.0 + std::sqrt(7.0)) / 2.4, root = std::sqrt(7.0) * end;
  expect_numbers(Read(kStepped).found(), root, end);
  // as an equation, and as the smallest sag that the price allows
  expect_numbers(Read(changed(kStepped, "At Least: -1.0e-5", "At Least: -1.0e-5, At Most: -1.0e-5")).found(), root,
                 end);
  const std::string turned =
      changed(changed(kStepped, "{Quantity: price}", "{Quantity: tip, Goal: largest}"),
              "{Quantity: tip, At Least: -1.0e-5}", "{Quantity: price, At Most: \"=(8 + 2*sqrt(7))/2.4\"}");
  expect_numbers(Read(turned).found(), root, end);
}

TEST_F(Design, KeepsToBounds) {
  const FoundScene found = Read(changed(kStepped, "At Least: 0.01", "At Least: 0.01, At Most: 3.5")).found();
  expect_numbers(found, 3.5, 2.5);  // 7 / 3.5 + 1 / 2.5 = 2.4
  EXPECT_TRUE(found.numbers[0].is_held);
  EXPECT_FALSE(found.numbers[1].is_held);
}

TEST_F(Design, SaysThatConstraintsCannotBeMet) {
  const std::string weak = changed(changed(kStepped, "0.01}\n    end", "0.01, At Most: 3.1}\n    end"), "0.01}\n  Obj",
                                   "0.01, At Most: 3.1}\n  Obj");
  const FoundScene found = Read(weak).found();
  EXPECT_EQ(found.end, SearchEnd::no_descent);
  expect_in(found.failure, {"meet all constraints"});
}

/// The largest load of a strut: no step leaves the branch on which it stays straight.
TEST_F(Design, EndsWhereABranchEnds) {
  constexpr double kEuler = 2.46740110027234;  // pi^2 EI / (4 L^2) about the weaker axis
  std::string text = changed(kPlane, "[0, \"=-P\", 0]", "[\"=-P\", 0, 0]");
  text = changed(text, "{tip: {Quantity: displacement, Point: b}}", "{load: {Quantity: formula, Formula: P}}");
  text = text.substr(0, text.find("Identification:")) +
         "Design: {Parameters: {P: {Number: Variables/P}}, Objective: {Quantity: load, Goal: largest}}\n";
  const FoundScene found = Read(text).found();
  EXPECT_EQ(found.end, SearchEnd::blocked);
  expect_in(found.failure, {"cannot be carried to P = ", "negative eigenvalues changes from 0 to 1"});
  EXPECT_NEAR(found.numbers[0].value, kEuler, 1e-6);
}

/// Numbers of arrays, with formulas beside them and without.
TEST(Identification, FindsNumbersOfArrays) {
  const std::string numbers = "{load: {Number: 'Point Loads/weight/Force[1]'}, place: {Number: 'Points/b[0]'}}";
  const std::string text =
      changed(changed(changed(kPlane, "[0, \"=-P\", 0]", "[\"=0*P\", -2, 0]"), "{EI: {Number: Variables/EI}}", numbers),
              "Measurements: {",
              "Measurements: {along: {Quantity: tip.x, Value: -0.0564332362833769, "
              "Standard Deviation: 0.01}, ");
  const FoundScene found = Read(text).found();
  EXPECT_NEAR(found.numbers[0].value, -1.5, 1e-8);  // P L^2 / EI = 1, L = 1
  EXPECT_NEAR(found.numbers[1].value, 1.0, 1e-8);
  expect_in(found.xml, {"{=0*P, -1.", "type=\"Array(double)\""});
}

}  // namespace
}  // namespace mixbeam::search_test
