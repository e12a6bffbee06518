#include "discretization/scene/amplitude.hpp"

#include "kernels/math/constants.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <vector>

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

std::vector<LoadTurn> turns_inside(const std::string& formula) {
  Scene scene;
  scene.point_loads.resize(1);
  scene.point_loads[0].amplitude = formula;
  std::vector<LoadTurn> inside;
  const LoadClock clock(scene);
  for (const LoadTurn& turn : clock.turns())
    if (turn.before > 0.0 && turn.after < 1.0) inside.push_back(turn);
  return inside;
}

TEST(LoadClock, FindsTurningPointsAndJumps) {
  constexpr double kSmooth = 6e-8;  // a peak is flat: its place is rounded to seven digits
  constexpr double kSharp = 1e-14;
  const struct {
    std::string formula;
    std::vector<double> turns;
    double tolerance;
  } cases[] = {{"4*t*(1-t)", {0.5}, kSmooth},
               {"sin(7*t)", {kPi / 14, 3 * kPi / 14}, kSmooth},
               {"exp(-((t-0.99987)/3e-5)^2)", {0.99987}, kSmooth},
               {"max(0, 1-abs(t-0.3217)/5e-5)", {0.3217}, kSharp},
               {"abs(t-1/3) + 1e-17*sin(1e5*t)", {1.0 / 3.0}, kSharp},
               {"(abs(t-0.77) < 5e-5) ? 1 : 0", {0.76995, 0.77005}, kSharp},
               {"rint(3*t)/3 - t", {1.0 / 6.0, 0.5, 5.0 / 6.0}, kSharp},
               {"t^3", {}, 0.0},
               {"cos(t)^2 + sin(t)^2", {}, 0.0},
               {"min(t, 0.5)", {}, 0.0}};
  for (const auto& one : cases) {
    const std::vector<LoadTurn> found = turns_inside(one.formula);
    ASSERT_EQ(found.size(), one.turns.size()) << one.formula;
    for (size_t i = 0; i < found.size(); ++i) {
      EXPECT_NEAR(found[i].before, one.turns[i], one.tolerance) << one.formula;
      EXPECT_NEAR(found[i].after, found[i].before, 2e-15) << one.formula;
      EXPECT_EQ(found[i].is_jump(), one.formula[0] == '(' || one.formula[0] == 'r') << one.formula;
    }
  }
}

// In a piece loads grow like a ramp, and beyond it they go on; at its ends they are those of the formula, bit by bit.
TEST(LoadClock, MakesRampsOfFormulas) {
  Scene scene;
  scene.point_loads.resize(1);
  scene.point_loads[0].amplitude = "(t < 0.5) ? t^2 : 3";
  const auto clock = std::make_shared<LoadClock>(scene);
  Amplitude amplitude(1, 1, scene.point_loads[0].amplitude);
  amplitude.follow(clock);
  const std::vector<LoadPiece> pieces = clock->pieces(1);
  ASSERT_EQ(pieces.size(), 3u);
  constexpr double kOfInversion = 1e-13;
  clock->run(pieces[0]);
  EXPECT_NEAR(amplitude(0.36), 0.36 * 0.25, kOfInversion);
  EXPECT_NEAR(clock->load_factor(0.36), 0.3, kOfInversion);
  EXPECT_NEAR(amplitude.slope(0.0), 0.25, 1e3 * kOfInversion);  // difference of step 1e-3
  EXPECT_NEAR(amplitude(-2.0), -2.0 * 0.25, kOfInversion);
  clock->run(pieces[1]);
  EXPECT_TRUE(pieces[1].is_jump);
  EXPECT_NEAR(amplitude(pieces[1].from + 0.5), 0.5 * (0.25 + 3.0), kOfInversion);
  EXPECT_EQ(amplitude(pieces[1].end()), 3.0);
  clock->run(std::nullopt);
  EXPECT_EQ(amplitude(pieces[1].to), 3.0);
  EXPECT_NEAR(amplitude(pieces[1].from), 0.25, kOfInversion);
}

// A ramp against a formula along one line turns back where their sum does, sqrt(1/3) here; across each other, or at two
// points, both go on.
TEST(LoadClock, SumsLoadsAlongOneLine) {
  constexpr double kSmooth = 6e-8;  // a peak is flat
  Scene scene;
  scene.point_loads.resize(2);
  scene.point_loads[0] = {"tip", {0.0, -0.5, 0.0}};
  scene.point_loads[1] = {"tip", {0.0, 0.5, 0.0}};
  scene.point_loads[1].amplitude = "t^3";
  const auto turns = [&] {
    std::vector<double> inside;
    const LoadClock clock(scene);
    for (const LoadTurn& turn : clock.turns())
      if (turn.before > 0.0 && turn.after < 1.0) inside.push_back(turn.before);
    return inside;
  };
  ASSERT_EQ(turns().size(), 1u);
  EXPECT_NEAR(turns()[0], std::sqrt(1.0 / 3.0), kSmooth);
  EXPECT_FALSE(LoadClock(scene).have_several());
  scene.point_loads.push_back({"tip", {1.0, 0.0, 0.0}});  // along another line
  EXPECT_EQ(turns().size(), 1u);
  scene.point_loads.pop_back();
  scene.point_loads[1].force[2] = 1e-3;
  EXPECT_TRUE(turns().empty());
  scene.point_loads[1].force[2] = 0.0;
  scene.point_loads[1].point = "middle";
  EXPECT_TRUE(turns().empty());
  scene.point_loads[1] = {"tip", {0.0, 0.5, 0.0}};
  scene.point_loads[1].amplitude = "t*1.0";
  EXPECT_TRUE(turns().empty());  // nothing is left but rounding
}

// A pulse of the second stage starts with a corner at the end of the first one, which must not know of it.
TEST(LoadClock, KeepsCornersAtTheEndsOfAStageOut) {
  Scene scene;
  scene.stages = 2;
  scene.point_loads.resize(2);
  const auto slope_at_end = [&](const std::string& formula) {
    scene.point_loads[1].amplitude = formula;
    const auto clock = std::make_shared<LoadClock>(scene);
    Amplitude amplitude(1, 2, formula);
    amplitude.follow(clock);
    clock->run(clock->pieces(1).at(0));
    return amplitude.slope(1.0);
  };
  EXPECT_EQ(slope_at_end("max(0, sin(pi*(t-1)))*(t>1)"), 0.0);
  EXPECT_NEAR(slope_at_end("2*t"), 2.0, 1e-11);
  EXPECT_GT(Amplitude(1, 2, "max(0, sin(pi*(t-1)))*(t>1)").slope(1.0), 1.0);  // without the clock
}

// Loads that cancel each other at both ends of a piece do not beyond it: t and t^2 go on at the rates that they have at
// its ends in the parameter (t + t^2) / 2: 2 and 0, 2 / 3 and 4 / 3.
TEST(LoadClock, GoesOnWhereLoadsCancel) {
  constexpr double kOfDifference = 2e-3;  // rates are those over a share of 1e-3
  Scene scene;
  scene.point_loads.resize(2);
  scene.point_loads[0].amplitude = "t";
  scene.point_loads[1].amplitude = "t^2";
  LoadClock clock(scene);
  ASSERT_EQ(clock.pieces(1).size(), 1u);
  EXPECT_FALSE(clock.pieces(1)[0].is_plain);
  LoadPiece piece = clock.pieces(1)[0];
  piece.high = 1.0;
  clock.run(piece);
  const Amplitude linear(1, 1, "t"), square(1, 1, "t^2");
  EXPECT_NEAR(clock.value(linear, -0.5), -0.5 * 2.0, kOfDifference);
  EXPECT_NEAR(clock.value(square, -0.5), 0.0, kOfDifference);
  EXPECT_NEAR(clock.value(linear, 1.5), 1.0 + 0.5 * 2.0 / 3, kOfDifference);
  EXPECT_NEAR(clock.value(square, 1.5), 1.0 + 0.5 * 4.0 / 3, kOfDifference);
}

}  // namespace
}  // namespace mixbeam
