#include "tests/apps/process.hpp"

#include <gtest/gtest.h>

namespace mixbeam {
namespace {

TEST(Rollup, StudyPassesAndWritesWhatTheFiguresNeed) {
  const auto folder = folder_for("rollup_study");
  EXPECT_EQ(run_program("rollup", "", folder), 0) << text_of(folder / "output.txt");
  EXPECT_TRUE(std::filesystem::exists(folder / "convergence.csv"));
  EXPECT_TRUE(std::filesystem::exists(folder / "single.h5"));
}

TEST(Rollup, AnotherMomentMissesTheExpectedTip) {
  const auto folder = folder_for("rollup_other_moment");
  const std::string scene = changed_scene("rollup", "12.566370614359172", "12.566370615", folder);
  EXPECT_EQ(run_program("rollup", scene + " --single", folder), 1);
}

TEST(Rollup, StudyRefusesASceneThatIsNoPureBending) {
  const auto folder = folder_for("rollup_force");
  const std::string scene =
      changed_scene("rollup", "name=\"Moment\"", "name=\"Force\"", folder);  // a force out of the plane
  EXPECT_EQ(run_program("rollup", scene, folder), 2);
  EXPECT_NE(text_of(folder / "output.txt").find("moment about z"), std::string::npos);
}

}  // namespace
}  // namespace mixbeam
