// The table by which a step is judged, line by line: what decides, on which side of its threshold, and what follows.
#include "nonlinear/path/step_judge.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <vector>

namespace mixbeam::test::step_judge_test {
namespace {

/// Beside a threshold, as a share of it.
constexpr double kBeside = 1e-6;

struct Case {
  Consequence consequence;
  std::function<void(StepSigns&)> change;  ///< of the signs of a straight step that was seen half-way
  StepTest test = kLoadStep;
};

/// A straight step of the load, on which nothing is found half-way either.
StepSigns plain_step() {
  StepSigns signs;
  signs.first = signs.last = signs.least = 1.0;
  signs.looks = 1;
  return signs;
}

/// In the order of the table.
std::vector<Case> cases() {
  using S = StepSigns;
  const double nan = std::nan("");
  return {
      {Consequence::refuse, [](S& s) { s.counts_change = true; }},
      {Consequence::halve, [](S& s) { s.inverts = true; }},
      {Consequence::accept, [](S& s) { s.has_tangents = false; }},
      {Consequence::accept, [](S& s) { s.motion = 0.0; }},
      {Consequence::refuse, [](S& s) { s.motion = 0.0, s.loads_move = true; }},
      {Consequence::refuse, [nan](S& s) { s.loads_turn = true, s.turn_cosine = nan; }},
      {Consequence::refuse, [](S& s) { s.loads_turn = true, s.turn_cosine = 0.9; }},
      {Consequence::accept, [](S& s) { s.loads_turn = true; }},
      {Consequence::accept, [](S& s) { s.first = s.last = -1.0, s.is_straight = true; }},
      {Consequence::refuse, [](S& s) { s.first = 0.4; }},
      {Consequence::refuse, [](S& s) { s.last = 0.8; }, kPathStep},
      {Consequence::halve, [](S& s) { s.last = 0.4; }},
      {Consequence::accept, [](S& s) { s.looks = 0; }},
      {Consequence::look, [](S& s) { s.looks = 0, s.least = 0.9; }},
      {Consequence::look_closer, [](S& s) { s.goes_back = true; }},
      {Consequence::halve, [](S& s) { s.correction = 0.3; }},
      {Consequence::halve, [](S& s) { s.looks = 2, s.count_outside = true; }},
      {Consequence::accept, [](S& s) { s.turns = s.turns_unseen = s.is_flat = s.counts_agree = true; }},
      {Consequence::refuse, [](S& s) { s.turns = s.turns_unseen = true; }},
      {Consequence::accept, [](S& s) { s.dips = s.is_last = true; }},
      {Consequence::refuse, [](S& s) { s.looks = 2, s.goes_back = true; }},
      {Consequence::halve, [](S& s) { s.dips = true; }},
      {Consequence::accept, [](S&) {}},
      {Consequence::halve, [](S& s) { s.rate_error = 2.0, s.least_gain = 1.0; }, kTracedStep},
      {Consequence::look_aside, [](S& s) { s.looks = 3; }, kTracedStep},
      {Consequence::accept, [](S& s) { s.looks = 4; }, kTracedStep},
  };
}

TEST(StepJudge, TableLineByLine) {
  const std::vector<JudgeLine>& table = judge_table();
  const std::vector<Case> all = cases();
  ASSERT_EQ(all.size(), table.size());
  for (size_t i = 0; i < table.size(); ++i) {
    StepSigns signs = plain_step();
    all[i].change(signs);
    const JudgeLine& line = deciding_line(signs, all[i].test);
    EXPECT_EQ(&line - table.data(), static_cast<ptrdiff_t>(i));
    EXPECT_EQ(line.consequence, all[i].consequence) << "line " << i;
    EXPECT_EQ(*line.objection != '\0', line.consequence == Consequence::refuse) << "line " << i;
    if (line.sign == nullptr) continue;
    // beside its threshold it decides on one side alone
    const double threshold = line.threshold(signs, all[i].test);
    const bool is_upper = line.side == JudgeLine::Side::above || line.side == JudgeLine::Side::at_least;
    for (const double share : {1.0 - kBeside, 1.0 + kBeside}) {
      signs.*line.sign = share * threshold;
      EXPECT_EQ(&deciding_line(signs, all[i].test) == &line, (share > 1.0) == is_upper) << "line " << i;
    }
  }
}

TEST(StepJudge, ThresholdsOfTheTable) {
  // cosines of 14 and 60 degrees, as theory (57) and (58) have them; a correction of a fifth of the chord
  const StepSigns none;
  std::vector<double> found;
  for (const JudgeLine& line : judge_table())
    if (line.sign != nullptr && line.sign != &StepSigns::rate_error) found.push_back(line.threshold(none, kLoadStep));
  const std::vector<double> expected = {1e-12, 1e-12, 0.97, 0.5, -0.5, 0.5, 0.97, 1e-2, 0.2, 1e-2};
  EXPECT_EQ(found, expected);
}

/// What is not a number passes for no step: a tangent without a direction, a correction that could not be computed.
TEST(StepJudge, NotANumberIsNoStep) {
  for (double StepSigns::*sign : {&StepSigns::first, &StepSigns::last, &StepSigns::correction}) {
    StepSigns signs = plain_step();
    EXPECT_EQ(deciding_line(signs, kLoadStep).consequence, Consequence::accept);
    signs.*sign = std::nan("");
    EXPECT_NE(deciding_line(signs, kLoadStep).consequence, Consequence::accept);
  }
}

}  // namespace
}  // namespace mixbeam::test::step_judge_test
