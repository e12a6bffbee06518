// The superimposed rotation as a user runs it.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/apps/process.hpp"

namespace mixbeam {
namespace {

TEST(SuperimposedRotationApplication, StudyPassesAndLeavesItsFiles) {
  const auto folder = folder_for("superimposed_rotation_study");
  EXPECT_EQ(run_program("superimposed_rotation", "", folder), 0) << text_of(folder / "output.txt");
  EXPECT_TRUE(std::filesystem::exists(folder / "single.h5"));
  const std::string deviations = text_of(folder / "deviation.csv");
  EXPECT_EQ(std::count(deviations.begin(), deviations.end(), '\n'), 1 + 1 + 71);  // header, bent state, increments
}

// The twin: a small force that keeps its direction does not turn with the rod, and the comparison must show it.
TEST(SuperimposedRotationApplication, LoadThatDoesNotTurnFails) {
  const auto folder = folder_for("superimposed_rotation_dead_load");
  const std::string loads = R"(<ParameterList name="Point Loads">)";
  const std::string scene = changed_scene("superimposed_rotation", loads, loads + R"xml(
      <ParameterList name="weight">
        <Parameter name="Point" type="string" value="tip"/>
        <Parameter name="Force" type="Array(double)" value="{1e-6, 0, 0}"/>
      </ParameterList>)xml",
                                          folder);
  EXPECT_EQ(run_program("superimposed_rotation", scene + " --single", folder), 1);
  const std::string text = text_of(folder / "output.txt");
  EXPECT_NE(text.find("FAIL  scene: change of u3(L) / L"), std::string::npos) << text;
  EXPECT_NE(text.find("FAIL  scene: farthest vertex after turning back"), std::string::npos) << text;
}

}  // namespace
}  // namespace mixbeam
