#include "discretization/reading/read_scene.hpp"

#include "discretization/parameters/print.hpp"
#include "input_text.hpp"

#include <cmath>
#include <sstream>

namespace mixbeam {
namespace {

/// The scene with one change, refused with a message that has all `parts`.
void expect_refused(const std::string& from, const std::string& to, const std::vector<std::string>& parts,
                    const std::string& scene = kBowScene) {
  const std::string message = message_of([&] { scene_from(changed(scene, from, to)); });
  expect_in(message, parts);
  expect_in(message, {"scene.xml:", "XML path \"Scene"});
}

std::string text_parameter(const std::string& name, const std::string& value) {
  return "<Parameter name=\"" + name + "\" type=\"string\" value=\"" + value + "\"/>";
}

std::string array_parameter(const std::string& name, const std::string& value) {
  return "<Parameter name=\"" + name + "\" type=\"Array(double)\" value=\"" + value + "\"/>";
}

/// The scene with more lines in its support, or in its point load.
const std::string kSupportPoint = text_parameter("Point", "foot");
const std::string kLoadPoint = text_parameter("Point", "tip");
std::string with_support(const std::string& more) { return changed(kBowScene, kSupportPoint, kSupportPoint + more); }
std::string with_load(const std::string& more) { return changed(kBowScene, kLoadPoint, kLoadPoint + more); }

void expect_scene_refused(const std::string& scene, const std::vector<std::string>& parts) {
  expect_in(message_of([&] { scene_from(scene); }), parts);
}

TEST(SceneParameters, ReadsAValidScene) {
  const Scene scene = scene_from(kBowScene);
  EXPECT_EQ(scene.name, "bow");
  ASSERT_EQ(scene.sections.size(), 1U);
  EXPECT_EQ(scene.sections[0].axial_stiffness, 1e4);
  EXPECT_EQ(scene.sections[0].shear_stiffness[1], 5000.0);
  EXPECT_EQ(scene.sections[0].bending_stiffness[1], 2.5);
  ASSERT_EQ(scene.members.size(), 2U);
  EXPECT_EQ(scene.members[0].order, 3);
  EXPECT_EQ(scene.members[0].elements, 4);
  EXPECT_EQ(scene.members[0].second_axis[1], 1.0);
  EXPECT_EQ(scene.members[1].order, 2);
  EXPECT_EQ(scene.members[1].force_integration, ForceIntegration::both_reduced);
  EXPECT_EQ(scene.members[1].curve.shape, CurveShape::circular_arc);
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
  EXPECT_EQ(scene.points[2].name, "tip");
  // A quarter of a circle of radius 5 about (10, 5, 0), from its lowest point: exact by hand.
  EXPECT_NEAR(scene.points[2].position[0], 15.0, 1e-14 * 15.0);
  EXPECT_NEAR(scene.points[2].position[1], 5.0, 1e-14 * 15.0);
  EXPECT_EQ(scene.points[2].position[2], 0.0);
}

TEST(SceneParameters, FollowsChainsOfCurvesInAnyOrder) {
  // "second" starts where "arch" ends but is listed before it.
  const std::string second =
      "<ParameterList name=\"second\">" + text_parameter("Start", "tip") + text_parameter("End", "far") +
      text_parameter("Section", "steel") + "<ParameterList name=\"Curve\">" + text_parameter("Shape", "helix") +
      array_parameter("Center", "{10, 5, 0}") + array_parameter("Axis", "{0, 0, 1}") +
      "<Parameter name=\"Angle\" type=\"double\" value=\"3.141592653589793\"/><Parameter name=\"Rise\" type=\"int\" "
      "value=\"-4\"/></ParameterList></ParameterList>";
  const std::string arch = "<ParameterList name=\"arch\">";
  const Scene scene = scene_from(changed(kBowScene, arch, second + arch));
  ASSERT_EQ(scene.points.size(), 4U);
  EXPECT_EQ(scene.points[3].name, "far");
  EXPECT_NEAR(scene.points[3].position[0], 5.0, 1e-13);
  EXPECT_NEAR(scene.points[3].position[1], 5.0, 1e-13);
  EXPECT_NEAR(scene.points[3].position[2], -4.0, 1e-13);
}

TEST(SceneParameters, DeclaredEndsMustAgree) {
  const std::string top = array_parameter("top", "{10, 0, 0}");
  EXPECT_NO_THROW(scene_from(changed(kBowScene, top, top + array_parameter("tip", "{15, 5, 0}"))));
  expect_refused(top, top + array_parameter("tip", "{15, 5, 1e-6}"),
                 {"\"Scene / Members / arch / End\"", "\"tip\" is at (15, 5, 1e-06)", "but the curve ends at", "1e-9"});
}

TEST(SceneParameters, UnitsAreTextOfTwoWords) {
  const std::string sections = "<ParameterList name=\"Sections\">";
  EXPECT_EQ(scene_from(kBowScene).units, "");
  EXPECT_EQ(scene_from(changed(kBowScene, sections, text_parameter("Units", "m, kN") + sections)).units, "m, kN");
  for (const char* units : {"", "m", "m, ", "m, N, s", "metres, the heavy kilonewtons"})
    expect_refused(sections, text_parameter("Units", units) + sections,
                   {"scene.xml:4: ", "\"Scene / Units\"", "a unit of length, a comma and a unit of force"});
}

TEST(SceneParameters, SwitchesMakeStiffnessesInfinite) {
  const std::string ea = "<Parameter name=\"EA\" type=\"double\" value=\"1e4\"/>";
  const std::string inextensible = "<Parameter name=\"Inextensible\" type=\"bool\" value=\"true\"/>";
  EXPECT_TRUE(std::isinf(scene_from(changed(kBowScene, ea, inextensible)).sections[0].axial_stiffness));
  EXPECT_TRUE(std::isinf(scene_from(changed(kBowScene, "1e4", "inf")).sections[0].axial_stiffness));
  expect_refused(ea, ea + inextensible,
                 {"scene.xml:6: ", "\"Scene / Sections / steel / EA\"", "10000", "one of the two"});
  expect_refused(ea, "", {"scene.xml:5: ", "\"Scene / Sections / steel / EA\"", "missing", "\"Inextensible\" = true"});
}

TEST(SceneParameters, RefusesBadStiffness) {
  expect_refused("value=\"2.5\"", "value=\"-2.5\"",
                 {"scene.xml:11: ", "\"Scene / Sections / steel / EI3\"", "value -2.5", "value > 0"});
  expect_refused("value=\"2.5\"", "value=\"0\"", {"value 0"});
  expect_refused("value=\"2.5\"", "value=\"inf\"", {"value inf"});
  expect_refused("value=\"2.5\"", "value=\"abc\"", {"\"abc\" is not a number"});
}

TEST(SceneParameters, RefusesUnknownNamesWithTheNearest) {
  expect_refused(text_parameter("End", "top"), text_parameter("End", "tpo"),
                 {"scene.xml:21: ", "\"Scene / Members / shaft / End\"", "\"tpo\" is not a point", "\"foot\", \"top\"",
                  "did you mean \"top\"?"});
  expect_refused(text_parameter("Section", "steel"), text_parameter("Section", "steal"),
                 {"scene.xml:22: ", "\"steal\" is not a section", "did you mean \"steel\"?"});
  expect_refused(text_parameter("Member", "shaft"), text_parameter("Member", "shfat"),
                 {"\"shfat\" is not a member", "\"shaft\", \"arch\"", "did you mean \"shaft\"?"});
  expect_refused(kLoadPoint, text_parameter("Point", "tpi"), {"\"tpi\" is not a point", "did you mean \"tip\"?"});
  expect_refused(text_parameter("Start", "top"), text_parameter("Start", "nowhere"),
                 {"\"Scene / Members / arch / Start\"", "\"nowhere\" is not a point"});
  expect_refused("name=\"Elements\"", "name=\"Elments\"", {"scene.xml:24: ", "did you mean \"Elements\"?"});
}

TEST(SceneParameters, RefusesMembersWithoutLength) {
  expect_refused("{10, 0, 0}", "{0, 0, 0}", {"scene.xml:19: ", "\"Scene / Members / shaft\"", "no length", "\"foot\""});
  expect_refused(text_parameter("End", "top"), text_parameter("End", "foot"), {"no length"});
  expect_refused("value=\"1.5707963267948966\"", "value=\"0\"", {"Angle", "value 0", "0 < value"});
  expect_refused("{10, 5, 0}", "{10, 0, 0}",
                 {"\"Scene / Members / arch / Curve / Center\"", "\"top\" lies on the axis"});
  expect_refused("{10, 5, 0}", "{10, 5, 1}", {"not in the plane of the arc", "allowed: (10, 5, 0)"});
}

TEST(SceneParameters, RefusesWrongCurves) {
  expect_refused("{0, 0, 2}", "{0, 0, 0}", {"Curve / Axis", "no direction"});
  expect_refused(text_parameter("Shape", "arc"), text_parameter("Shape", "line"),
                 {"Curve / Center", "has no meaning for \"Shape\" = \"line\""});
  expect_refused(text_parameter("Shape", "arc"), text_parameter("Shape", "helix"), {"Curve / Rise", "missing"});
  expect_refused(text_parameter("Shape", "arc"), text_parameter("Shape", "helx"), {"did you mean \"helix\"?"});
  expect_refused("{0, 1, 0}\"/>\n      </ParameterList>\n      <ParameterList name=\"arch\"",
                 "{2, 0, 0}\"/>\n      </ParameterList>\n      <ParameterList name=\"arch\"",
                 {"scene.xml:25: ", "\"Scene / Members / shaft / Second Axis\"", "parallel to the start tangent"});
}

TEST(SceneParameters, RefusesPointsThatNothingUses) {
  const std::string top = array_parameter("top", "{10, 0, 0}");
  const std::string spare = array_parameter("spare", "{1, 1, 1}");
  expect_refused(top, top + spare, {"scene.xml:16: ", "\"Scene / Points / spare\"", "unused"});
  expect_in(message_of([&] { scene_from(changed(with_support(""), kLoadPoint, text_parameter("Point", "x"))); }),
            {"\"Scene / Point Loads / pull / Point\"", "\"x\" is not a point"});
  const std::string loaded =
      changed(changed(kBowScene, top, top + spare), kLoadPoint, text_parameter("Point", "spare"));
  expect_scene_refused(loaded, {"\"Scene / Point Loads / pull / Point\"", "no member starts or ends there"});
}

TEST(SceneParameters, ReadsSupports) {
  const Scene scene =
      scene_from(with_support("<Parameter name=\"Fixed Rotation\" type=\"Array(string)\" value=\"{x, z}\"/>" +
                              array_parameter("Prescribed Displacement", "{0, 0.5, 0}")));
  EXPECT_TRUE(scene.supports[0].rotation_fixed[0]);
  EXPECT_FALSE(scene.supports[0].rotation_fixed[1]);
  EXPECT_EQ(scene.supports[0].prescribed_displacement[1], 0.5);
}

TEST(SceneParameters, RefusesWrongSupports) {
  const std::string ball = "<Parameter name=\"Fixed Rotation\" type=\"Array(string)\" value=\"{}\"/>";
  const std::string sliding = "<Parameter name=\"Fixed Displacement\" type=\"Array(string)\" value=\"{x, z}\"/>";
  const std::string loose = "<Parameter name=\"Fixed Displacement\" type=\"Array(string)\" value=\"{}\"/>";
  expect_scene_refused(with_support(ball + loose), {"\"Scene / Supports / clamp\"", "fixes nothing"});
  expect_scene_refused(with_support(sliding + array_parameter("Prescribed Displacement", "{0, 1, 0}")),
                       {"Prescribed Displacement", "(0, 1, 0)", "direction y"});
  expect_scene_refused(with_support(ball + array_parameter("Prescribed Rotation", "{0, 0, 1}")),
                       {"Prescribed Rotation", "(0, 0, 1)", "{x, y, z}"});
  expect_scene_refused(with_support("<Parameter name=\"Stage\" type=\"int\" value=\"2\"/>"), {"nothing is prescribed"});
  const std::string second = "</ParameterList><ParameterList name=\"again\">" + kSupportPoint;
  expect_scene_refused(with_support(second),
                       {"\"Scene / Supports / again / Point\"", "\"foot\" is supported by \"clamp\""});
}

TEST(SceneParameters, ReadsFollowerLoads) {
  const Scene scene = scene_from(with_load(text_parameter("Frame", "follower") + text_parameter("Member", "arch")));
  EXPECT_EQ(scene.point_loads[0].frame, LoadFrame::follower);
  EXPECT_EQ(scene.point_loads[0].member, "arch");
}

TEST(SceneParameters, RefusesWrongLoads) {
  const std::string follower = text_parameter("Frame", "follower");
  expect_scene_refused(with_load(follower), {"Point Loads / pull / Member", "missing for a follower load", "\"arch\""});
  expect_scene_refused(with_load(follower + text_parameter("Member", "shaft")),
                       {"value \"shaft\"", "with one end at \"tip\""});
  expect_scene_refused(with_load(follower + text_parameter("Member", "arhc")), {"did you mean \"arch\"?"});
  expect_scene_refused(with_load(text_parameter("Member", "arch")), {"no meaning for \"Frame\" = \"dead\""});
  expect_refused(array_parameter("Force", "{0, 1, 0}"), "", {"\"Scene / Point Loads / pull\"", "loads nothing"});
  expect_refused("{0, 1, 0}\"/>\n      </ParameterList>\n    </ParameterList>\n    <ParameterList name=\"Dist",
                 "{0, 1}\"/>\n      </ParameterList>\n    </ParameterList>\n    <ParameterList name=\"Dist",
                 {"{0, 1} has 2 entries"});
}

TEST(SceneParameters, RefusesGapsBetweenStages) {
  const std::string stage = "name=\"Stage\" type=\"int\" value=\"2\"";
  expect_refused(
      stage, "name=\"Stage\" type=\"int\" value=\"3\"",
      {"scene.xml:54: ", "\"Scene / Distributed Loads / weight / Stage\"", "value 3", "nothing acts in stage 2"});
  expect_refused(stage, "name=\"Stage\" type=\"int\" value=\"0\"", {"value 0", "1 <= value"});
}

TEST(SceneParameters, RefusesMoreElementsThanMemoryCanHold) {
  expect_refused("name=\"Elements\" type=\"int\" value=\"4\"", "name=\"Elements\" type=\"int\" value=\"10000001\"",
                 {"Elements", "10000001"});
  expect_refused("name=\"Elements\" type=\"int\" value=\"4\"", "name=\"Elements\" type=\"int\" value=\"10000000\"",
                 {"\"Scene / Members / arch / Elements\"", "brings the scene to 10000001 elements"});
}

TEST(SceneParameters, ManualNamesEveryList) {
  std::ostringstream out;
  print_parameters(out, scene_spec(), "Scene");
  expect_in(out.str(), {"[Sections]", "[<section>]", "[Points]", "[Members]", "[Curve]", "[Supports]", "[Point Loads]",
                        "[Distributed Loads]", "Force Integration", "[radian]"});
}

}  // namespace
}  // namespace mixbeam
