// A few values of the sweeps; the whole study belongs to run.sh.
#include "mixbeam_files.hpp"

namespace mixbeam {
namespace {

/// The scene with a study of this many values of each sweep.
std::string with_study(int most_values, const fs::path& folder, const std::string& more = "") {
  const std::string few = with(scene_of("extremes"), R"yaml(Study:
  Most Elements: 100
  Critical Loads: false
  Random Structures: 1
  Reference Step: 0.1
  Sweeps: [slenderness, stiffness_ratio, unit_of_length, unit_of_force, elements, element_turn, angle, tip_force, order]
  Most Values: )yaml" + std::to_string(most_values));
  write_text(folder / "scene.xml", more.empty() ? few : with(few, more));
  return (folder / "scene.xml").string();
}

class Extremes : public StudyTest {};

TEST_F(Extremes, EndsOfTheSweepsKeepTheirPromise) {
  expect_study(kOk, "extremes", with_study(2, folder_));
  const std::string table = text("extremes.csv");
  expect_in(table, {"\nslenderness,1,1,", "\nslenderness,inf,1,", "\nunit_of_length,1e-09,1,", "\ntip_force,1e+08,1,",
                    "\nangle,0,1,", "\norder,8,1,"});
  expect_in(page_of("extremes", folder_),
            {"# Extremes", "compiler", "| [slenderness](#slenderness) | 1 to inf | 2 of 2 |", "## Where it ends",
             "  - 1: error 2.6e-03, 1e-06 is allowed elsewhere", "## Random imperfect structures", "| column | 1 |"});
  expect_in(text("random_paths.csv"), {"\ncolumn,0,"});
}

TEST_F(Extremes, CriticalLoadsAreThoseOfTheClosedForms) {
  const std::string scene = with_study(2, folder_, R"yaml(Study:
  Critical Loads: true
  Random Structures: 0
  Sweeps: [stiffness_ratio, unit_of_length, unit_of_force, elements, element_turn, angle, tip_force, order])yaml");
  expect_study(kOk, "extremes", scene);
  expect_in(text("extremes.csv"), {"\ntruss_rise,0.01,1,", "\nrail_stiffness,1e+08,1,"});
  expect_in(page_of("extremes", folder_), {"| 2 of 2 | 0 |", "| 1 of 1 | 0 |"});
}

// Twin: without a look at stability no critical point is found.
TEST_F(Extremes, AMissedCriticalPointIsNoticed) {
  const std::string scene = with_study(1, folder_, "{Study: {Critical Loads: true}, Analysis: {Stability: false}}");
  expect_study(kCheckFailed, "extremes", scene, {"FAIL  truss_rise 0.01: critical load factors"});
}

/// Random imperfect structures alone, from a series of which some paths pass several critical points.
std::string random_structures(int count, double reference_step, const fs::path& folder) {
  return with_study(1, folder,
                    "Study: {Random Structures: " + std::to_string(count) +
                        ", Reference Step: " + std::to_string(reference_step) + ", Sweeps: [order]}");
}

TEST_F(Extremes, RandomPathsAreRightOrRefused) {
  expect_study(kOk, "extremes", random_structures(60, 0.03, folder_));
  const std::string table = text("random_paths.csv");
  constexpr int kKnown = 30;
  int right = 0;
  for (std::size_t at = table.find(",right,"); at != std::string::npos; at = table.find(",right,", at + 1)) ++right;
  EXPECT_GT(right, kKnown);
}

TEST_F(Extremes, CoarseMeshBreaksThePromise) {
  const std::string scene = with_study(1, folder_, "Scene: {Members: {rod: {Order: 1}}}");
  expect_study(kCheckFailed, "extremes", scene, {"FAIL  slenderness 1: error of the tip"});
}

TEST_F(Extremes, WrongExpectedValueIsNoticed) {
  expect_study(kOk, "extremes", "--single");
  const std::string scene = scene_with("extremes", "Expected: {tip moves back: {Value: -0.5549955978638}}", folder_);
  expect_study(kCheckFailed, "extremes", scene + " --single");
}

TEST_F(Extremes, StudyRefusesAnotherScene) {
  const std::string scene = scene_with("extremes", "Scene: {Sections: {rod: {EI3: 2}}}", folder_);
  expect_study(kBadInput, "extremes", scene, {"EI2 = EI3"});
}

}  // namespace
}  // namespace mixbeam
