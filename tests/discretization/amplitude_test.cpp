#include "discretization/scene/amplitude.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace mixbeam {
namespace {

TEST(Amplitude, WithoutAFormulaIsTheRampOfItsStage) {
  const Amplitude second(2, 3);
  EXPECT_EQ(second(0.5), 0.0);
  EXPECT_EQ(second(1.25), 0.25);
  EXPECT_EQ(second(7.0), 1.0);
  EXPECT_EQ(second.slope(0.5), 0.0);
  EXPECT_EQ(second.slope(1.0), 1.0);
  EXPECT_EQ(second.slope(2.0), 0.0);
}

TEST(Amplitude, RampsGoOnOutsideTheRangeOfAllStages) {
  const Amplitude first(1, 2), last(2, 2);
  EXPECT_EQ(first(-0.5), -0.5);
  EXPECT_EQ(first.slope(-0.5), 1.0);
  EXPECT_EQ(first(1.5), 1.0);
  EXPECT_EQ(last(-0.5), 0.0);
  EXPECT_EQ(last(2.5), 1.5);
  EXPECT_EQ(last.slope(2.5), 1.0);
}

TEST(Amplitude, FollowsAFormulaOfTheLoadFactor) {
  constexpr double kDifferenceError = 1e-11;  // step^4 / 30 times the fifth derivative, and rounding over the step
  const Amplitude wave(1, 1, "sin(2*t)");
  for (const double t : {0.0, 0.3, 1.0, 2.5}) {
    EXPECT_DOUBLE_EQ(wave(t), std::sin(2.0 * t));
    EXPECT_NEAR(wave.slope(t), 2.0 * std::cos(2.0 * t), 32 * kDifferenceError);
  }
  EXPECT_THROW(Amplitude(1, 1, "sin(2*q)"), std::invalid_argument);
}

}  // namespace
}  // namespace mixbeam
