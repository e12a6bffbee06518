#include "scene_text.hpp"
#include "tests/support/numbers.hpp"

#include <cmath>

namespace mixbeam::scene_members_test {
namespace {

using test::kPi;
constexpr double kRounding = 1e-14;  // of numbers of size 1

const std::string kPoints = "A: [1, 0, 0], B: [-1, 0, 0], ";

Scene with_curve(const std::string& curve_text, const std::string& end = "B", const std::string& more = "",
                 const std::string& points = kPoints) {
  return scene_from(scene_text(points, member("m", "A", end, curve_text + more)));
}
void expect_curve_refused(const std::string& curve_text, const std::vector<std::string>& parts,
                          const std::string& more = "") {
  expect_text_refused(scene_text(kPoints, member("m", "A", "B", curve_text + more)), parts);
}

TEST(SceneMembers, ArcByThreePoints) {
  const Curve half = with_curve(curve("arc", "Through: [0, 1, 0]")).members[0].curve;
  EXPECT_EQ(half.shape, CurveShape::circular_arc);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(half.center[i], 0.0, kRounding);
  EXPECT_NEAR(half.axis[2], 1.0, kRounding);
  EXPECT_NEAR(half.angle, kPi, kRounding);
  // the other way round, and more than half a turn: centre (0, -3/4), radius 5/4
  const Curve below = with_curve(curve("arc", "Through: [0, -2, 0]")).members[0].curve;
  EXPECT_NEAR(below.axis[2], -1.0, kRounding);
  EXPECT_NEAR(below.center[1], -0.75, kRounding);
  EXPECT_NEAR(below.angle, 2.0 * kPi - 2.0 * std::atan2(1.0, 0.75), 4 * kRounding);
  expect_curve_refused(curve("arc", "Through: [0.5, 0, 0]"),
                       {"\"Scene / Members / m / Curve / Through\"", "lie on a line"});
  expect_curve_refused(curve("arc", "Through: [1, 0, 0]"), {"Curve / Through", "coincide"});
  expect_curve_refused(curve("arc", "Through: [0, 1, 0, 0, 2, 0]"), {"2 points", "one point"});
  expect_curve_refused(curve("arc", "Through: [0, 1]"), {"2 numbers", "three coordinates"});
}

TEST(SceneMembers, ArcByRadius) {
  const Curve arc = with_curve(curve("arc", "Axis: [0, 0, -2], Radius: 1.25")).members[0].curve;
  // from (1, 0) to (-1, 0) clockwise, less than half a turn: below the chord, centre above it
  EXPECT_NEAR(arc.center[0], 0.0, kRounding);
  EXPECT_NEAR(arc.center[1], 0.75, kRounding);
  EXPECT_NEAR(arc.angle, 2.0 * std::asin(0.8), kRounding);
  expect_curve_refused(curve("arc", "Axis: [0, 0, 1], Radius: 0.9"), {"Curve / Radius", "the ends are 2 apart"});
  expect_curve_refused(curve("arc", "Axis: [1, 0, 1], Radius: 2"), {"not normal to the axis"});
  const std::string quarter = "Start Tangent: [0, 3, 0], Axis: [0, 0, 1], Radius: 2, Angle: 1.5707963267948966";
  expect_at(with_curve(curve("arc", quarter), "end", "", "A: [1, 0, 0]"), "end", {-1, 2, 0}, kRounding);
}

TEST(SceneMembers, FormsOfCurvesDoNotMix) {
  expect_curve_refused(curve("arc", "Through: [0, 1, 0], Center: [0, 0, 0]"),
                       {"has no meaning for \"Shape\" = \"arc\"", "\"Center\", \"Axis\", \"Angle\"; or \"Through\""});
  expect_curve_refused(curve("spline", ""), {"Curve / Through", "missing; needed for \"Shape\" = \"spline\""});
  expect_curve_refused(curve("polyline", "Through: [0, 1, 0], Corners: [B]"),
                       {"has no meaning for \"Shape\" = \"polyline\""});
  expect_curve_refused(curve("polylne", "Through: [0, 1, 0]"), {"did you mean \"polyline\"?"});
}

TEST(SceneMembers, Polyline) {
  const Scene scene = with_curve(curve("polyline", "Through: [1, 2, 0, -1, 2, 0]"), "B", "Elements: 12, Order: 3");
  ASSERT_EQ(scene.members.size(), 3U);
  EXPECT_EQ(scene.members[0].name, "m[1]");
  EXPECT_EQ(scene.members[1].start_point, "m[1]");
  EXPECT_EQ(scene.members[1].end_point, "m[2]");
  EXPECT_EQ(scene.members[2].end_point, "B");
  EXPECT_EQ(scene.members[2].order, 3);
  for (const Member& line : scene.members) EXPECT_EQ(line.elements, 4);  // three sides of equal length
  expect_at(scene, "m[2]", {-1, 2, 0}, 0.0);
}

TEST(SceneMembers, PolylineSharesElementsByLength) {
  const auto elements = [](const std::string& y, const std::string& more) {
    const Scene scene = with_curve(curve("polyline", "Through: [1, " + y + ", 0, -1, " + y + ", 0]"), "B", more);
    return std::array{scene.members[0].elements, scene.members[1].elements, scene.members[2].elements};
  };
  EXPECT_EQ(elements("0.01", "Elements: 10"), (std::array{1, 8, 1}));
  EXPECT_EQ(elements("2", ""), (std::array{1, 1, 1}));
}

TEST(SceneMembers, TheOnlySectionIsMeantWhereNoneIsNamed) {
  const std::string line = "m: {Start: A, End: B}, ";
  EXPECT_EQ(scene_from(scene_text(kPoints, line)).members[0].section, "flat");
  expect_text_refused(scene_text(kPoints, line, "", "A", "other: {" + kFlatSection + "}"),
                      {"Members / m / Section", "missing section; allowed: \"flat\", \"other\""});
}

TEST(SceneMembers, PolylineThroughNamedPoints) {
  const std::string corner = "corner: [0, 3, 0], ";
  const Scene scene = with_curve(curve("polyline", "Corners: [corner]"), "B", "", kPoints + corner);
  ASSERT_EQ(scene.members.size(), 2U);
  EXPECT_EQ(scene.members[0].end_point, "corner");
  expect_curve_refused(curve("polyline", "Corners: [cornr]"), {"line \"m[1]\"", "\"cornr\" is not a point"});
  expect_curve_refused(curve("polyline", "Through: [1, 0, 0]"), {"line \"m[1]\": no length"});
  expect_curve_refused(curve("polyline", "Through: [0, 1, 0]"), {"m / Twist", "given for a polyline"}, "Twist: 1");
  const std::string taken = kPoints + "'m[1]': [0, 9, 0], ";
  expect_text_refused(scene_text(taken, member("m", "A", "B", curve("polyline", "Through: [0, 1, 0]"))),
                      {"Curve / Through", "\"m[1]\", which exists already"});
}

TEST(SceneMembers, SplineKeepsItsPoints) {
  const Scene scene = with_curve(curve("spline", "Through: [0, 1, 0], Start Tangent: [0, 2, 0]"));
  const Curve& spline = scene.members[0].curve;
  EXPECT_EQ(spline.shape, CurveShape::spline);
  ASSERT_EQ(spline.through.size(), 1U);
  EXPECT_EQ(spline.through[0], (Vector3{0, 1, 0}));
  EXPECT_EQ(spline.end_tangents[0], (Vector3{0, 2, 0}));
  EXPECT_EQ(spline.end_tangents[1], (Vector3{}));
}

const std::string kCircleFormula = "Formula: [cos(t), sin(t), 'min(t, 0)'], ";

TEST(SceneMembers, FormulasPlaceTheirEnd) {
  const Scene scene =
      with_curve(curve("parametric", kCircleFormula + "Range: [0, 1.5707963267948966]"), "end", "", "A: [1, 0, 0]");
  expect_at(scene, "end", {0, 1, 0}, kRounding);
  EXPECT_EQ(scene.members[0].curve.formula[2], "min(t, 0)");
}

TEST(SceneMembers, RefusesWrongFormulas) {
  const auto refused = [](const std::string& inside, const std::vector<std::string>& parts) {
    expect_curve_refused(curve("parametric", inside), parts);
  };
  refused("Formula: [cos(t), sin(t)], ", {"Curve / Formula", "2 entries"});
  refused("Formula: [cos(t), sin(u), 0], ", {"Curve / Formula", "sin(u)", "no formula"});
  refused("Formula: [1/t, 0, 0], ", {"Curve / Formula", "1/t", "t = 0"});
  refused(kCircleFormula + "Range: [1, 1], ", {"Curve / Range", "two different numbers"});
  refused("Formula: [2+t, 0, 0], ", {"m / Start", "formulas begin at (2, 0, 0)"});
  refused("Formula: [1+t, 0, 0], ", {"m / End", "\"B\" is at (-1, 0, 0)", "ends at (2, 0, 0)"});
}

TEST(SceneMembers, InnerPointsArePlacedAndMayCarryMembers) {
  const std::string branch = member("branch", "middle", "top");
  const std::string inner = "Inner Points: {late: 0.75, middle: 0.5}, ";
  const Scene scene = scene_from(scene_text(kPoints + "top: [0, 5, 0], ", branch + member("m", "A", "B", inner)));
  expect_at(scene, "middle", {0, 0, 0}, kRounding);
  expect_at(scene, "late", {-0.5, 0, 0}, kRounding);
  const Member& m = *member_in(scene, "m");
  ASSERT_EQ(m.inner_points.size(), 2U);
  EXPECT_EQ(m.inner_points[0].point, "middle");  // ascending, whatever the order in the file
  EXPECT_EQ(m.inner_points[1].position, 0.75);
  const Scene arc = with_curve(curve("arc", "Through: [0, 1, 0]"), "B", "Inner Points: {quarter: 0.5}");
  expect_at(arc, "quarter", {0, 1, 0}, kRounding);
}

TEST(SceneMembers, RefusesWrongInnerPoints) {
  const auto refused = [](const std::string& inside, const std::vector<std::string>& parts) {
    expect_text_refused(scene_text(kPoints + "C: [0, 1, 0], ",
                                   member("m", "A", "B", "Inner Points: {" + inside + "}") + member("n", "A", "C")),
                        parts);
  };
  refused("p: 1, ", {"Inner Points / p", "value 1", "0 < value < 1"});
  refused("p: 0.5, q: 0.5, ", {"Inner Points / q", "value 0.5"});
  refused("A: 0.5, ", {"Inner Points / A", "an end of the member"});
  refused("C: 0.5, ", {"Inner Points / C", "is at (0, 1, 0)", "passes at (0, 0, 0)"});
}

TEST(SceneMembers, Stations) {
  const Scene scene = with_curve("", "B", "Stations: [0, 0.1, 0.5, 1]");
  EXPECT_EQ(scene.members[0].elements, 3);
  EXPECT_EQ(scene.members[0].stations[1], 0.1);
  expect_curve_refused("", {"m / Elements", "value 2", "4 entries"}, "Stations: [0, 0.1, 0.5, 1], Elements: 2");
  for (const std::string wrong : {"[0, 0.5, 0.1, 1]", "[0.1, 1]", "[1]", "[0, 0.5, 1], Inner Points: {p: 0.4}"})
    expect_curve_refused("", {"m / Stations"}, "Stations: " + wrong);
}

TEST(SceneMembers, TwistAndTaper) {
  const std::string thin = "EA: 5, GA2: 2, GA3: 2.5, GIt: 0.5, EI2: 1, EI3: 1.5, ";
  const std::string wide = "wide: {" + kFlatSection + "}, thin: {" + thin + "}, ";
  const auto text = [&](const std::string& more) {
    return scene_text(kPoints, member("m", "A", "B", more), "", "A", wide);
  };
  const Scene scene = scene_from(text("Twist: -0.5, End Section: wide, Taper: x^2"));
  EXPECT_EQ(scene.members[0].twist, -0.5);
  EXPECT_EQ(scene.members[0].end_section, "wide");
  EXPECT_EQ(scene.members[0].taper, "x^2");
  expect_text_refused(text("End Section: wyde"), {"m / End Section", "did you mean \"wide\"?"});
  expect_text_refused(text("Taper: x"), {"m / Taper", "without \"End Section\""});
  expect_text_refused(text("End Section: wide, Taper: 1/x"), {"m / Taper", "1/x", "x = 0"});
  expect_text_refused(text("End Section: wide, Taper: s"), {"m / Taper", "no formula"});
  expect_text_refused(text("End Section: wide, Taper: x = 1"), {"m / Taper", "assignment", "=="});
  expect_text_refused(text("End Section: thin, Taper: 2*x"),
                      {"m / Taper", "at x = 1 of the taper", "allowed: a positive number"});
  EXPECT_NO_THROW(scene_from(text("End Section: thin, Taper: 1.9*x")));
}

}  // namespace
}  // namespace mixbeam::scene_members_test
