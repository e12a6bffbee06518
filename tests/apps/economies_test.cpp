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

class Economies : public StudyTest {};

TEST_F(Economies, BothWaysGiveTheSame) {
  expect_study(kOk, "economies", small_study(folder_));
  expect_in(page_of("economies", folder_),
            {"# Only what the scene requires", "A rod of 40 elements of order 2", "processor", "| ratio |",
             "| one section | taper to the same section |", "- free end: "});
}

/// Twin: states that are far from converged are not the same.
TEST_F(Economies, DifferentAnswersAreSeen) {
  const std::string loose = "Solver: {Newton: {Residual Tolerance: 1e-2}}";
  expect_study(kCheckFailed, "economies", small_study(folder_, loose), {"FAIL", "difference of the two ways"});
}

TEST_F(Economies, OtherScenesAreRefused) {
  const std::string scene =
      scene_with("economies", "Scene: {Point Loads: {more: {Point: tip, Force: [0, 0, 1]}}}", folder_);
  expect_study(kBadInput, "economies", scene, {"1 members and 2 point loads", "Scene"});
}

}  // namespace
}  // namespace mixbeam
