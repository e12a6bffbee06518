#include "tests/apps/process.hpp"

#include <gtest/gtest.h>

namespace mixbeam {
namespace {

TEST(Fork, StudyPassesAndWritesWhatTheFiguresNeed) {
  const auto folder = folder_for("fork_study");
  EXPECT_EQ(run_program("fork", "", folder), 0) << text_of(folder / "output.txt");
  for (const char* file : {"table.csv", "convergence.csv", "load_displacement.csv", "single.h5"})
    EXPECT_TRUE(std::filesystem::exists(folder / file)) << file;
}

TEST(Fork, ForcesThatAreNoCoupleAreNotMirrored) {
  const auto folder = folder_for("fork_other_force");
  const std::string scene = changed_scene("fork", "{0, 0, -200}", "{0, 0, -200.001}", folder);
  EXPECT_EQ(run_program("fork", scene, folder), 1);
  EXPECT_NE(text_of(folder / "output.txt").find("FAIL  loads in reverse order: one path and the mirror image"),
            std::string::npos);
}

TEST(Fork, StudyRefusesScenesAndMeshesThatDoNotFit) {
  const auto folder = folder_for("fork_refused");
  const std::string one_stage = changed_scene("fork", "name=\"Stage\" type=\"int\" value=\"2\"",
                                              "name=\"Stage\" type=\"int\" value=\"1\"", folder);
  EXPECT_EQ(run_program("fork", one_stage, folder), 2);
  const std::string study = "<ParameterList name=\"Study\">";
  const std::string mesh = changed_scene(
      "fork", study,
      study + "<Parameter name=\"Convergence Elements per Member\" type=\"Array(int)\" value=\"{3, 5}\"/>", folder);
  EXPECT_EQ(run_program("fork", mesh, folder), 2);
  EXPECT_NE(text_of(folder / "output.txt").find("value 5; allowed: divisors of 384"), std::string::npos);
}

}  // namespace
}  // namespace mixbeam
