// Motions keep their numbers where frequencies cross.
#include "nonlinear/stability/mode_tracks.hpp"

#include "tests/nonlinear/stability_fixture.hpp"
#include "tests/support/buckling_scenes.hpp"

#include <utility>

namespace mixbeam::test::mode_tracks_test {
namespace {

using Momenta = std::array<std::vector<double>, 2>;

VibrationMode mode(double omega, const Momenta& momenta) {
  const BeamProblem problem(column(1, 1), this_rank(), {});
  return {{0.0, problem.model.create_vector()}, {0.0, omega}, 0.0, {}, momenta};
}
std::vector<int> follow(ModeTracks& tracks, std::vector<VibrationMode> modes, const std::vector<int>& known = {}) {
  return tracks.follow(modes, known);
}

const std::vector<double> kBending{3.0, 0.1, 0.0}, kTorsion{0.0, 0.1, 2.0}, kAxial{0.0, 1.0, 0.0};

TEST(ModeTracks, FollowShapesAndNotTheOrder) {
  ModeTracks tracks;
  EXPECT_EQ(follow(tracks, {mode(1.0, {kBending}), mode(2.0, {kTorsion})}), (std::vector<int>{1, 2}));
  EXPECT_EQ(follow(tracks, {mode(1.9, {kTorsion}), mode(2.1, {kBending})}), (std::vector<int>{2, 1}));
  EXPECT_EQ(follow(tracks, {mode(1.8, {kAxial}), mode(2.2, {kBending})}), (std::vector<int>{3, 1}));    // a new one
  EXPECT_EQ(follow(tracks, {mode(1.7, {kTorsion}), mode(2.3, {kBending})}), (std::vector<int>{2, 1}));  // it is back
}

/// Its modes are any vectors of their common space.
TEST(ModeTracks, PassAStateInWhichFrequenciesCross) {
  const std::vector<double> sum{3.0, 0.2, 2.0}, difference{3.0, 0.0, -2.0};
  ModeTracks tracks, again(2);
  follow(tracks, {mode(1.0, {kBending}), mode(2.0, {kTorsion})});
  const std::vector<int> there = follow(tracks, {mode(1.5, {difference}), mode(1.5, {sum})});
  EXPECT_EQ(follow(tracks, {mode(1.4, {kTorsion}), mode(1.6, {kBending})}), (std::vector<int>{2, 1}));
  follow(again, {mode(1.0, {kBending}), mode(2.0, {kTorsion})}, {1, 2});  // resumed
  EXPECT_EQ(follow(again, {mode(1.5, {difference}), mode(1.5, {sum})}, there), there);
  EXPECT_EQ(follow(again, {mode(1.4, {kTorsion}), mode(1.6, {kBending})}), (std::vector<int>{2, 1}));
}

/// No more motions wait than there are modes, and those that left first are forgotten.
TEST(ModeTracks, ForgetWhatHasBeenAbsentForLong) {
  ModeTracks tracks;
  for (const auto& [momenta, track] :
       {std::pair{kBending, 1}, {kTorsion, 2}, {kBending, 1}, {kAxial, 3}, {kTorsion, 4}})
    EXPECT_EQ(follow(tracks, {mode(1.0, {momenta})}), std::vector<int>{track});
}

/// Whirling one way and the other, with the same real parts; any phase of a mode is the same mode.
TEST(ModeTracks, TellWaysOfWhirling) {
  const Momenta forward{{{1.0, 0.0}, {0.0, -1.0}}}, backward{{{1.0, 0.0}, {0.0, 1.0}}};
  const Momenta later{{{0.6, 0.8}, {0.8, -0.6}}};  // forward
  ModeTracks tracks;
  EXPECT_EQ(follow(tracks, {mode(1.0, backward), mode(2.0, forward)}), (std::vector<int>{1, 2}));
  EXPECT_EQ(follow(tracks, {mode(1.4, later), mode(1.6, backward)}), (std::vector<int>{2, 1}));
  // beyond a critical speed the first frequency has passed zero, and its motion seen in the frame goes round backward
  EXPECT_EQ(follow(tracks, {mode(0.3, backward), mode(2.0, backward)}), (std::vector<int>{2, 1}));
}

}  // namespace
}  // namespace mixbeam::test::mode_tracks_test
