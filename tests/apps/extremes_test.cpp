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
  expect_in(page_of("extremes", folder),
            {"# Extremes", "compiler", "| [slenderness](#slenderness) | 1 to inf | 2 of 2 |", "## Where it ends",
             "  - 1: error 2.6e-03, 1e-06 is allowed elsewhere", "## Random imperfect structures", "| column | 1 |"});
  expect_in(text_of(folder / "random_paths.csv"), {"\ncolumn,0,"});
}

TEST(Extremes, CriticalLoadsAreThoseOfTheClosedForms) {
  const auto folder = folder_for("extremes_critical");
  std::string scene = changed(text_of(with_study(2, folder)), "value=\"false\"", "value=\"true\"", "Critical Loads");
  scene = changed(changed(scene, "value=\"1\"", "value=\"0\"", "Random Structures"), "{slenderness,", "{");
  write_text(folder / "scene.xml", scene);
  EXPECT_EQ(run_program("extremes", (folder / "scene.xml").string(), folder), 0) << text_of(folder / "output.txt");
  expect_in(text_of(folder / "extremes.csv"), {"\ntruss_rise,0.01,1,", "\nrail_stiffness,1e+08,1,"});
  expect_in(page_of("extremes", folder), {"| 2 of 2 | 0 |", "| 1 of 1 | 0 |"});
}

// Twin: without a look at stability no critical point is found.
TEST(Extremes, AMissedCriticalPointIsNoticed) {
  const auto folder = folder_for("extremes_missed");
  std::string scene = changed(text_of(with_study(1, folder)), "value=\"false\"", "value=\"true\"", "Critical Loads");
  scene = changed(scene, "<ParameterList name=\"Study\">",
                  "<ParameterList name=\"Analysis\"><Parameter name=\"Stability\" "
                  "type=\"bool\" value=\"false\"/></ParameterList>\n<ParameterList name=\"Study\">");
  write_text(folder / "scene.xml", scene);
  EXPECT_EQ(run_program("extremes", (folder / "scene.xml").string(), folder), 1);
  expect_in(text_of(folder / "output.txt"), {"FAIL  truss_rise 0.01: critical load factors"});
}

/// Random imperfect structures alone, from a series of which some paths pass several critical points.
std::string random_structures(int count, double reference_step, const fs::path& folder) {
  std::string scene = text_of(with_study(1, folder));
  scene = changed(scene, "value=\"1\"", "value=\"" + std::to_string(count) + "\"", "Random Structures");
  scene = changed(scene, "value=\"0.1\"", "value=\"" + std::to_string(reference_step) + "\"", "Reference Step");
  const std::size_t sweeps = scene.find("{slenderness");
  scene.replace(sweeps, scene.find('}', sweeps) + 1 - sweeps, "{order}");
  write_text(folder / "scene.xml", scene);
  return (folder / "scene.xml").string();
}

TEST(Extremes, RandomPathsAreRightOrRefused) {
  const auto folder = folder_for("extremes_random");
  EXPECT_EQ(run_program("extremes", random_structures(60, 0.03, folder), folder), 0) << text_of(folder / "output.txt");
  const std::string table = text_of(folder / "random_paths.csv");
  constexpr int kKnown = 30;
  int right = 0;
  for (std::size_t at = table.find(",right,"); at != std::string::npos; at = table.find(",right,", at + 1)) ++right;
  EXPECT_GT(right, kKnown);
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
