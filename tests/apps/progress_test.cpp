#include "apps/common/session/progress.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <sstream>
#include <thread>

namespace mixbeam::progress_test {
namespace {

TEST(Progress, LoadFactorsOfAnySizeFitTheLine) {
  EXPECT_EQ(load_factor_text(0.0), " 0.00000");
  EXPECT_EQ(load_factor_text(0.5), " 0.50000");
  EXPECT_EQ(load_factor_text(-12.25), "-12.25000");
  EXPECT_EQ(load_factor_text(4.47778e-6), "4.48e-06");  // not 0.00000
  EXPECT_EQ(load_factor_text(-1.2e-14), "-1.20e-14");
  EXPECT_EQ(load_factor_text(1.000024e70), "1.00e+70");
  EXPECT_EQ(load_factor_text(std::nan("")), " unknown");
  EXPECT_EQ(load_factor_text(std::numeric_limits<double>::infinity()), " unknown");
}

std::string line_of(double load_factor, double share_done) {
  std::ostringstream out;
  Progress progress(out, "rod", 1);
  std::this_thread::sleep_for(std::chrono::milliseconds(2));
  StepReport report;
  report.step = 1;
  report.load_factor = load_factor;
  progress.report(report, share_done);
  return out.str();
}

TEST(Progress, TheTimeToGoIsLeftOutWhereItTellsNothing) {
  EXPECT_NE(line_of(0.5, 0.5).find("to go"), std::string::npos);
  EXPECT_EQ(line_of(1e-12, 1e-12).find("to go"), std::string::npos);  // 2 ms a step: 60 years
  EXPECT_EQ(line_of(-0.5, -0.5).find("to go"), std::string::npos);    // away from the end
  EXPECT_EQ(line_of(2.0, 1.5).find("to go"), std::string::npos);      // beyond it
  EXPECT_EQ(line_of(0.5, std::numeric_limits<double>::infinity()).find("to go"), std::string::npos);
}

TEST(Progress, AFailureKeepsItsCauseWhateverTheLoadFactor) {
  std::ostringstream out;
  Progress progress(out, "rod", 1);
  progress.report(StepFailure{1, 1e70, 25, "no equilibrium"});
  EXPECT_EQ(out.str(), "rod: step   1  load factor 1.00e+70 of 1  iterations  25  FAILED: no equilibrium\n");
}

}  // namespace
}  // namespace mixbeam::progress_test
