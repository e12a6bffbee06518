/// The verification table is what the summaries say, failures included.
#include "apps/common/run/summary.hpp"
#include "process.hpp"

#include <cmath>

namespace mixbeam::verification_table_test {
namespace {

const fs::path kPython = "/usr/bin/python3";

class VerificationTable : public ::testing::Test {
 protected:
  /// A summary of `benchmark` with two good values and one that the caller chooses; its reference is "0.500", +-1.
  void write_summary(const std::string& benchmark, double value) {
    Summary summary;
    summary.program = benchmark;
    summary.version = "1.2";
    summary.compiler = "some compiler";
    summary.check_printed_digits("k=1, 4 elements: u1", 0.1004, "0.100", "a table");
    summary.check_printed_digits("k=2, 16 elements: u2", value, "0.500", "a table");
    summary.check_upper_bound("k=2: Newton iterations", 9, 11, "a goal");
    fs::create_directories(folder_ / "results" / benchmark);
    summary.write_json(folder_ / "results" / benchmark / "summary.json");
  }

  void write_all_summaries() {
    for (const char* benchmark : {"rollup", "superimposed_rotation", "arc_segment", "helix", "helical_rod",
                                  "slope_discontinuity", "fork", "extremes"})
      write_summary(benchmark, 0.501);
    for (const char* group : {"verification", "gallery"}) write_scene_summary(group, "a scene", 2.0);
  }

  /// A summary as `mixbeam run` writes it: one value in two load cases, expected 2 +-1e-8, and a balance below `bound`.
  void write_scene_summary(const std::string& group, const std::string& scene, double value, double bound = 1e-10) {
    Summary summary;
    summary.program = "mixbeam";
    summary.version = "1.2";
    summary.check_relative("tip, wind", 2.0, 2.0, 1e-8, "a formula");
    summary.check_relative("tip, snow", value, 2.0, 1e-8, "a formula");
    summary.check_upper_bound(scene + "-snow: balance, sum of forces", 3e-16, bound, "equilibrium");
    summary.check_upper_bound(scene + "-snow: balance, sum of moments", 2e-16, bound, "equilibrium");
    fs::create_directories(folder_ / "results" / group / scene);
    summary.write_json(folder_ / "results" / group / scene / "summary.json");
  }

  Ended table(const std::vector<std::string>& options = {}) {
    const std::string script = (fs::path(MIXBEAM_BIN_DIR) / "plots" / "verification_table.py").string();
    std::vector<std::string> arguments = {script, (folder_ / "results").string()};
    arguments.insert(arguments.end(), options.begin(), options.end());
    return run_process(kPython, arguments, folder_);
  }

  TemporaryFolder folder_;
};

TEST_F(VerificationTable, WordsAreTheSameOrNot) {
  for (const std::string word : {"true", "false"}) {
    Summary summary;
    summary.program = "rollup";
    summary.version = "1.2";
    summary.check_word("end", word, "true", "Euler");
    summary.write_json(folder_ / "summary.json");
    fs::create_directories(folder_ / "results" / "rollup");
    fs::copy(folder_ / "summary.json", folder_ / "results" / "rollup", fs::copy_options::overwrite_existing);
    const Ended ended = table({"--markdown"});
    if (word == "true")
      expect_in(ended.out, {"| rollup | end | 1 | none | the same word | yes | Euler |"});
    else
      expect_in(ended.out, {"| rollup | end | 1 | another word, or none | the same word | **NO** | Euler |"});
  }
}

TEST_F(VerificationTable, GroupsWhatBelongsTogether) {
  write_summary("rollup", 0.501);
  const Ended ended = table({"--markdown"});
  EXPECT_EQ(ended.exit_code, 0) << ended.err;
  expect_in(ended.out, {"| rollup | k=1 and 2, 4 and 16 elements: u1 and 2 | 2 | 1 in the last digit | 1 in the last "
                        "digit | yes | a table |",
                        "| rollup | k=2: Newton iterations | 1 | 9 | at most 11 | yes | a goal |",
                        "3 of 3 values agree; version 1.2, some compiler"});
}

TEST_F(VerificationTable, ShowsWhatFailed) {
  write_summary("rollup", 0.502);
  write_summary("fork", std::nan(""));
  const Ended ended = table({"--markdown"});
  expect_in(ended.out, {"u1 and 2 | 2 | 2 in the last digit | 1 in the last digit | **NO** |",
                        "u1 and 2 | 2 | not a number | 1 in the last digit | **NO** |", "4 of 6 values agree"});
  expect_in(table().out, {"NO", "not a number", "4 of 6 values agree"});
}

TEST_F(VerificationTable, HasScenesOfTheProgram) {
  write_scene_summary("verification", "arch", 2.0);
  write_scene_summary("verification", "column", 2.0 + 2e-7);
  expect_in(table({"--markdown"}).out,
            {"| verification/arch | tip | 2 | 0 | 1e-08 of the value | yes | a formula |",
             "| verification/column | tip | 2 | 1e-07 | 1e-08 of the value | **NO** |",
             "| verification | balance: sum of forces, sum of moments | 4 | 3e-16 | at most 1e-10 | yes | equilibrium",
             "7 of 8 values agree"});
}

/// Bounds that differ by rounding are one row; others are one too, which tells both.
TEST_F(VerificationTable, ABalanceIsOneRow) {
  write_scene_summary("gallery", "arch", 2.0, 1.000035527136788e-10);
  write_scene_summary("gallery", "column", 2.0, 1.000106581410364e-10);
  expect_in(table({"--markdown"}).out,
            {"| gallery | balance: sum of forces, sum of moments | 4 | 3e-16 | at most 1e-10 |"});
  write_scene_summary("gallery", "honeycomb", 2.0, 1.3906e-10);
  expect_in(table({"--markdown"}).out,
            {"| gallery | balance: sum of forces, sum of moments | 6 | 3e-16 | at most 1e-10 to 1.39e-10 |"});
}

TEST_F(VerificationTable, RoundsBoundsAndRangesButNoCounts) {
  Summary summary;
  summary.program = "rollup";
  summary.version = "1.2";
  for (const char* angle : {"0", "0.1998335828876", "0.199833582888"})
    summary.check_upper_bound(std::string("angle ") + angle + ": error", 1e-14, 1.23456e-13, "a circle");
  summary.check_upper_bound("iterations", 1500, 1600, "a goal");
  fs::create_directories(folder_ / "results" / "rollup");
  summary.write_json(folder_ / "results" / "rollup" / "summary.json");
  expect_in(table({"--markdown"}).out, {"| rollup | angle 0..0.2: error | 3 | 1e-14 | at most 1.23e-13 |",
                                        "| rollup | iterations | 1 | 1500 | at most 1600 |"});
}

TEST_F(VerificationTable, ReplacesWhatStandsBetweenItsMarkers) {
  const fs::path page = folder_ / "verification.md";
  const std::string before = "text\n<!-- verification:begin -->", after = "<!-- verification:end -->\nmore\n";
  write_text(page, before + "\nold\n" + after);
  write_summary("rollup", 0.501);
  const Ended incomplete = table({"--update", page.string()});
  EXPECT_EQ(incomplete.exit_code, 1);
  expect_in(incomplete.err, {"verification.md is left as it is", "no results of superimposed_rotation, arc_segment",
                             "fork, extremes, verification, gallery"});
  EXPECT_EQ(text_of(page), before + "\nold\n" + after);

  write_all_summaries();
  EXPECT_EQ(table({"--update", page.string()}).exit_code, 0);
  const std::string updated = text_of(page);
  EXPECT_EQ(updated.rfind(before + "\n| benchmark | quantity |", 0), 0U) << updated;
  expect_in(updated, {"32 of 32 values agree", "\n" + after});
  EXPECT_EQ(updated.find("old"), std::string::npos);
  EXPECT_EQ(table({"--update", page.string()}).exit_code, 0);
  EXPECT_EQ(text_of(page), updated);  // a second time changes nothing
}

/// What run.sh computes only when it is named is not asked for, and shown where it is there.
TEST_F(VerificationTable, ShowsStudiesOfCostWhereTheyWereMade) {
  write_all_summaries();
  EXPECT_EQ(table({"--markdown"}).out.find("| trade |"), std::string::npos);
  write_summary("trade", 0.501);
  expect_in(table({"--markdown"}).out, {"| trade |", "35 of 35 values agree"});
}

TEST_F(VerificationTable, SaysWhatItCannotRead) {
  EXPECT_EQ(table().exit_code, 1);
  expect_in(table().err, {"no such folder"});
  write_summary("rollup", 0.5);
  write_text(folder_ / "results" / "rollup" / "summary.json", "{\"program\": ");
  expect_in(table().err, {"rollup/summary.json: not a summary"});
  write_summary("rollup", 0.5);
  write_text(folder_ / "verification.md", "no markers");
  write_all_summaries();
  expect_in(table({"--update", (folder_ / "verification.md").string()}).err, {"no line <!-- verification:begin -->"});
}

}  // namespace
}  // namespace mixbeam::verification_table_test
