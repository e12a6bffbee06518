#include "tests/apps/process.hpp"

#include <gtest/gtest.h>

namespace mixbeam {
namespace {

TEST(ArcSegment, StudyPassesAndWritesWhatTheFiguresNeed) {
  const auto folder = folder_for("arc_segment_study");
  EXPECT_EQ(run_program("arc_segment", "", folder), 0) << text_of(folder / "output.txt");
  for (const char* file : {"convergence.csv", "table.csv", "single_rho10.h5", "single_rho100.h5", "single_rho1000.h5"})
    EXPECT_TRUE(std::filesystem::exists(folder / file)) << file;
}

TEST(ArcSegment, AnotherForceMissesThePaper) {
  const auto folder = folder_for("arc_segment_other_force");
  const std::string scene = changed_scene("arc_segment", "{0, 0, 600}", "{0, 0, 600.01}", folder);
  EXPECT_EQ(run_program("arc_segment", scene, folder), 1);
  EXPECT_NE(text_of(folder / "output.txt").find("<- differs"), std::string::npos);
}

TEST(ArcSegment, StudyRefusesReferenceMeshThatDoesNotFit) {
  const auto folder = folder_for("arc_segment_reference");
  const std::string study =
      "<ParameterList name=\"Study\"><Parameter name=\"Reference Elements\" type=\"int\" "
      "value=\"100\"/></ParameterList>";
  const std::string scene = changed_scene("arc_segment", "<ParameterList name=\"Expected\">",
                                          study + "<ParameterList name=\"Expected\">", folder);
  EXPECT_EQ(run_program("arc_segment", scene, folder), 2);
  EXPECT_NE(text_of(folder / "output.txt").find("Reference Elements"), std::string::npos);
}

}  // namespace
}  // namespace mixbeam
