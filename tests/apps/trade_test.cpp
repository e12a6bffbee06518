// A few cells of the matrix; the whole study belongs to run.sh.
#include "mixbeam_files.hpp"

namespace mixbeam {
namespace {

/// The scene of the study with a few cells, and with `changes`.
std::string few_cells(const fs::path& folder, const std::string& changes = "") {
  const std::string few = scene_with("trade", R"yaml(Study:
  Benchmarks: [thick_cantilever, rollup, slope_discontinuity]
  Gallery: [gripper]
  Orders: [1, 2, 3]
  Elements: [4, 8, 16, 32]
  Reference: [8, 24]
  Confirmation: [6, 32]
  Accuracies: [1e-3, 1e-5]
  Threads: [1, 2]
  Repetitions: 1)yaml",
                                     folder);
  if (!changes.empty()) write_text(few, with(text_of(few), changes));
  return few;
}

class Trade : public StudyTest {};

TEST_F(Trade, TinySizeConvergesAsTheorySays) {
  expect_study(kOk, "trade", few_cells(folder_));
  const std::string cells = text("trade.csv");
  expect_in(cells,
            {"\nthick_cantilever,both reduced,1,4,converged,matrix,",
             "\nthick_cantilever,both reduced,3,32,converged,matrix,", "\nrollup,full,2,16,converged,matrix,",
             "\nslope_discontinuity,both reduced,3,16,converged,matrix,", "\ngripper,both reduced,3,2,converged,",
             "seconds_1,setup_seconds_1,processor_seconds_1,seconds_2"});
  EXPECT_EQ(cells.find("elastica"), std::string::npos) << "a benchmark that was not asked for";
  expect_in(text("accuracy.csv"), {"\nthick_cantilever,0.001,reached,", "\nrollup,1e-05,reached,",
                                   "\ngripper,0.001,reached,", "\ngripper,1e-05,reached,"});
  expect_in(page_of("trade", folder_),
            {"# The trade", "compiler", "## Which order to take", "| thick_cantilever |", "## Asking for an accuracy",
             "| rollup | 1e-05 |", "### Scenes of the gallery", "| gripper | 1e-05 |"});
  expect_in(text("orders.csv"), {"\nlargest,seconds,0.01,1.0,3,3,", "\ndisplacement,flops,0.01,1.0,3,3,"});
}

TEST_F(Trade, MeshesTooCoarseForARateAreNoticed) {
  const std::string scene = few_cells(folder_, "Study: {Elements: [1, 2], Threads: [1], Gallery: []}");
  expect_study(kCheckFailed, "trade", scene, {"FAIL  thick_cantilever"});
}

// The twin: on the elements of the file no order up to 1 reaches what is asked for.
TEST_F(Trade, TheCheapestCellReachesTheAccuracy) {
  const std::string scene = few_cells(folder_, "Study: {Benchmarks: [], Orders: [1], Threads: [1]}");
  expect_study(kOk, "trade", scene);
  expect_in(page_of("trade", folder_), {"2 of 2 true errors", "| gripper | 1e-05 |", " | - | - |"});
}

TEST_F(Trade, ReferencesThatDisagreeAreNoticed) {
  const std::string scene = few_cells(folder_, "Study: {Confirmation: [6, 4], Threads: [1], Gallery: []}");
  expect_study(kCheckFailed, "trade", scene, {"FAIL  thick_cantilever"});
}

TEST_F(Trade, ReferenceIsHeldAgainstTheClosedForm) {
  const std::string scene =
      few_cells(folder_, "{Study: {Threads: [1], Gallery: []}, Expected: {tip moves up: {Value: 0.9106090249803}}}");
  expect_study(kCheckFailed, "trade", scene, {"FAIL  tip moves up"});
}

}  // namespace
}  // namespace mixbeam
