// The helix experiment as a user runs it.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/apps/process.hpp"

namespace mixbeam {
namespace {

TEST(HelixApplication, StudyPassesAndLeavesItsFiles) {
  const auto folder = folder_for("helix_study");
  const auto summary = folder / "summary.json";
  EXPECT_EQ(run_program("helix", "--summary " + summary.string(), folder), 0) << text_of(folder / "output.txt");
  EXPECT_GT(nlohmann::json::parse(text_of(summary))["checks"].size(), 100u);
  for (const char* file : {"convergence.csv", "order1.h5", "order3.h5"})
    EXPECT_TRUE(std::filesystem::exists(folder / file)) << file;
}

// The twin: a moment that is wrong in its tenth digit must be noticed.
TEST(HelixApplication, WrongMomentFails) {
  const auto folder = folder_for("helix_wrong_moment");
  const std::string scene = changed_scene("helix", "56.41517395535222", "56.41517396", folder);
  EXPECT_EQ(run_program("helix", scene + " --single", folder), 1) << text_of(folder / "output.txt");
}

TEST(HelixApplication, StudyOfAnotherStructureIsRefused) {
  const auto folder = folder_for("helix_two_rods");
  const std::string members = R"(<ParameterList name="Members">)";
  const std::string scene = changed_scene("helix", members, members + R"xml(
      <ParameterList name="second">
        <Parameter name="Start" type="string" value="clamp"/>
        <Parameter name="End" type="string" value="tip"/>
        <Parameter name="Section" type="string" value="circle"/>
      </ParameterList>)xml",
                                          folder);
  EXPECT_EQ(run_program("helix", scene, folder), 2);
  const std::string text = text_of(folder / "output.txt");
  EXPECT_NE(text.find("one member"), std::string::npos) << text;
}

}  // namespace
}  // namespace mixbeam
