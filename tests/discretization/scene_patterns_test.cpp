#include "scene_text.hpp"

#include "discretization/geometry/isometry.hpp"
#include "discretization/geometry/reference_curve.hpp"
#include "discretization/mesh/mesh.hpp"
#include "discretization/text/number_text.hpp"
#include "kernels/math/vector_algebra.hpp"

#include <cmath>
#include <set>

namespace mixbeam::scene_patterns_test {
namespace {

using namespace vector_algebra;

constexpr double kRounding = 1e-14;  // of numbers of size 1

std::string repeat(const std::string& vector, int count, const std::string& more = "") {
  return "Kind: repeat, Vector: " + vector + ", Count: " + std::to_string(count) + ", " + more;
}
std::string rotate(int count, const std::string& more = "", const std::string& axis = "[0, 0, 1]") {
  return "Kind: rotate, Center: [0, 0, 0], Axis: " + axis + ", Count: " + std::to_string(count) + ", " + more;
}
std::string mirror(const std::string& normal, const std::string& point = "[0, 0, 0]") {
  return "Kind: mirror, Point: " + point + ", Normal: " + normal + ", ";
}
std::string patterns(const std::vector<std::string>& all) {
  std::string inside;
  for (std::size_t i = 0; i < all.size(); ++i) inside += "p" + std::to_string(i + 1) + ": {" + all[i] + "}, ";
  return "Patterns: {" + inside + "}, ";
}

const std::string kCell = "A: [0, 0, 0], B: [1, 0, 0], C: [0, 1, 0], ";
const std::string kCellMembers = member("along", "A", "B") + member("up", "A", "C");

Scene cells(const std::vector<std::string>& all, const std::string& more = "") {
  return scene_from(scene_text(kCell, kCellMembers, patterns(all) + more));
}

void expect_pattern_refused(const std::string& pattern, const std::vector<std::string>& parts) {
  expect_text_refused(scene_text(kCell, kCellMembers, patterns({pattern})), parts);
}

TEST(ScenePatterns, RepeatedCellsConnect) {
  const Scene scene = cells({repeat("[1, 0, 0]", 3)});
  EXPECT_EQ(scene.members.size(), 6U);
  EXPECT_EQ(scene.points.size(), 7U);  // 4 below, 3 above
  EXPECT_EQ(member_in(scene, "along (1)")->start_point, "B");
  EXPECT_EQ(member_in(scene, "along (1)")->end_point, "B (1)");
  EXPECT_EQ(member_in(scene, "along (2)")->start_point, "B (1)");
  EXPECT_EQ(member_in(scene, "up (2)")->end_point, "C (2)");
  expect_at(scene, "B (2)", {3, 0, 0}, 0.0);
}

/// Only a copy ends at "D": that counts as its use, and the copy bears the declared name.
TEST(ScenePatterns, PointsThatOnlyCopiesTouchAreUsed) {
  const std::string far = "D: [3, 0, 0], ", spare = "E: [3, 0, 0.5], ";
  const std::string three = patterns({repeat("[1, 0, 0]", 3)});
  const Scene scene = scene_from(scene_text(kCell + far, kCellMembers, three));
  EXPECT_EQ(member_in(scene, "along (2)")->end_point, "D");
  EXPECT_EQ(position_in(scene, "B (2)"), nullptr);
  expect_text_refused(scene_text(kCell + far, kCellMembers), {"\"Scene / Points / D\"", "unused"});
  expect_text_refused(scene_text(kCell + far + spare, kCellMembers, three), {"\"Scene / Points / E\"", "unused"});
}

TEST(ScenePatterns, TwoRepeatsMakeAGrid) {
  const int nx = 4, ny = 3;
  const Scene scene = cells({repeat("[1, 0, 0]", nx), repeat("[0, 1, 0]", ny)});
  EXPECT_EQ(scene.members.size(), static_cast<std::size_t>(2 * nx * ny));
  EXPECT_EQ(scene.points.size(), static_cast<std::size_t>((nx + 1) * (ny + 1) - 1));  // no far corner
  for (const std::string name : {"up (3, 2)", "up (0, 2)", "up (3)"})
    EXPECT_NE(member_in(scene, name), nullptr) << name;
  std::set<std::string> names;
  for (const Member& m : scene.members) EXPECT_TRUE(names.insert(m.name).second) << m.name;
  EXPECT_EQ(build_mesh(scene).vertices(), static_cast<int>(scene.points.size()));
}

TEST(ScenePatterns, SecondPatternOfOneMemberOnly) {
  const Scene scene = cells(
      {repeat("[0, 0, 1]", 2), repeat("[0, 0, 5]", 2, "Members: [up]"), repeat("[0, 0, 9]", 2, "Members: [along*]")});
  std::set<std::string> names;
  for (const Member& m : scene.members) names.insert(m.name);
  const std::set<std::string> expected = {"along",     "up",           "along (1)",   "up (1)",
                                          "up (0, 1)", "along (0, 1)", "along (1, 1)"};
  EXPECT_EQ(names, expected);
}

/// Hexagons of side 1: one side, turned about the centre, then repeated.
Scene honeycomb(int nx, int ny) {
  const double half = std::sqrt(0.75);
  const auto vector = [](double x, double y) { return "[" + shortest(x) + ", " + shortest(y) + ", 0]"; };
  return scene_from(scene_text("A: [1, 0, 0], B: " + vector(0.5, half) + ", ", member("side", "A", "B"),
                               patterns({rotate(6), repeat(vector(1.5, half), nx), repeat(vector(0, 2 * half), ny)})));
}

TEST(ScenePatterns, HoneycombSharesItsEdges) {
  const Scene one = honeycomb(2, 2);
  // Euler: a sheet of F = 4 cells has V - E + F = 1; four cells in a rhombus share 5 edges
  EXPECT_EQ(one.members.size(), 6U * 4U - 5U);
  EXPECT_EQ(one.points.size(), one.members.size() + 1U - 4U);
  const Scene large = honeycomb(20, 10);
  EXPECT_EQ(large.points.size(), large.members.size() + 1U - 200U);
  for (const Member& m : large.members) {
    const double length = norm(difference(*position_in(large, m.start_point), *position_in(large, m.end_point)));
    EXPECT_NEAR(length, 1.0, 1e-12);  // coordinates up to 50 with 17 digits
  }
}

TEST(ScenePatterns, WholeTurnClosesOnItself) {
  const Scene scene = scene_from(
      scene_text("A: [1, 0, 0], ",
                 member("m", "A", "B", curve("arc", "Center: [0, 0, 0], Axis: [0, 0, 1], Angle: 0.8975979010256552")),
                 patterns({rotate(7)})));
  EXPECT_EQ(scene.members.size(), 7U);  // angle 2 pi / 7
  EXPECT_EQ(scene.points.size(), 7U);
  EXPECT_EQ(member_in(scene, "m (6)")->end_point, "A");
  EXPECT_EQ(build_mesh(scene).vertices(), 7);
}

TEST(ScenePatterns, RotationByAngle) {
  const Scene scene = cells({rotate(2, "Angle: -1.5707963267948966, Members: [along]")});
  expect_at(scene, "B (1)", {0, -1, 0}, 0.0);
  EXPECT_EQ(member_in(scene, "along (1)")->start_point, "A");  // on the axis: stays
}

ReferenceCurve curve_of(const Scene& scene, const Member& m) {
  return make_reference_curve(m, *position_in(scene, m.start_point), *position_in(scene, m.end_point));
}

/// The copy "m (1)" has its centerline and the axes of its sections where the motion takes those of "m"; a reflection
/// turns axis 3 round.
void expect_image(const Scene& scene, const Isometry& motion, double tolerance, const std::string& member_text) {
  const Member &m = *member_in(scene, "m"), &copy = *member_in(scene, "m (1)");
  const ReferenceCurve curve = curve_of(scene, m), image = curve_of(scene, copy);
  for (const double x : {0.0, 0.3, 0.5, 1.0}) {
    SCOPED_TRACE(member_text + ", x = " + std::to_string(x));
    const Vec3<double> from = curve.position(x * curve.length), place = image.position(x * image.length);
    const Vector3 expected = motion.position({from[0], from[1], from[2]});
    const Mat3<double> original = rotation_matrix(curve.triad(x * curve.length)),
                       triad = rotation_matrix(image.triad(x * image.length));
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const int a = static_cast<int>(axis);
      EXPECT_NEAR(place[a], expected[axis], tolerance);
      const Vector3 direction = motion.direction({original(0, a), original(1, a), original(2, a)});
      const double sign = motion.mirrors() && axis == 2 ? -1.0 : 1.0;
      for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(triad(static_cast<int>(i), a), sign * direction[i], tolerance);
    }
  }
}

const std::string kOblique = "[1, 2, -0.5]";
const std::string kAside = "[7, 1, -4]";
const Vector3 kObliqueVector = {1, 2, -0.5}, kAsideVector = {7, 1, -4};

void expect_images(const std::string& member_text, double tolerance) {
  const std::string points = "A: [1, 0, 0], B: [-1, 0.5, 2], ";
  const Scene mirrored = scene_from(scene_text(points, member_text, patterns({mirror(kOblique, kAside)})));
  expect_image(mirrored, Isometry::reflection(kAsideVector, kObliqueVector), tolerance, member_text);
  const std::string turned = "Kind: rotate, Center: " + kAside + ", Axis: " + kOblique + ", Angle: 0.7, Count: 2, ";
  expect_image(scene_from(scene_text(points, member_text, patterns({turned}))),
               Isometry::rotation(kAsideVector, kObliqueVector, 0.7), tolerance, member_text);
}

constexpr double kImageTolerance = 1e-13;  // coordinates of size 10, some ten operations
constexpr double kIntegrated = 1e-11;      // the same where the arc length is integrated

TEST(ScenePatterns, ImagesOfCurvesOfEveryKind) {
  const std::string arc = curve("arc", "Through: [0, 1, 3]"), axis = "Second Axis: [3, 1, 1]";
  const std::string helix = curve("helix", "Center: [0, 0.2, 0], Axis: [0.1, 0, 1], Angle: 4, Rise: -1.5");
  const std::string chord = member("c", "A", "B");
  for (const std::string& text :
       {member("m", "A", "B"), member("m", "A", "B", axis + ", Twist: 0.4"), member("m", "A", "B", arc),
        member("m", "A", "B", arc + axis), member("m", "A", "end", helix) + chord,
        member("m", "A", "end", helix + axis) + chord})
    expect_images(text, kImageTolerance);
  const std::string spline = curve("spline", "Through: [0, 1, 3, -1, 2, 1], End Tangent: [1, 0, 1]");
  expect_images(member("m", "A", "B", spline + "Twist: -0.3"), kIntegrated);
  expect_images(member("m", "A", "end", curve("parametric", "Formula: [cos(t), t^2/2, sin(t)+t]")) + chord,
                kIntegrated);
}

TEST(ScenePatterns, MembersInTheMirrorPlaneStayOne) {
  const Scene scene = cells({mirror("[1, 0, 0]")});
  EXPECT_EQ(scene.members.size(), 3U);
  EXPECT_EQ(scene.points.size(), 4U);
  EXPECT_EQ(member_in(scene, "up (1)"), nullptr);
  expect_at(scene, "B (1)", {-1, 0, 0}, 0.0);
}

TEST(ScenePatterns, MirroredStressPointsAndInertiaProducts) {
  const std::string named =
      "named: {EA: 10, GA2: 5, GA3: 5, GIt: 3, EI2: 4, EI3: 4, Mass: 1, Rotary Inertia: [3, 1, 2], Inertia Product: "
      "0.5, "
      "Stress Points: {E: 1, Points: {edge: [0.1, 0.2]}}}, ";
  const std::string text = "m: {Start: A, End: B, Section: named}, " + member("up", "A", "C");
  const Scene scene = scene_from(scene_text(kCell, text, patterns({mirror("[1, 0, 0]", "[5, 0, 0]")}), "A", named));
  const Section* image = nullptr;
  for (const Section& s : scene.sections)
    if (s.name == member_in(scene, "m (1)")->section) image = &s;
  ASSERT_NE(image, nullptr);
  EXPECT_EQ(image->stress_points->points[0].at, (std::array<double, 2>{0.1, -0.2}));
  EXPECT_EQ(image->inertia_product, -0.5);
}

TEST(ScenePatterns, MembersWithStressPointsInTheMirrorPlaneStayOne) {
  const std::string named =
      "named: {EA: 10, GA2: 5, GA3: 5, GIt: 3, EI2: 4, EI3: 4, Stress Points: {E: 1, Points: {edge: [0.1, 0.2]}}}, ";
  const std::string text = member("along", "A", "B") + "up: {Start: A, End: C, Section: named}, ";
  const Scene scene = scene_from(scene_text(kCell, text, patterns({mirror("[1, 0, 0]")}), "A", named));
  EXPECT_EQ(member_in(scene, "up (1)"), nullptr);
  EXPECT_EQ(member_in(scene, "up")->section, "named");
}

const std::string kCoupled = "skew: {Matrix: [10,0,0.1,0.2,0,0.3, 5,0,0,0,0, 6,0,0,0, 3,0.4,0.5, 4,0.6, 5]}, ";

TEST(ScenePatterns, MirroredCouplingChangesItsSign) {
  const std::string text = "m: {Start: A, End: B, Section: skew}, " + member("up", "A", "C");
  const Scene scene = scene_from(scene_text(
      kCell, text, patterns({mirror("[1, 0, 0]", "[5, 0, 0]"), mirror("[0, 1, 0]", "[0, 5, 0]")}), "A", kCoupled));
  const Member& copy = *member_in(scene, "m (1)");
  EXPECT_EQ(copy.section, "skew (mirrored)");
  EXPECT_EQ(member_in(scene, "m (1, 1)")->section, "skew");  // twice mirrored
  EXPECT_EQ(member_in(scene, "up (1)")->section, "flat");
  const Section* section = nullptr;
  for (const Section& s : scene.sections)
    if (s.name == copy.section) section = &s;
  ASSERT_NE(section, nullptr);
  const Matrix6& c = *section->matrix;
  // couplings of one even strain (gamma_1, gamma_2, kappa_3) with an odd one change, the others stay
  EXPECT_EQ((std::array{c[0][2], c[0][3], c[0][5], c[3][4], c[3][5], c[4][5]}),
            (std::array{-0.1, -0.2, 0.3, 0.4, -0.5, -0.6}));
}

TEST(ScenePatterns, CopiesOfInnerPoints) {
  const Scene scene =
      scene_from(scene_text(kCell, member("along", "A", "B", "Inner Points: {mid: 0.5}") + member("up", "A", "C"),
                            patterns({repeat("[0, 1, 0]", 2)})));
  EXPECT_EQ(member_in(scene, "along (1)")->inner_points[0].point, "mid (1)");
  expect_at(scene, "mid (1)", {0.5, 1, 0}, kRounding);
}

/// An entry acts once at each place, whether its name reaches a copy or the pattern brings it there.
TEST(ScenePatterns, WhatActsGoesWithTheCopies) {
  const std::string all = "Copy: all, ";
  const auto acting = [&](const std::string& pattern, const std::string& loads) { return cells({pattern}, loads); };
  const auto load = [](const std::string& point) {
    return "Point Loads: {p: {Point: " + point + ", Force: [1, 0, 0]}}, ";
  };
  EXPECT_EQ(acting(repeat("[1, 0, 0]", 3), load("C")).point_loads.size(), 1U);
  const Scene repeated = acting(repeat("[1, 0, 0]", 3, all), load("C"));
  ASSERT_EQ(repeated.point_loads.size(), 3U);
  EXPECT_EQ(repeated.point_loads[2].point, "C (2)");
  EXPECT_EQ(repeated.supports.size(), 3U);  // of A, at A, B, B (1)
  EXPECT_EQ(acting(repeat("[1, 0, 0]", 3, all), load("C*")).point_loads.size(), 3U);
  const Scene turned = acting(rotate(4, all), load("B"));
  ASSERT_EQ(turned.point_loads.size(), 4U);
  EXPECT_NEAR(turned.point_loads[1].force[1], 1.0, kRounding);
  EXPECT_EQ(turned.supports.size(), 1U);  // of A, on the axis
}

/// Turns of the ends of a member are curvatures; a mirror image turns the other way about axes 1 and 2, as its axis 3
/// is the opposite of the image of axis 3.
TEST(ScenePatterns, TurnsOfEndsGoWithTheCopies) {
  const std::string turns = "Eigenstrains: {kink: {Member: up, Start Turn: [0.1, 0.2, 0.3], End Turn: [0, 0, 1]}}, ";
  for (const std::string& pattern : {repeat("[1, 0, 0]", 2), rotate(3), mirror("[1, 0, 0]", "[1, 0, 0]")}) {
    const Scene scene = cells({pattern + "Copy: all, "}, turns);
    ASSERT_GE(scene.eigenstrains.size(), 2U) << pattern;
    const double sign = pattern.find("mirror") == std::string::npos ? 1.0 : -1.0;
    EXPECT_EQ(scene.eigenstrains[1].member, "up (1)");
    EXPECT_EQ(scene.eigenstrains[1].end_turns[0], (Vector3{sign * 0.1, sign * 0.2, 0.3})) << pattern;
    EXPECT_EQ(scene.eigenstrains[1].end_turns[1], (Vector3{sign * 0.0, sign * 0.0, 1.0})) << pattern;
  }
  EXPECT_EQ(cells({repeat("[1, 0, 0]", 2)}, turns).eigenstrains.size(), 1U);
}

TEST(ScenePatterns, JointsGoWithTheirMembers) {
  const std::string joint = "Joints: {j: {Point: A, Members: [up], Kind: hinge, Axis: [1, 0, 0]}}, ";
  const Scene scene = cells({rotate(3, "Copy: all")}, joint);
  ASSERT_EQ(scene.joints.size(), 3U);
  EXPECT_EQ(scene.joints[1].point, "A");
  EXPECT_EQ(scene.joints[1].members, std::vector<std::string>{"up (1)"});
  EXPECT_NEAR(scene.joints[1].axis[1], std::sqrt(0.75), kRounding);
  const auto copies = [&](const std::string& what) {
    const Scene made = cells({repeat("[1, 0, 0]", 3, "Members: [up], Copy: " + what)}, joint);
    return std::pair(made.joints.size(), made.supports.size());
  };
  EXPECT_EQ(copies("members"), std::pair(std::size_t{1}, std::size_t{1}));
  EXPECT_EQ(copies("joints"), std::pair(std::size_t{2}, std::size_t{1}));
  EXPECT_EQ(copies("all"), std::pair(std::size_t{2}, std::size_t{3}));
}

/// Three cells in a row, each hinged to the one before: behind the last there is none.
TEST(ScenePatterns, WhatHasNoMembersWhereThePatternEndsIsLeftOut) {
  const std::string joint = "Joints: {j: {Point: B, Members: [along], Kind: hinge, Axis: [0, 0, 1]}}, ";
  std::vector<std::string> notes;
  const auto read = [&](const std::string& text) {
    XmlParameters file = parsed(text);
    return read_scene(file.list->sublist("Scene"), file.source, {"Scene"}, {&notes});
  };
  const Scene scene = read(scene_text(kCell, kCellMembers, patterns({repeat("[1, 0, 0]", 3, "Copy: all")}) + joint));
  ASSERT_EQ(scene.joints.size(), 2U);
  EXPECT_EQ(scene.joints[1].point, "B (1)");
  EXPECT_EQ(scene.joints[1].members, std::vector<std::string>{"along (1)"});
  ASSERT_EQ(notes.size(), 1U);
  expect_in(notes[0], {"Joints / j", "\"B (2)\"", "no members there"});
  expect_text_refused(changed(scene_text(kCell, kCellMembers, joint), "Point: B, M", "Point: C, M"), {"Joints / j"});
  const std::string load = "Point Loads: {p: {Point: A, Force: [1, 0, 0], Frame: follower, Member: along}}, ";
  const std::string columns = patterns({repeat("[1, 0, 0]", 2, "Members: [up], Copy: all")});
  const Scene loaded = read(scene_text(kCell, kCellMembers, columns + load));
  EXPECT_EQ(loaded.point_loads.size(), 1U);
  ASSERT_EQ(notes.size(), 1U);
  expect_in(notes[0], {"Point Loads / p", "\"B\"", "\"along\"", "turns with"});
}

TEST(ScenePatterns, TwoSupportsOfOnePointAreRefused) {
  const std::string text = scene_text(kCell, kCellMembers, patterns({repeat("[1, 0, 0]", 2, "Copy: all")}));
  expect_text_refused(changed(text, "Supports: {", "Supports: {right: {Point: B}, "),
                      {"Scene / Supports / clamp", "\"B\" is supported by \"right\""});
}

TEST(ScenePatterns, CoincidingMembersMustAgree) {
  const std::string other = member("over", "B", "D", "Elements: 2");
  expect_text_refused(
      scene_text(kCell + "D: [2, 0, 0], ", kCellMembers + other,
                 patterns({repeat("[1, 0, 0]", 2, "Members: [along]")})),
      {"\"Scene / Patterns / p1\"", "\"along (1)\" would lie on member \"over\"", "differ from it in \"Elements\""});
  const Scene same = scene_from(scene_text(kCell + "D: [2, 0, 0], ", kCellMembers + member("over", "D", "B"),
                                           patterns({repeat("[1, 0, 0]", 2, "Members: [along]")})));
  EXPECT_EQ(same.members.size(), 3U);
}

TEST(ScenePatterns, RefusesWrongPatterns) {
  expect_pattern_refused("Kind: repeat, Count: 2, ", {"p1 / Vector", "missing; needed for"});
  expect_pattern_refused(repeat("[1, 0, 0]", 1), {"p1 / Count", "value 1"});
  expect_pattern_refused(repeat("[0, 0, 0]", 2), {"p1 / Vector", "no direction"});
  expect_pattern_refused(repeat("[1, 0, 0]", 2, "Normal: [1, 0, 0]"), {"p1 / Normal", "no meaning"});
  expect_pattern_refused(repeat("[1, 0, 0]", 2, "Members: [alog]"),
                         {"p1 / Members", "\"alog\" is not a member", "did you mean \"along\"?"});
  expect_pattern_refused(repeat("[1, 0, 0]", 2, "Members: [x*]"), {"p1 / Members", "\"x*\""});
  expect_text_refused(
      scene_text(kCell, kCellMembers + member("along (1)", "B", "C"), patterns({repeat("[0, 0, 1]", 2)})),
      {"\"along (1)\", which exists already"});
  expect_pattern_refused("Kind: rotat, ", {"did you mean \"rotate\"?"});
  expect_pattern_refused(rotate(3, "", "[0, 0, 0]"), {"p1 / Axis", "no direction"});
  expect_pattern_refused(repeat("[1, 0, 0]", 2, "Point: [0, 0, 0]"), {"p1 / Point", "no meaning"});
}

TEST(ScenePatterns, RefusesMoreThanMemoryHolds) {
  expect_pattern_refused(repeat("[1, 0, 0]", 10000000), {"elements", "allowed: 10000000"});
  expect_text_refused(scene_text(kCell, kCellMembers, patterns({repeat("[1, 0, 0]", 3000), repeat("[0, 1, 0]", 3000)})),
                      {"\"Scene / Patterns / p2\"", "elements"});
  expect_pattern_refused(repeat("[1e99, 0, 0]", 1000), {"coordinates"});
}

}  // namespace
}  // namespace mixbeam::scene_patterns_test
