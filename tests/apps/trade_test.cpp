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

TEST(Trade, TinySizeConvergesAsTheorySays) {
  const auto folder = folder_for("trade_tiny");
  EXPECT_EQ(run_program("trade", few_cells(folder), folder), 0) << text_of(folder / "output.txt");
  const std::string cells = text_of(folder / "trade.csv");
  expect_in(cells,
            {"\nthick_cantilever,both reduced,1,4,converged,matrix,",
             "\nthick_cantilever,both reduced,3,32,converged,matrix,", "\nrollup,full,2,16,converged,matrix,",
             "\nslope_discontinuity,both reduced,3,16,converged,matrix,", "\ngripper,both reduced,3,2,converged,",
             "seconds_1,setup_seconds_1,processor_seconds_1,seconds_2"});
  EXPECT_EQ(cells.find("elastica"), std::string::npos) << "a benchmark that was not asked for";
  expect_in(text_of(folder / "accuracy.csv"), {"\nthick_cantilever,0.001,reached,", "\nrollup,1e-05,reached,",
                                               "\ngripper,0.001,reached,", "\ngripper,1e-05,reached,"});
  expect_in(page_of("trade", folder),
            {"# The trade", "compiler", "## Which order to take", "| thick_cantilever |", "## Asking for an accuracy",
             "| rollup | 1e-05 |", "### Scenes of the gallery", "| gripper | 1e-05 |"});
  expect_in(text_of(folder / "orders.csv"), {"\nlargest,seconds,0.01,1.0,3,3,", "\ndisplacement,flops,0.01,1.0,3,3,"});
}

TEST(Trade, MeshesTooCoarseForARateAreNoticed) {
  const auto folder = folder_for("trade_coarse");
  const std::string scene = few_cells(folder, "Study: {Elements: [1, 2], Threads: [1], Gallery: []}");
  EXPECT_EQ(run_program("trade", scene, folder), 1);
  expect_in(text_of(folder / "output.txt"), {"FAIL  thick_cantilever"});
}

// The twin: on the elements of the file no order up to 1 reaches what is asked for.
TEST(Trade, TheCheapestCellReachesTheAccuracy) {
  const auto folder = folder_for("trade_gallery");
  const std::string scene = few_cells(folder, "Study: {Benchmarks: [], Orders: [1], Threads: [1]}");
  EXPECT_EQ(run_program("trade", scene, folder), 0) << text_of(folder / "output.txt");
  expect_in(page_of("trade", folder), {"2 of 2 true errors", "| gripper | 1e-05 |", " | - | - |"});
}

TEST(Trade, ReferencesThatDisagreeAreNoticed) {
  const auto folder = folder_for("trade_references");
  const std::string scene = few_cells(folder, "Study: {Confirmation: [6, 4], Threads: [1], Gallery: []}");
  EXPECT_EQ(run_program("trade", scene, folder), 1);
  expect_in(text_of(folder / "output.txt"), {"FAIL  thick_cantilever"});
}

TEST(Trade, ReferenceIsHeldAgainstTheClosedForm) {
  const auto folder = folder_for("trade_closed_form");
  const std::string scene =
      few_cells(folder, "{Study: {Threads: [1], Gallery: []}, Expected: {tip moves up: {Value: 0.9106090249803}}}");
  EXPECT_EQ(run_program("trade", scene, folder), 1);
  expect_in(text_of(folder / "output.txt"), {"FAIL  tip moves up"});
}

}  // namespace
}  // namespace mixbeam
