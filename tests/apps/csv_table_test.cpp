/// CSV files read back bit for bit.
#include "apps/common/tables/csv_table.hpp"
#include "tests/support/files.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <sstream>

namespace mixbeam {
namespace {

class CsvTableTest : public ::testing::Test {
 protected:
  std::vector<std::string> lines(const fs::path& path) const {
    std::ifstream stream(path);
    std::vector<std::string> result;
    for (std::string line; std::getline(stream, line);) result.push_back(line);
    return result;
  }

  const TemporaryFolder temporary_;
  const fs::path folder_ = temporary_.path();
};

TEST_F(CsvTableTest, NumbersReadBackBitForBit) {
  const std::vector<double> values = {1.0 / 3.0, 0.1, -2.5e-308, 1.7976931348623157e308, std::nextafter(1.0, 2.0)};
  CsvTable table(folder_ / "new" / "values.csv", {"value"});
  for (const double value : values) table.add_row({value});
  const auto rows = lines(folder_ / "new" / "values.csv");
  ASSERT_EQ(rows.size(), values.size() + 1);
  for (std::size_t i = 0; i < values.size(); ++i) EXPECT_EQ(std::strtod(rows[i + 1].c_str(), nullptr), values[i]);
}

TEST_F(CsvTableTest, TextsNumbersAndWhatIsNotFinite) {
  CsvTable table(folder_ / "mixed.csv", {"name", "n", "x", "y"});
  table.add_row({"both reduced", 8, std::nan(""), -std::numeric_limits<double>::infinity()});
  table.add_row({"a, \"b\"", std::size_t{9}, 0.25, -1.0});
  EXPECT_EQ(lines(folder_ / "mixed.csv"),
            (std::vector<std::string>{"name,n,x,y", "both reduced,8,nan,-inf", "\"a, \"\"b\"\"\",9,0.25,-1"}));
}

TEST_F(CsvTableTest, RowsOfTheWrongLengthAreRefused) {
  CsvTable table(folder_ / "t.csv", {"a", "b"});
  EXPECT_THROW(table.add_row({1.0}), std::invalid_argument);
  EXPECT_THROW(table.add_row({1.0, 2.0, 3.0}), std::invalid_argument);
  EXPECT_NO_THROW(table.add_row({1.0, 2.0}));
  EXPECT_EQ(lines(folder_ / "t.csv").size(), 2u);
}

TEST_F(CsvTableTest, ErrorsNameThePath) {
  try {
    CsvTable table(folder_, {"a"});
    FAIL() << "a directory was opened as a file";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find(folder_.string()), std::string::npos);
    EXPECT_NE(std::string(error.what()).find("directory"), std::string::npos);
  }
  try {
    CsvTable table("/dev/full", {"a"});
    FAIL() << "a device was replaced by a file";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("a device"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace mixbeam
