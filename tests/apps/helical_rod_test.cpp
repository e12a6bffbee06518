// The rod bent to helical shape as a user runs it.
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "tests/apps/process.hpp"

namespace mixbeam {
namespace {

TEST(HelicalRodApplication, StudyPassesAndLeavesItsFiles) {
  const auto folder = folder_for("helical_rod_study");
  const auto summary = folder / "summary.json";
  EXPECT_EQ(run_program("helical_rod", "--summary " + summary.string(), folder), 0) << text_of(folder / "output.txt");
  const auto checks = nlohmann::json::parse(text_of(summary))["checks"];
  const auto printed = [](const auto& check) { return check["comparison"] == "printed digits"; };
  EXPECT_EQ(std::count_if(checks.begin(), checks.end(), printed), 24);  // four rows of three positions and three errors
  for (const char* file : {"load_displacement.csv", "single.h5", "strains_k1.csv", "strains_k4.csv", "shape_k1.csv",
                           "shape_k2.csv", "shape_k3.csv", "shape_k4.csv"})
    EXPECT_TRUE(std::filesystem::exists(folder / file)) << file;
}

// The twin: a force that is one part in a thousand too large must be noticed.
TEST(HelicalRodApplication, WrongForceFails) {
  const auto folder = folder_for("helical_rod_wrong_force");
  const std::string scene = changed_scene("helical_rod", "{0, 0, 50}", "{0, 0, 50.05}", folder);
  EXPECT_EQ(run_program("helical_rod", scene + " --single", folder), 1) << text_of(folder / "output.txt");
}

}  // namespace
}  // namespace mixbeam
