/// Every quantity that a scene may expect, of a rod whose answer is exact.
#include "apps/common/run/application.hpp"
#include "apps/common/run/quantity_values.hpp"

#include "tests/support/ranks.hpp"
#include "tests/support/scenes.hpp"

#include <gtest/gtest.h>

namespace mixbeam::expected_quantity_test {
namespace {

constexpr double kLength = 4.0, kAxial = 1000.0, kBending = 20.0;
constexpr double kPull = 3.0, kBend = 2.0;
constexpr double kTolerance = 1e-9;  // Newton's method ends below it for values of order one

/// A rod along y from "foot" to "tip", clamped at its foot.
class ExpectedQuantities {
 public:
  ExpectedQuantities(const Vector3& force, const Vector3& moment)
      : simulation_(
            test::structure({{"foot", {0, 0, 0}}, {"tip", {0, kLength, 0}}}, {test::line("rod", "foot", "tip", 4, 4)},
                            {test::clamp("foot")}, {test::dead_load("tip", force, moment)},
                            test::section(kAxial, 500.0, kBending, kBending)),
            {}, test::this_rank()) {
    EXPECT_TRUE(simulation_.run().finished);
  }

  double at_point(const std::string& quantity, const std::string& point, const std::string& component) const {
    ExpectedValue wanted;
    wanted.point = point;
    return value(wanted, quantity, component).value();
  }
  double in_section(const std::string& quantity, double position, const std::string& component) const {
    ExpectedValue wanted;
    wanted.member = "rod";
    wanted.position = position;
    return value(wanted, quantity, component).value();
  }
  std::optional<double> value(ExpectedValue wanted, const std::string& quantity,
                              const std::string& component = "") const {
    wanted.quantity = quantity;
    wanted.component = component;
    return present_value(simulation_, wanted);
  }

 private:
  Simulation simulation_;
};

TEST(ExpectedQuantity, OfARodUnderTension) {
  const ExpectedQuantities values({0, kPull, 0}, {});
  EXPECT_NEAR(values.at_point("displacement", "tip", "y"), kPull * kLength / kAxial, kTolerance);
  EXPECT_NEAR(values.at_point("position", "tip", "norm"), kLength * (1.0 + kPull / kAxial), kTolerance);
  EXPECT_NEAR(values.at_point("reaction force", "foot", "y"), -kPull, kTolerance);
  EXPECT_NEAR(values.at_point("reaction force", "foot", "norm"), kPull, kTolerance);
  for (const double position : {0.0, 0.25, 0.3, 1.0}) {
    EXPECT_NEAR(values.in_section("material force", position, "1"), kPull, kTolerance) << position;
    EXPECT_NEAR(values.in_section("material force", position, "2"), 0.0, kTolerance) << position;
  }
  EXPECT_NEAR(values.value({}, "strain energy").value(), 0.5 * kPull * kPull * kLength / kAxial, kTolerance);
}

TEST(ExpectedQuantity, OfARodBentToACircle) {
  const ExpectedQuantities values({}, {0, 0, kBend});
  EXPECT_NEAR(values.at_point("rotation", "tip", "z"), kBend * kLength / kBending, kTolerance);
  EXPECT_NEAR(values.at_point("reaction moment", "foot", "z"), -kBend, kTolerance);
  EXPECT_NEAR(values.in_section("material moment", 0.6, "3"), kBend, kTolerance);
  EXPECT_NEAR(values.in_section("material moment", 0.6, "norm"), kBend, kTolerance);
  EXPECT_NEAR(values.value({}, "strain energy").value(), 0.5 * kBend * kBend * kLength / kBending, kTolerance);
}

/// An application's own quantity, and a path that begins again.
TEST(ExpectedQuantity, AtACriticalPoint) {
  const Simulation simulation(
      test::structure({{"foot", {0, 0, 0}}, {"tip", {0, kLength, 0}}}, {test::line("rod", "foot", "tip", 4, 4)},
                      {test::clamp("foot")}, {}, test::section(kAxial, 500.0, kBending, kBending)),
      {}, test::this_rank());
  Application app;
  app.communicator = test::this_rank();
  ExpectedValue wanted;
  wanted.name = wanted.quantity = "twice the load factor";
  wanted.critical_point = 1;
  wanted.value = 0.5;
  wanted.source = "closed form";
  app.expected = {wanted};
  StepReport report;
  report.point.critical_points = 1;
  report.critical_points.push_back(
      {CriticalKind::limit_point, 0.25, 0, 1, simulation.state(), simulation.model().create_vector()});
  app.check_expected(simulation, report,
                     [](const Simulation& at, const ExpectedValue&) { return 2.0 * at.load_factor(); });
  EXPECT_TRUE(app.not_compared().empty());
  EXPECT_EQ(app.summary.checks().size(), 1U);
  EXPECT_TRUE(app.summary.all_passed());
  app.forget_path(0);
  EXPECT_EQ(app.not_compared().size(), 1U);
  EXPECT_EQ(app.critical_points(""), 0);
  EXPECT_TRUE(app.summary.checks().empty());
}

TEST(ExpectedQuantity, ChangesAlongTheRod) {  // linear for a load this small: moment F (L - s)
  constexpr double kSmall = 1e-6;
  const ExpectedQuantities values({0, 0, kSmall}, {});
  for (const double position : {0.0, 0.1, 0.5, 0.75, 1.0}) {
    EXPECT_NEAR(values.in_section("material moment", position, "norm"), kSmall * kLength * (1.0 - position),
                1e-6 * kSmall * kLength)
        << position;
  }
}

TEST(ExpectedQuantity, LeavesOthersToTheApplication) {
  const ExpectedQuantities values({0, kPull, 0}, {});
  EXPECT_FALSE(values.value({}, "iterations"));
}

}  // namespace
}  // namespace mixbeam::expected_quantity_test
