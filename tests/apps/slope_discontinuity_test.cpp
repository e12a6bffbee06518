#include "tests/apps/process.hpp"

#include <gtest/gtest.h>

namespace mixbeam {
namespace {

TEST(SlopeDiscontinuity, StudyPassesAndWritesWhatTheFiguresNeed) {
  const auto folder = folder_for("slope_discontinuity_study");
  EXPECT_EQ(run_program("slope_discontinuity", "", folder), 0) << text_of(folder / "output.txt");
  for (const char* file : {"table.csv", "load_displacement.csv", "single.h5"})
    EXPECT_TRUE(std::filesystem::exists(folder / file)) << file;
}

TEST(SlopeDiscontinuity, AnotherForceMissesThePaper) {
  const auto folder = folder_for("slope_discontinuity_other_force");
  const std::string scene = changed_scene("slope_discontinuity", "{-10, 0, -10}", "{-10, 0, -10.001}", folder);
  EXPECT_EQ(run_program("slope_discontinuity", scene, folder), 1);
  EXPECT_NE(text_of(folder / "output.txt").find("<- differs"), std::string::npos);
}

TEST(SlopeDiscontinuity, AnotherMaximumOfIterationsFailsTheRows) {
  const auto folder = folder_for("slope_discontinuity_iterations");
  const std::string study = "<ParameterList name=\"Study\">";
  const std::string scene = changed_scene(
      "slope_discontinuity", study, study + "<Parameter name=\"Most Iterations\" type=\"int\" value=\"5\"/>", folder);
  EXPECT_EQ(run_program("slope_discontinuity", scene, folder), 1);
  const std::string text = text_of(folder / "output.txt");
  EXPECT_NE(text.find("FAIL  k=1, 3 elements: Newton iterations = 1"), std::string::npos);
  EXPECT_NE(text.find(", at most 5"), std::string::npos);
}

TEST(SlopeDiscontinuity, StudyNeedsTheTip) {
  const auto folder = folder_for("slope_discontinuity_tip");
  std::string scene = text_of(std::filesystem::path(MIXBEAM_BIN_DIR) / "slope_discontinuity.xml");
  for (std::size_t place = scene.find("\"tip\""); place != std::string::npos; place = scene.find("\"tip\""))
    scene.replace(place, 5, "\"end\"");
  std::ofstream(folder / "scene.xml") << scene;
  EXPECT_EQ(run_program("slope_discontinuity", (folder / "scene.xml").string(), folder), 2);
  EXPECT_NE(text_of(folder / "output.txt").find("no point \"tip\""), std::string::npos);
}

}  // namespace
}  // namespace mixbeam
