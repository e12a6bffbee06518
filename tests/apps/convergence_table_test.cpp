#include "apps/common/tables/table_printer.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <sstream>
#include <stdexcept>

namespace mixbeam {
namespace {

constexpr double kRoundOff = 1e-12;
constexpr double kTolerance = 1e-12;  // of a quotient of two logarithms of numbers near 1

TEST(ObservedRate, TakesTheFinestMeshes) {
  EXPECT_NEAR(observed_rate({2, 4, 8}, {1.0, 0.5, 0.0625}, kRoundOff).value(), 3.0, kTolerance);
}

TEST(ObservedRate, MeshesNeedNotDouble) {
  EXPECT_NEAR(observed_rate({1, 3}, {1.0, 1.0 / 81.0}, kRoundOff).value(), 4.0, kTolerance);
}

TEST(ObservedRate, LeavesOutEverythingAfterRoundOffIsReached) {
  // the last error is above the limit again: noise of a badly conditioned mesh
  EXPECT_NEAR(observed_rate({2, 4, 8, 16}, {1e-6, 1e-6 / 32.0, 1e-14, 2e-12}, kRoundOff).value(), 5.0, kTolerance);
}

TEST(ObservedRate, NoneWithoutTwoMeshes) {
  EXPECT_FALSE(observed_rate({2}, {1.0}, kRoundOff));
  EXPECT_FALSE(observed_rate({2, 4}, {1.0, 1e-13}, kRoundOff));
  EXPECT_FALSE(observed_rate({2, 4}, {std::numeric_limits<double>::quiet_NaN(), 1.0}, kRoundOff));
}

TEST(ConvergenceTable, PrintsOneRowForEachOrder) {
  ConvergenceTable table("Errors", {8, 16}, kRoundOff);
  table.add_group("slenderness 10");
  EXPECT_NEAR(table.add_row(1, {4e-2, 1e-2}).value(), 2.0, kTolerance);
  EXPECT_FALSE(table.add_row(6, {1e-10, 1e-13}));
  std::ostringstream text;
  table.print(text);
  EXPECT_EQ(text.str(),
            "Errors\n"
            "  k       8 el      16 el   rate\n"
            "  slenderness 10\n"
            "  1   4.00e-02   1.00e-02   2.00\n"
            "  6   1.00e-10   1.00e-13      -\n"
            "  rate: of the two finest meshes before the error falls below 1e-12\n");
}

TEST(ConvergenceTable, RefusesARowOfAnotherLength) {
  ConvergenceTable table("Errors", {8, 16}, kRoundOff);
  EXPECT_THROW(table.add_row(1, {1.0}), std::invalid_argument);
}

}  // namespace
}  // namespace mixbeam
