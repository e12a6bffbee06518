/// The study of what a scene does not use: both ways of every row lead to the same answer.
#include "tests/apps/process.hpp"

#include <gtest/gtest.h>

namespace mixbeam {
namespace {

std::string small_study(const fs::path& folder, const std::string& solver = "") {
  const std::string scene = changed_scene("economies", "value=\"5000\"", "value=\"40\"", folder);
  const std::string end = "</ParameterList>\n</ParameterList>\n";
  write_text(scene, changed(text_of(scene), end,
                            "</ParameterList>\n" + solver +
                                "<ParameterList name=\"Study\"><Parameter name=\"Rounds\" type=\"int\" value=\"1\"/>"
                                "</ParameterList>\n</ParameterList>\n"));
  return scene;
}

TEST(Economies, BothWaysGiveTheSame) {
  const auto folder = folder_for("economies");
  EXPECT_EQ(run_program("economies", small_study(folder), folder), 0) << text_of(folder / "output.txt");
  expect_in(page_of("economies", folder),
            {"# Only what the scene requires", "A rod of 40 elements of order 2", "processor", "| ratio |",
             "| six stiffnesses | the same as a 6 x 6 matrix |", "- free end: "});
}

/// Twin: states that are far from converged are not the same.
TEST(Economies, DifferentAnswersAreSeen) {
  const auto folder = folder_for("economies_loose");
  const std::string loose =
      "<ParameterList name=\"Solver\"><ParameterList name=\"Newton\"><Parameter name=\"Residual Tolerance\" "
      "type=\"double\" value=\"1e-2\"/></ParameterList></ParameterList>\n";
  EXPECT_EQ(run_program("economies", small_study(folder, loose), folder), 1);
  expect_in(text_of(folder / "output.txt"), {"FAIL", "difference of the two ways"});
}

TEST(Economies, OtherScenesAreRefused) {
  const auto folder = folder_for("economies_refused");
  const std::string scene = changed_scene(
      "economies", "<ParameterList name=\"Point Loads\">",
      "<ParameterList name=\"Point Loads\"><ParameterList name=\"more\"><Parameter name=\"Point\" type=\"string\" "
      "value=\"tip\"/><Parameter name=\"Force\" type=\"Array(double)\" value=\"{0, 0, 1}\"/></ParameterList>",
      folder);
  EXPECT_EQ(run_program("economies", scene, folder), 2);
  expect_in(text_of(folder / "output.txt"), {"1 members and 2 point loads", "Scene"});
}

}  // namespace
}  // namespace mixbeam
