// Members through tables of sections, and rigid arms.
#include "scene_text.hpp"
#include "tests/support/files.hpp"

#include "discretization/checks/scene_warnings.hpp"

#include <cmath>

namespace mixbeam::section_stations_test {
namespace {

constexpr double kRounding = 1e-14;

const std::string kSections = "root: {" + kFlatSection + "}, tip: {" + kFlatSection + "}";

std::string blade(const std::string& stations, const std::string& more = "Second Axis: [0, 1, 0], Elements: 10, ") {
  return scene_text("A: [1, 0, 0], B: [11, 0, 0]",
                    "blade: {Start: A, End: B, " + more + "Section Stations: {" + stations + "}}", "", "A", kSections);
}

TEST(SectionStations, BecomeAChainOfTapers) {
  const Scene scene = scene_from(
      blade("Position: [0, 0.2, 1], Section: [root, flat, tip], Twist: [0.3, 0.1, 0], Offset 3: [0, 0.5, 0]"));
  ASSERT_EQ(scene.members.size(), 2U);
  const Member &first = scene.members[0], &last = scene.members[1];
  EXPECT_EQ(first.name, "blade[1]");
  EXPECT_EQ(first.start_point, "A");
  EXPECT_EQ(first.end_point, "blade[1]");
  EXPECT_EQ(last.start_point, "blade[1]");
  EXPECT_EQ(last.end_point, "B");
  expect_at(scene, "blade[1]", {3, 0, 0.5}, kRounding);
  EXPECT_EQ(first.section, "root");
  EXPECT_EQ(first.end_section, "flat");
  EXPECT_EQ(last.end_section, "tip");
  EXPECT_NEAR(first.twist, -0.2, kRounding);
  EXPECT_NEAR(first.second_axis[1], std::cos(0.3), kRounding);
  EXPECT_NEAR(first.second_axis[2], std::sin(0.3), kRounding);
  EXPECT_EQ(first.elements + last.elements, 10);
  EXPECT_EQ(last.elements, 8);
}

TEST(SectionStations, PlacesMayBeLengths) {
  const Scene scene = scene_from(blade("Position: [0, 2, 10], Section: [root, root, tip]"));
  expect_at(scene, "blade[1]", {3, 0, 0}, kRounding);
  EXPECT_EQ(scene.members[0].end_section, "");
}

TEST(SectionStations, OffsetsOfTheEndsAreArms) {
  const Scene scene = scene_from(blade("Position: [0, 1], Section: [root, tip], Offset 2: [0.25, 0]"));
  ASSERT_EQ(scene.members.size(), 2U);
  EXPECT_EQ(scene.members[0].name, "start arm of blade");
  EXPECT_EQ(scene.members[1].start_point, "start of blade");
  expect_at(scene, "start of blade", {1, 0.25, 0}, kRounding);
  EXPECT_TRUE(std::isinf(scene.sections.back().bending_stiffness[0]));
}

TEST(SectionStations, MistakesAreNamed) {
  const std::string good = "Position: [0, 1], Section: [root, tip]";
  const auto refused = [&](const std::string& stations, const std::vector<std::string>& parts) {
    expect_text_refused(blade(stations), parts);
  };
  refused("Position: [0.1, 1], Section: [root, tip]", {"Section Stations / Position", "{0.1, 1}", "from 0 to 1"});
  refused("Position: [0, 9], Section: [root, tip]", {"Section Stations / Position", "the length of the member, 10"});
  refused("Position: [0, 0.5, 0.5, 1], Section: [root, tip, tip, tip]", {"Position", "0.5, 0.5", "ascending"});
  refused("Position: [0, 1], Section: [root]", {"Section Stations / Section", "1 entries", "2 of \"Position\""});
  refused("Position: [0], Section: [root]", {"Position", "at least two"});
  refused("Position: [0, 1], Section: [root, tap]", {"End Section", "\"tap\"", "did you mean \"tip\"?"});
  refused("Position: [0, 1], Section: [root, tip], Table: t.csv", {"Position", "beside \"Table\""});
  refused("Table: none.csv", {"Table", "there is no file"});
  expect_text_refused(blade(good + ", Twist: [1, 0]", ""), {"blade / Second Axis", "missing"});
  expect_text_refused(blade(good, "Section: flat, "), {"blade / Section", "beside \"Section Stations\""});
  expect_text_refused(blade(good + ", Twist: [1, 0]", "Second Axis: [1, 0, 0], "), {"Second Axis", "parallel"});
}

TEST(SectionStations, ComeFromATable) {
  const TemporaryFolder folder;
  const auto read = [&](const std::string& table) {
    write_text(folder / "blade.csv", table);
    return described_by(parsed(blade("Table: blade.csv"), (folder / "").string()));
  };
  const Scene scene = read("position,section,twist,offset 3\n0,root,0.3,\n0.2,flat,=0.2/2,0.5\n1,tip,,\n");
  expect_at(scene, "blade[1]", {3, 0, 0.5}, kRounding);
  EXPECT_NEAR(scene.members[1].twist, -0.1, kRounding);
  expect_in(message_of([&] { read("position,section\n0,root\nx,tip\n"); }), {"blade.csv:3:", "position"});
}

TEST(RigidArms, StandBesideTheirMember) {
  const auto text = [](const std::string& offsets, const std::string& more = "") {
    return scene_text("A: [0, 0, 0], B: [1, 0, 0]", member("m", "A", "B", offsets), more);
  };
  const Scene scene = scene_from(text("Start Offset: [0, 0, 0.5], End Offset: [0, 0, 0.5]"));
  ASSERT_EQ(scene.members.size(), 3U);
  EXPECT_EQ(scene.members[2].name, "m");
  EXPECT_EQ(scene.members[2].start_point, "start of m");
  expect_at(scene, "end of m", {1, 0, 0.5}, 0.0);
  EXPECT_NO_THROW(scene_from(text("End Offset: [0, 0, 0.5]",
                                  "Joints: {pin: {Point: end of m, Members: [m], Kind: ball}}, "
                                  "Point Loads: {p: {Point: B, Force: [0, 0, 1]}}")));
  expect_text_refused(text("Start Offset: [0, 0, 0]"), {"m / Start Offset", "zero"});
  expect_text_refused(scene_text("A: [3, 0, 0]", member("m", "A", "B",
                                                        curve("arc", "Center: [0, 0, 0], Axis: [0, 0, 1], Angle: 3") +
                                                            "End Offset: [0, 0, 1]")),
                      {"m / End Offset", "follows from a curve"});
}

/// The section of arms is not one of the scene.
TEST(RigidArms, LeaveTheOnlySectionTheOnlyOne) {
  const std::string text =
      scene_text("A: [0, 0, 0], B: [1, 0, 0], C: [2, 0, 0]",
                 "m: {Start: A, End: B, Start Offset: [0, 0, 0.5]}, n: {Start: B, End: C, Start Offset: [0, 0, 0.5]}");
  const Scene scene = scene_from(text);
  EXPECT_EQ(scene.members.back().section, scene.members[1].section);
  const std::string refused = message_of([&] {
    scene_from(changed(text, "Sections: {", "Sections: {other: {EA: 1, GA2: 1, GA3: 1, GIt: 1, EI2: 1, EI3: 1}, "));
  });
  expect_in(refused, {"m / Section", "missing section", "\"other\""});
  EXPECT_EQ(refused.find("rigid arm"), std::string::npos) << refused;
}

/// Loads, bows and warnings; by its name an arm can be loaded.
TEST(RigidArms, AreNotMeantByPatternsOfNames) {
  const std::string lists =
      "Gravity: {Acceleration: [0, 0, -10]}, Point Loads: {p: {Point: '*', Force: [0, 0, 1]}}, Distributed Loads: "
      "{all: {Member: '*', Force: [0, 0, 1]}, one: {Member: start arm of m, Force: [0, 0, 1]}}, Eigenstrains: {t: "
      "{Member: '*', Strain: [1, 0, 0]}}, Imperfection: {Bows: {b: {Member: '*', Share: 0.01, Direction: [0, 1, 0]}}}";
  const std::string text =
      changed(scene_text("A: [0, 0, 0], B: [1, 0, 0]",
                         member("m", "A", "B", "Start Offset: [0, 0, 0.5], End Offset: [0, 0, 1]"), lists),
              "EA: 10,", "EA: 10, Mass: 1,");
  const Scene scene = scene_from(text);
  ASSERT_EQ(scene.members.size(), 3U);
  EXPECT_EQ(scene.point_loads.size(), 2U);
  EXPECT_EQ(scene.eigenstrains.size(), 1U);
  ASSERT_EQ(scene.distributed_loads.size(), 3U);  // all, one, weight
  EXPECT_EQ(scene.distributed_loads[0].member, "m");
  EXPECT_EQ(scene.distributed_loads[1].member, "start arm of m");
  EXPECT_EQ(scene.distributed_loads[2].member, "m");
  EXPECT_EQ(scene.members[0].curve.shape, CurveShape::line);
  EXPECT_EQ(scene.members[2].curve.shape, CurveShape::parametric);
  for (const std::string& warning : warnings(scene)) EXPECT_EQ(warning.find("no weight"), std::string::npos) << warning;
  expect_text_refused(changed(text, "Member: start arm of m", "Member: 'start*'"), {"one / Member", "allowed: \"m\""});
  expect_text_refused(changed(text, "Sections: {", "Sections: {(rigid arm): {EA: 1}, "), {"Sections / (rigid arm)"});
}

TEST(RigidArms, GoWithTheirMemberWhereAPatternCopiesIt) {
  const Scene scene =
      scene_from(scene_text("A: [0, 0, 0], B: [1, 0, 0]", member("m", "A", "B", "Start Offset: [0, 0, 0.5]"),
                            "Patterns: {again: {Members: [m], Kind: repeat, Vector: [0, 3, 0], Count: 2}}"));
  ASSERT_EQ(scene.members.size(), 4U);
  ASSERT_NE(member_in(scene, "start arm of m (1)"), nullptr);
  EXPECT_EQ(member_in(scene, "start arm of m (1)")->end_point, member_in(scene, "m (1)")->start_point);
}

}  // namespace
}  // namespace mixbeam::section_stations_test
