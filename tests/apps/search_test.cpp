/// Covariance of numbers that a list "Identification" finds; what a user sees of it is in searches_test.py.
#include "apps/common/run/scene_file.hpp"
#include "apps/mixbeam/commands.hpp"
#include "tests/support/random_numbers.hpp"
#include "tests/support/ranks.hpp"

#include <gtest/gtest.h>

namespace mixbeam::search_test {
namespace {

/// The bend of 45 degrees under 600: EI and GIt from the motion of its tip.
constexpr const char* kArc = R"(Scene:
  Variables: {EI: 8.34e5, GIt: 8.32e5}
  Sections: {rod: {EA: 1.0e7, GA2: 5.0e6, GA3: 5.0e6, GIt: "=GIt", EI2: "=EI", EI3: "=EI"}}
  Points: {clamp: [0, 0, 0]}
  Members:
    arc: {Start: clamp, End: tip, Section: rod, Order: 2, Elements: 4,
          Curve: {Shape: arc, Center: [0, -100, 0], Axis: [0, 0, -1], Angle: "=45 deg"}}
  Supports: {clamp: {Point: clamp}}
  Point Loads: {force: {Point: tip, Force: [0, 0, 600]}}
Quantities: {tip: {Quantity: displacement, Point: tip}}
Identification:
  Parameters: {bending: {Number: Variables/EI, At Least: 1}, torsion: {Number: Variables/GIt, At Least: 1}}
  Measurements:
    x: {Quantity: tip.x, Value: -23.560239545026, Standard Deviation: 1e-6}
    y: {Quantity: tip.y, Value: 13.604521347307, Standard Deviation: 1e-6}
    z: {Quantity: tip.z, Value: 53.474858791825, Standard Deviation: 1e-6}
)";

TEST(Identification, CovarianceCoversNoise) {
  constexpr std::uint64_t kSeed = 20251128;
  constexpr int kSamples = 200;
  constexpr double kPi = 3.14159265358979323846, kWithinTwoSigma = 0.95, kTolerance = 0.03;
  Application app;
  std::ostringstream said;
  app.communicator = test::this_rank();
  app.terminal = &said;
  const ListSpec root = mixbeam_root_spec();
  read_scene_file(app, parse_parameters(kArc, "scene.yaml", root), mixbeam_definition(), root);
  const auto search = [&] { return search_scene(app, root, [](const SearchStep&) {}); };
  std::vector<WantedQuantity>& wanted = app.search->wanted;
  const FoundScene exact = search();  // for this mesh
  RandomNumbers random(kSeed);
  double covered[2] = {0.0, 0.0};
  for (int sample = 0; sample < kSamples; ++sample) {
    for (std::size_t k = 0; k < wanted.size(); ++k) {
      const double radius = std::sqrt(-2.0 * std::log(random.between(1e-12, 1.0)));
      const double angle = random.between(0.0, 2.0 * kPi);
      wanted[k].deviation = 0.001 * static_cast<double>(k + 1);
      wanted[k].value = exact.values[k] + wanted[k].deviation * radius * std::cos(angle);
    }
    const FoundScene found = search();
    ASSERT_EQ(found.end, SearchEnd::found) << "sample " << sample << " of seed " << kSeed << ": " << found.failure;
    for (std::size_t i = 0; i < 2; ++i)
      if (std::abs(found.numbers[i].value - exact.numbers[i].value) <= 2.0 * found.numbers[i].deviation)
        covered[i] += 1.0 / kSamples;
  }
  for (const double share : covered) EXPECT_NEAR(share, kWithinTwoSigma, kTolerance) << "seed " << kSeed;
}

}  // namespace
}  // namespace mixbeam::search_test
