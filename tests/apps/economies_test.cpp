/// The study of what a scene does not use: both ways of every row lead to the same answer.
#include "mixbeam_files.hpp"

namespace mixbeam {
namespace {

std::string small_study(const fs::path& folder, const std::string& solver = "") {
  const std::string few =
      scene_with("economies", "{Study: {Rounds: 1}, Scene: {Members: {rod: {Elements: 40}}}}", folder);
  if (!solver.empty()) write_text(few, with(text_of(few), solver));
  return few;
}

TEST(Economies, BothWaysGiveTheSame) {
  const auto folder = folder_for("economies");
  EXPECT_EQ(run_program("economies", small_study(folder), folder), 0) << text_of(folder / "output.txt");
  expect_in(page_of("economies", folder),
            {"# Only what the scene requires", "A rod of 40 elements of order 2", "processor", "| ratio |",
             "| one section | taper to the same section |", "- free end: "});
}

/// Twin: states that are far from converged are not the same.
TEST(Economies, DifferentAnswersAreSeen) {
  const auto folder = folder_for("economies_loose");
  const std::string loose = "Solver: {Newton: {Residual Tolerance: 1e-2}}";
  EXPECT_EQ(run_program("economies", small_study(folder, loose), folder), 1);
  expect_in(text_of(folder / "output.txt"), {"FAIL", "difference of the two ways"});
}

TEST(Economies, OtherScenesAreRefused) {
  const auto folder = folder_for("economies_refused");
  const std::string scene =
      scene_with("economies", "Scene: {Point Loads: {more: {Point: tip, Force: [0, 0, 1]}}}", folder);
  EXPECT_EQ(run_program("economies", scene, folder), 2);
  expect_in(text_of(folder / "output.txt"), {"1 members and 2 point loads", "Scene"});
}

}  // namespace
}  // namespace mixbeam
