// Natural strains along a member from tables.
#include "scene_text.hpp"

#include "discretization/reading/import.hpp"
#include "tests/support/files.hpp"

namespace mixbeam::field_table_test {
namespace {

constexpr double kRounding = 1e-14;

class FieldTables : public testing::Test {
 protected:
  Scene read(const std::string& table, const std::string& more = "") {
    write_text(folder_ / "t.csv", table);
    return described_by(parsed(scene_text("A: [0, 0, 0], B: [2, 0, 0]", member("m", "A", "B"),
                                          "Eigenstrains: {e: {Member: m, Curvature Table: t.csv, " + more + "}}"),
                               (folder_ / "").string()));
  }
  void refused(const std::string& table, const std::vector<std::string>& parts, const std::string& more = "") {
    expect_in(message_of([&] { read(table, more); }), parts);
  }

  const TemporaryFolder folder_;
};

TEST_F(FieldTables, ArePolynomialsOfElements) {
  const Scene scene =
      read("element,s,1,2,3\n1,0.2,0.04,1,0\n1,0.5,0.25,1,0\n1,0.8,0.64,1,0\n2,1.5,7,1,1\n", "End Turn: [0, 0, 0.1]");
  const FieldTable& table = *scene.eigenstrains.at(0).curvature_table;
  ASSERT_EQ(table.pieces.size(), 2U);
  EXPECT_EQ(table.at(0.5)[0], 0.25);
  EXPECT_NEAR(table.at(1.0)[0], 1.0, kRounding);  // s^2
  EXPECT_NEAR(table.at(0.3)[1], 1.0, kRounding);
  EXPECT_EQ(table.at(1.9), (Vector3{7, 1, 1}));
  EXPECT_EQ(scene.eigenstrains[0].end_turns[1], (Vector3{0, 0, 0.1}));
}

/// An element may begin where the one before it ends, with another value.
TEST_F(FieldTables, HoldBothEndsOfElements) {
  const Scene scene = read("element,s,1,2,3\n1,0,0,0,0\n1,1,2,0,0\n2,1,5,0,0\n2,2,7,0,0\n");
  const FieldTable& table = *scene.eigenstrains.at(0).curvature_table;
  EXPECT_NEAR(table.at(0.75)[0], 1.5, kRounding);
  EXPECT_NEAR(table.at(1.25)[0], 5.5, kRounding);
}

TEST_F(FieldTables, AreRefusedWithTheirPlace) {
  const std::string head = "element,s,1,2,3\n";
  refused(head + "1,0.5,0,0,0\n1,0.5,0,0,0\n", {"t.csv:3:", "growing arc lengths"});
  refused(head + "1,0.5,0,0,0\n1,0.2,0,0,0\n", {"t.csv:3:", "growing arc lengths"});
  refused(head + "1,2.5,0,0,0\n", {"t.csv:2:", "value 2.5", "2"});
  refused(head + "1,0.5,0,x,0\n", {"t.csv:2:"});
  refused(head, {"Curvature Table", "no lines"});
  refused("element,s\n1,0.5\n", {"t.csv:1:", "\"1\""});
  refused(head + "1,0.5,0,0,0\n", {"Curvature Table", "beside \"Curvature\""}, "Curvature: [1, 0, 0]");
  std::string many = head;
  for (int i = 1; i <= 10; ++i) many += "1," + std::to_string(0.1 * i) + ",0,0,0\n";
  refused(many, {"more than 9 lines"});
  expect_text_refused(scene_text("A: [0, 0, 0], B: [2, 0, 0]", member("m", "A", "B"),
                                 "Eigenstrains: {e: {Member: m, Strain Table: none.csv}}"),
                      {"Strain Table", "there is no file"});
}

}  // namespace
}  // namespace mixbeam::field_table_test
