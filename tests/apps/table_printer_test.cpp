/// The tables that set the paper's values beside our own.
#include "apps/common/tables/table_printer.hpp"

#include "apps/common/tables/formatted.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <sstream>
#include <stdexcept>

namespace mixbeam {
namespace {

ComparedValue compare_printed(const std::string& paper, double own) {
  return {paper, own, agrees_in_printed_digits(own, paper, 1) ? Agreement::agrees : Agreement::differs};
}

std::string printed(const TablePrinter& table) {
  std::stringstream stream;
  table.print(stream);
  return stream.str();
}

TEST(TablePrinter, PutsPaperOwnValueAndDifferenceSideBySide) {
  TablePrinter table("Arc", {"k", "elements"}, {"u1", "u2"});
  table.add_group("slenderness 10");
  table.add_row({"1", "4"}, {compare_printed("-23.7513", -23.75125), compare_printed("54.0950", 54.09503)});
  table.add_row({"2", "32"}, {{"", 1.5, Agreement::informative}, {"1.0", 1.2, Agreement::informative}});
  EXPECT_EQ(printed(table),
            "Arc\n"
            "                                 u1                                u2\n"
            "  k  elements       paper   mixbeam  difference        paper  mixbeam  difference\n"
            "  slenderness 10\n"
            "  1         4    -23.7513  -23.7512     5.0e-05      54.0950  54.0950     3.0e-05\n"
            "  2        32           -       1.5                      1.0      1.2     2.0e-01\n");
}

TEST(TablePrinter, MarksRowsOutOfTolerance) {
  TablePrinter table("Arc", {"k"}, {"u1", "u2"});
  table.add_row({"1"}, {compare_printed("-23.7513", -23.7515), compare_printed("1.0", 1.0)});
  table.add_row({"2"}, {compare_printed("-23.7513", std::nan("")), compare_printed("1.0", 1.0)});
  table.add_row({"3"}, {compare_printed("-23.7513", -23.7512), compare_printed("1.0", 1.0)});
  std::stringstream lines(printed(table));
  std::string line;
  for (int i = 0; i < 4; ++i) std::getline(lines, line);
  EXPECT_NE(line.find("-2.0e-04 *"), std::string::npos);
  EXPECT_NE(line.find("<- differs"), std::string::npos);
  std::getline(lines, line);
  EXPECT_NE(line.find("nan *"), std::string::npos);
  std::getline(lines, line);
  EXPECT_EQ(line.find("differs"), std::string::npos);
  EXPECT_EQ(line.find('*'), std::string::npos);
}

TEST(TablePrinter, NamesTheReferenceThatIsNotThePaper) {
  TablePrinter table("Arc", {"k"}, {"u1"}, "shooting");
  table.add_row({"1"}, {compare_printed("1.0", 1.0)});
  std::stringstream lines(printed(table));
  std::string line;
  for (int i = 0; i < 3; ++i) std::getline(lines, line);
  EXPECT_EQ(line, "  k    shooting  mixbeam  difference");
}

TEST(TablePrinter, RowsOfTheWrongLengthAreRefused) {
  TablePrinter table("Arc", {"k"}, {"u1"});
  EXPECT_THROW(table.add_row({}, {{"1.0", 1.0, Agreement::agrees}}), std::invalid_argument);
  EXPECT_THROW(table.add_row({"1"}, {}), std::invalid_argument);
}

}  // namespace
}  // namespace mixbeam
