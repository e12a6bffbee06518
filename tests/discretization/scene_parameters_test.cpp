#include "discretization/reading/read_scene.hpp"

#include "scene_text.hpp"

#include <cmath>

namespace mixbeam {
namespace {

/// The scene with one change, refused with a message that has all `parts`.
void expect_refused(const std::string& from, const std::string& to, const std::vector<std::string>& parts,
                    const std::string& scene = kBowScene) {
  const std::string message = message_of([&] { scene_from(changed(scene, from, to)); });
  expect_in(message, parts);
  expect_in(message, {"scene.yaml:", "YAML path \"Scene"});
}

/// The scene with more entries in its support, or in its point load.
const std::string kSupportPoint = "Point: foot";
const std::string kLoadPoint = "Point: tip";
std::string with_support(const std::string& more) {
  return changed(kBowScene, kSupportPoint, kSupportPoint + ", " + more);
}
std::string with_load(const std::string& more) { return changed(kBowScene, kLoadPoint, kLoadPoint + ", " + more); }

TEST(SceneParameters, ReadsAValidScene) {
  const Scene scene = scene_from(kBowScene);
  EXPECT_EQ(scene.name, "bow");
  ASSERT_EQ(scene.sections.size(), 1U);
  const Section& steel = scene.sections[0];
  EXPECT_EQ(std::tie(steel.axial_stiffness, steel.shear_stiffness[1], steel.bending_stiffness[1]),
            std::tuple(1e4, 5000.0, 2.5));
  ASSERT_EQ(scene.members.size(), 2U);
  const Member &shaft = scene.members[0], &arch = scene.members[1];
  EXPECT_EQ(std::tie(shaft.order, shaft.elements, shaft.second_axis[1]), std::tuple(3, 4, 1.0));
  EXPECT_EQ(std::tie(arch.order, arch.force_integration, arch.curve.shape),
            std::tuple(2, ForceIntegration::both_reduced, CurveShape::circular_arc));
  ASSERT_EQ(scene.supports.size(), 1U);
  EXPECT_TRUE(scene.supports[0].displacement_fixed[0] && scene.supports[0].rotation_fixed[2]);
  ASSERT_EQ(scene.point_loads.size(), 1U);
  EXPECT_EQ(scene.point_loads[0].frame, LoadFrame::dead);
  EXPECT_EQ(scene.distributed_loads[0].stage, 2);
  EXPECT_EQ(scene.stages, 2);
}

TEST(SceneParameters, PlacesTheUndeclaredEndOfAnArc) {
  const Scene scene = scene_from(kBowScene);
  ASSERT_EQ(scene.points.size(), 3U);
  // A quarter of a circle of radius 5 about (10, 5, 0), from its lowest point: exact by hand.
  expect_at(scene, "tip", {15, 5, 0}, 1e-14 * 15.0);
}

TEST(SceneParameters, FollowsChainsOfCurvesInAnyOrder) {
  // "second" starts where "arch" ends but is listed before it.
  const std::string second =
      "    second: {Start: tip, End: far, Section: steel, Curve: {Shape: helix, Center: [10, 5, 0], Axis: [0, 0, 1], "
      "Angle: 3.141592653589793, Rise: -4}}\n";
  const std::string arch = "    arch:\n";
  const Scene scene = scene_from(changed(kBowScene, arch, second + arch));
  ASSERT_EQ(scene.points.size(), 4U);
  expect_at(scene, "far", {5, 5, -4}, 1e-13);
}

TEST(SceneParameters, DeclaredEndsMustAgree) {
  const std::string top = "top: [10, 0, 0]";
  EXPECT_NO_THROW(scene_from(changed(kBowScene, top, top + "\n    tip: [15, 5, 0]")));
  expect_refused(top, top + "\n    tip: [15, 5, 1e-6]",
                 {"\"Scene / Members / arch / End\"", "\"tip\" is at (15, 5, 1e-06)", "but the curve ends at", "1e-9"});
  const std::string quarter = "Angle: 1.5707963267948966";
  const std::string closed = changed(kBowScene, top, top + "\n    tip: [15, 5, 0]");
  expect_refused(quarter, "Angle: 90", {"\"Angle\" is in radian, did you mean \"=90 deg\"?"}, closed);
  const std::string shorter = message_of([&] { scene_from(changed(closed, quarter, "Angle: 1.5")); });
  EXPECT_EQ(shorter.find("deg"), std::string::npos) << shorter;
}

TEST(SceneParameters, UnitsAreTextOfTwoWords) {
  const std::string sections = "  Sections:";
  EXPECT_EQ(scene_from(kBowScene).units, "");
  EXPECT_EQ(scene_from(changed(kBowScene, sections, "  Units: m, kN\n" + sections)).units, "m, kN");
  for (const char* units : {"", "m", "m, ", "m, N, s", "metres, the heavy kilonewtons"})
    expect_refused(sections, std::string("  Units: \"") + units + "\"\n" + sections,
                   {"scene.yaml:3:3: ", "\"Scene / Units\"", "a unit of length, a comma and a unit of force"});
}

TEST(SceneParameters, SwitchesMakeStiffnessesInfinite) {
  const std::string ea = "EA: 1e4, ";
  const std::string inextensible = "Inextensible: true, ";
  EXPECT_TRUE(std::isinf(scene_from(changed(kBowScene, ea, inextensible)).sections[0].axial_stiffness));
  EXPECT_TRUE(std::isinf(scene_from(changed(kBowScene, "1e4", "inf")).sections[0].axial_stiffness));
  expect_refused(ea, ea + inextensible,
                 {"scene.yaml:4:13: ", "\"Scene / Sections / steel / EA\"", "10000", "one of the two"});
  expect_refused(ea, "",
                 {"scene.yaml:4:5: ", "\"Scene / Sections / steel / EA\"", "missing", "\"Inextensible\" = true"});
}

TEST(SceneParameters, RefusesBadStiffness) {
  expect_refused("EI3: 2.5", "EI3: -2.5",
                 {"scene.yaml:4:59: ", "\"Scene / Sections / steel / EI3\"", "value -2.5", "value > 0"});
  expect_refused("EI3: 2.5", "EI3: 0", {"value 0"});
  expect_refused("EI3: 2.5", "EI3: inf", {"value inf"});
  expect_refused("EI3: 2.5", "EI3: abc", {"value \"abc\" of type string", "allowed: double"});
}

TEST(SceneParameters, RefusesUnknownNamesWithTheNearest) {
  expect_refused("End: top", "End: tpo",
                 {"scene.yaml:9:26: ", "\"Scene / Members / shaft / End\"", "\"tpo\" is not a point",
                  "\"foot\", \"top\"", "did you mean \"top\"?"});
  expect_refused("Section: steel", "Section: steal",
                 {"scene.yaml:9:36: ", "\"steal\" is not a section", "did you mean \"steel\"?"});
  expect_refused("Member: shaft", "Member: shfat",
                 {"\"shfat\" is not a member", "\"shaft\", \"arch\"", "did you mean \"shaft\"?"});
  expect_refused(kLoadPoint, "Point: tpi", {"\"tpi\" is not a point", "did you mean \"tip\"?"});
  expect_refused("Start: top", "Start: nowhere", {"\"Scene / Members / arch / Start\"", "\"nowhere\" is not a point"});
  expect_refused("Elements", "Elments", {"scene.yaml:9:62: ", "did you mean \"Elements\"?"});
}

TEST(SceneParameters, RefusesMembersWithoutLength) {
  expect_refused("[10, 0, 0]", "[0, 0, 0]",
                 {"scene.yaml:9:5: ", "\"Scene / Members / shaft\"", "no length", "\"foot\""});
  expect_refused("End: top", "End: foot", {"no length"});
  expect_refused("1.5707963267948966", "0", {"Angle", "value 0", "0 < value"});
  expect_refused("[10, 5, 0]", "[10, 0, 0]",
                 {"\"Scene / Members / arch / Curve / Center\"", "\"top\" lies on the axis"});
  expect_refused("[10, 5, 0]", "[10, 5, 1]", {"not in the plane of the arc", "allowed: (10, 5, 0)"});
}

TEST(SceneParameters, RefusesWrongCurves) {
  expect_refused("[0, 0, 2]", "[0, 0, 0]", {"Curve / Axis", "no direction"});
  expect_refused("Shape: arc", "Shape: line", {"Curve / Center", "has no meaning for \"Shape\" = \"line\""});
  expect_refused("Shape: arc", "Shape: helix", {"Curve / Rise", "missing"});
  expect_refused("Shape: arc", "Shape: helx", {"did you mean \"helix\"?"});
  expect_refused("Second Axis: [0, 1, 0]", "Second Axis: [2, 0, 0]",
                 {"scene.yaml:9:75: ", "\"Scene / Members / shaft / Second Axis\"", "parallel to the start tangent"});
}

TEST(SceneParameters, RefusesPointsThatNothingUses) {
  const std::string top = "top: [10, 0, 0]";
  const std::string spare = "spare: [1, 1, 1]";
  expect_refused(top, top + "\n    " + spare, {"scene.yaml:8:5: ", "\"Scene / Points / spare\"", "unused"});
  expect_refused(kLoadPoint, "Point: x", {"\"Scene / Point Loads / pull / Point\"", "\"x\" is not a point"});
  const std::string loaded = changed(changed(kBowScene, top, top + "\n    " + spare), kLoadPoint, "Point: spare");
  expect_text_refused(loaded, {"\"Scene / Point Loads / pull / Point\"", "no member starts or ends there"});
}

TEST(SceneParameters, ReadsSupports) {
  const Scene scene = scene_from(with_support("Fixed Rotation: [x, z], Prescribed Displacement: [0, 0.5, 0]"));
  EXPECT_TRUE(scene.supports[0].rotation_fixed[0]);
  EXPECT_FALSE(scene.supports[0].rotation_fixed[1]);
  EXPECT_EQ(scene.supports[0].prescribed_displacement[1], 0.5);
}

TEST(SceneParameters, RefusesWrongSupports) {
  const std::string ball = "Fixed Rotation: [], ";
  const std::string sliding = "Fixed Displacement: [x, z], ";
  expect_text_refused(with_support(sliding + "Prescribed Displacement: [0, 1, 0]"),
                      {"Prescribed Displacement", "(0, 1, 0)", "direction y"});
  expect_text_refused(with_support(ball + "Prescribed Rotation: [0, 0, 1]"),
                      {"Prescribed Rotation", "(0, 0, 1)", "{x, y, z}"});
  expect_text_refused(with_support("Stage: 2"), {"nothing is prescribed"});
}

TEST(SceneParameters, ReadsFollowerLoads) {
  const Scene scene = scene_from(with_load("Frame: follower, Member: arch"));
  EXPECT_EQ(scene.point_loads[0].frame, LoadFrame::follower);
  EXPECT_EQ(scene.point_loads[0].member, "arch");
  const std::string inside = changed(kBowScene, "Second Axis: [0, 1, 0]", "Inner Points: {middle: 0.5}");
  const std::string follows = "Point: middle, Frame: follower, Member: ";
  EXPECT_EQ(scene_from(changed(inside, kLoadPoint, follows + "shaft")).point_loads[0].member, "shaft");
  expect_text_refused(changed(inside, kLoadPoint, follows + "arch"), {"value \"arch\"", "or through it", "\"shaft\""});
}

TEST(SceneParameters, RefusesWrongLoads) {
  const std::string follower = "Frame: follower, ";
  expect_text_refused(with_load("Frame: follower"),
                      {"Point Loads / pull / Member", "missing for a follower load", "\"arch\""});
  expect_text_refused(with_load(follower + "Member: shaft"), {"value \"shaft\"", "with one end at \"tip\""});
  expect_text_refused(with_load(follower + "Member: arhc"), {"did you mean \"arch\"?"});
  expect_text_refused(with_load("Member: arch"), {"no meaning for \"Frame\" = \"dead\""});
  expect_refused(", Force: [0, 1, 0]", "", {"\"Scene / Point Loads / pull\"", "loads nothing"});
  expect_refused("Force: [0, 1, 0]", "Force: [0, 1]", {"{0, 1} has 2 entries"});
}

TEST(SceneParameters, RefusesGapsBetweenStages) {
  const std::string stage = "Stage: 2";
  expect_refused(
      stage, "Stage: 3",
      {"scene.yaml:20:48: ", "\"Scene / Distributed Loads / weight / Stage\"", "value 3", "nothing acts in stage 2"});
  expect_refused(stage, "Stage: 0", {"value 0", "1 <= value"});
}

TEST(SceneParameters, RefusesMoreElementsThanMemoryCanHold) {
  expect_refused("Elements: 4", "Elements: 10000001", {"Elements", "10000001"});
  expect_refused("Elements: 4", "Elements: 10000000",
                 {"\"Scene / Members / arch / Elements\"", "brings the scene to 10000001 elements"});
}

}  // namespace
}  // namespace mixbeam
