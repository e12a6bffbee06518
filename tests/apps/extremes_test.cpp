// A few values of the sweeps; the whole study belongs to run.sh.
#include "tests/apps/process.hpp"

#include <gtest/gtest.h>

namespace mixbeam {
namespace {

/// The scene with a study of this many values of each sweep.
std::string with_study(int most_values, const fs::path& folder) {
  return changed_scene("extremes", "<Parameter name=\"Random Structures\" type=\"int\" value=\"24\"/>\n",
                       "<Parameter name=\"Most Elements\" type=\"int\" value=\"100\"/>\n"
                       "<Parameter name=\"Critical Loads\" type=\"bool\" value=\"false\"/>\n"
                       "<Parameter name=\"Random Structures\" type=\"int\" value=\"1\"/>\n"
                       "<Parameter name=\"Reference Step\" type=\"double\" value=\"0.1\"/>\n"
                       "<Parameter name=\"Most Values\" type=\"int\" value=\"" +
                           std::to_string(most_values) +
                           "\"/>\n"
                           "<Parameter name=\"Sweeps\" type=\"Array(string)\" value=\"{slenderness, stiffness_ratio, "
                           "unit_of_length, unit_of_force, elements, element_turn, angle, tip_force, order}\"/>\n",
                       folder);
}

TEST(Extremes, EndsOfTheSweepsKeepTheirPromise) {
  const auto folder = folder_for("extremes_ends");
  EXPECT_EQ(run_program("extremes", with_study(2, folder), folder), 0) << text_of(folder / "output.txt");
  const std::string table = text_of(folder / "extremes.csv");
  expect_in(table, {"\nslenderness,1,1,", "\nslenderness,inf,1,", "\nunit_of_length,1e-09,1,", "\ntip_force,1e+08,1,",
                    "\nangle,0,1,", "\norder,8,1,"});
  expect_in(text_of(folder / "extremes.md"),
            {"# Extremes", "compiler", "| [slenderness](#slenderness) | 1 to inf | 2 of 2 |", "## Where it ends",
             "## Random imperfect structures", "| column | 1 |"});
  expect_in(text_of(folder / "random_paths.csv"), {"\n0,column,"});
}

TEST(Extremes, CoarseMeshBreaksThePromise) {
  const auto folder = folder_for("extremes_coarse");
  const std::string scene = with_study(1, folder);
  write_text(scene, changed(text_of(scene), "value=\"8\"", "value=\"1\"", "\"Order\""));
  EXPECT_EQ(run_program("extremes", scene, folder), 1);
  expect_in(text_of(folder / "output.txt"), {"FAIL  slenderness 1: error of the tip"});
}

TEST(Extremes, WrongExpectedValueIsNoticed) {
  const auto folder = folder_for("extremes_expected");
  EXPECT_EQ(run_program("extremes", "--single", folder), 0) << text_of(folder / "output.txt");
  const std::string scene = changed_scene("extremes", "-0.5549955977538", "-0.5549955978638", folder);
  EXPECT_EQ(run_program("extremes", scene + " --single", folder), 1);
}

TEST(Extremes, StudyRefusesAnotherScene) {
  const auto folder = folder_for("extremes_another");
  const std::string scene = changed_scene("extremes", "name=\"EI3\" type=\"double\" value=\"1\"",
                                          "name=\"EI3\" type=\"double\" value=\"2\"", folder);
  EXPECT_EQ(run_program("extremes", scene, folder), 2);
  expect_in(text_of(folder / "output.txt"), {"EI2 = EI3"});
}

}  // namespace
}  // namespace mixbeam
