// A few cells of the matrix; the whole study belongs to run.sh.
#include "tests/apps/process.hpp"

#include <gtest/gtest.h>

namespace mixbeam {
namespace {

/// The scene of the study with these parameters.
std::string trade_scene(const std::string& parameters, const fs::path& folder) {
  const std::string end = "</ParameterList>\n</ParameterList>\n";
  return changed_scene("trade", end, "</ParameterList>\n  <ParameterList name=\"Study\">\n" + parameters + "  " + end,
                       folder);
}

constexpr const char* kFewCells = R"xml(
    <Parameter name="Benchmarks" type="Array(string)" value="{thick_cantilever, rollup, slope_discontinuity}"/>
    <Parameter name="Gallery" type="Array(string)" value="{gripper}"/>
    <Parameter name="Orders" type="Array(int)" value="{1, 2, 3}"/>
    <Parameter name="Elements" type="Array(int)" value="{4, 8, 16, 32}"/>
    <Parameter name="Reference" type="Array(int)" value="{8, 24}"/>
    <Parameter name="Confirmation" type="Array(int)" value="{6, 32}"/>
    <Parameter name="Accuracies" type="Array(double)" value="{1e-3, 1e-5}"/>
    <Parameter name="Threads" type="Array(int)" value="{1, 2}"/>
    <Parameter name="Repetitions" type="int" value="1"/>
)xml";

/// Fewer runs where they are not what is tested.
std::string one_thread(const std::string& study) {
  return changed(changed(study, "{1, 2}", "{1}", "Threads"), "{gripper}", "{}");
}

TEST(Trade, TinySizeConvergesAsTheorySays) {
  const auto folder = folder_for("trade_tiny");
  EXPECT_EQ(run_program("trade", trade_scene(kFewCells, folder), folder), 0) << text_of(folder / "output.txt");
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
  const std::string study = one_thread(changed(kFewCells, "{4, 8, 16, 32}", "{1, 2}"));
  EXPECT_EQ(run_program("trade", trade_scene(study, folder), folder), 1);
  expect_in(text_of(folder / "output.txt"), {"FAIL  thick_cantilever k=3: rate of the centerline"});
}

// The twin: on the elements of the file no order up to 1 reaches what is asked for.
TEST(Trade, TheCheapestCellReachesTheAccuracy) {
  const auto folder = folder_for("trade_gallery");
  std::string study = changed(kFewCells, "{thick_cantilever, rollup, slope_discontinuity}", "{}");
  study = changed(changed(study, "{1, 2, 3}", "{1}"), "{1, 2}", "{1}", "Threads");
  EXPECT_EQ(run_program("trade", trade_scene(study, folder), folder), 0) << text_of(folder / "output.txt");
  expect_in(page_of("trade", folder), {"2 of 2 true errors", "| gripper | 1e-05 |", " | - | - |"});
}

TEST(Trade, ReferencesThatDisagreeAreNoticed) {
  const auto folder = folder_for("trade_references");
  const std::string study = one_thread(changed(kFewCells, "{6, 32}", "{6, 4}"));
  EXPECT_EQ(run_program("trade", trade_scene(study, folder), folder), 1);
  expect_in(text_of(folder / "output.txt"), {"FAIL  thick_cantilever: difference of the references"});
}

TEST(Trade, ReferenceIsHeldAgainstTheClosedForm) {
  const auto folder = folder_for("trade_closed_form");
  const std::string scene = trade_scene(one_thread(kFewCells), folder);
  write_text(scene, changed(text_of(scene), "0.9106090248803", "0.9106090249803"));
  EXPECT_EQ(run_program("trade", scene, folder), 1);
  expect_in(text_of(folder / "output.txt"), {"FAIL  tip moves up"});
}

}  // namespace
}  // namespace mixbeam
