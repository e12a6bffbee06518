#include "discretization/checks/mechanism.hpp"

#include "input_text.hpp"
#include "kernels/math/vector_algebra.hpp"
#include "tests/support/buckling_scenes.hpp"
#include "tests/support/processor_time.hpp"

#include <set>

namespace mixbeam {
namespace {

constexpr std::array<bool, 3> kAll = {true, true, true}, kNone = {}, kAboutZ = {true, true, false};

Member line(const std::string& start, const std::string& end) {
  Member member;
  member.name = start + "-" + end;
  member.start_point = start;
  member.end_point = end;
  return member;
}

using test::support;
using Rows = std::vector<std::pair<Scene, std::vector<std::string>>>;

/// A straight beam from a to b along (1, 2, 2), of length 3.
Scene beam(const std::vector<Support>& supports) {
  return test::structure({{"a", {5, 0, 0}}, {"b", {6, 2, 2}}}, {line("a", "b")}, supports);
}

std::string refusal(const Scene& scene) {
  return message_of([&] { check_supports(scene, ParameterSource("scene.xml")); });
}

void expect_held(const Scene& scene) { EXPECT_EQ(check_supports(scene, ParameterSource("scene.xml")), ""); }

TEST(MechanismCheck, AcceptsWhatIsHeld) {
  expect_held(beam({support("a", kAll, kAll)}));
  // Two ball joints leave the spin about the beam's own axis, which one more rotation component stops.
  expect_held(beam({support("a", kAll, kAboutZ), support("b", kAll, kNone)}));
  Scene three_balls = beam({support("a", kAll, kNone), support("b", kAll, kNone), support("c", kAll, kNone)});
  three_balls.points.push_back({"c", {0, 0, 1}});
  three_balls.members.push_back(line("b", "c"));
  expect_held(three_balls);
  Scene inner = beam({support("m", kAll, kAll)});
  inner.points.push_back({"m", {5.5, 1, 1}});
  EXPECT_NE(refusal(inner), "");  // a point of its own
  inner.members[0].inner_points = {{"m", 0.5}};
  expect_held(inner);
  inner.points.pop_back();
  expect_held(inner);
}

TEST(MechanismCheck, NamesTheMotionsOfABeam) {
  const Support ball_a = support("a", kAll, kNone), ball_b = support("b", kAll, kNone);
  for (const auto& [scene, parts] :
       Rows{{beam({support("a", {true, false, true}, kAll)}),
             {"scene.xml", "XML path \"Scene / Supports\"", "member \"a-b\"", "1 way", "translation along (0, 1, 0)",
              "point \"a\" moves most"}},
            {beam({support("a", kAll, kAboutZ)}),  // a hinge about z at a: the other end swings
             {"1 way", "rotation about (0, 0, 1) through (5, 0, ", "point \"b\" moves most"}},
            {beam({ball_a, ball_b}),
             {"1 way", "rotation about (0.333333, 0.666667, 0.666667)", "all its points lie on this axis"}},
            {beam({}),
             {"6 ways", "rotation about (1, 0, 0)", "rotation about (0, 1, 0)", "rotation about (0, 0, 1)",
              "translation along (1, 0, 0)", "translation along (0, 0, 1)"}},
            {beam({ball_a}), {"3 ways"}}})
    expect_in(refusal(scene), parts);
}

TEST(MechanismCheck, NamesThePartThatIsNotHeld) {
  Scene scene = beam({support("a", kAll, kAll)});
  // c is at the same place as a, but another point: not joined
  scene.points.insert(scene.points.end(), {{"c", {5, 0, 0}}, {"d", {5, 0, 9}}, {"e", {5, 3, 9}}});
  scene.members.insert(scene.members.end(), {line("c", "d"), line("d", "e")});
  expect_in(refusal(scene), {"connected members \"c-d\", \"d-e\"", "6 ways"});
  for (int i = 0; i < 7; ++i) {  // the motions are to be read, not the names of all
    const std::string end = "end " + std::to_string(i);
    scene.points.push_back({end, {6.0 + i, 3, 9}});
    scene.members.push_back(line("e", end));
  }
  expect_in(refusal(scene), {"\"e-end 3\" and 3 more can move without strain in 6 ways"});
}

/// Islands of an imported network: the first in full, a member of each other one.
TEST(MechanismCheck, NamesEveryPartThatIsNotHeld) {
  Scene scene = beam({support("a", kAll, kAll)});
  scene.points.insert(scene.points.end(),
                      {{"c", {0, 0, 1}}, {"d", {0, 1, 1}}, {"e", {9, 0, 1}}, {"f", {9, 1, 1}}, {"g", {9, 2, 5}}});
  scene.members.insert(scene.members.end(), {line("c", "d"), line("e", "f"), line("f", "g")});
  expect_in(refusal(scene), {"member \"c-d\" can move without strain in 6 ways",
                             "; one more connected part is not supported either, with member \"e-f\"; allowed: "});
  scene.supports.push_back(support("f", kAll, kAll));
  EXPECT_EQ(refusal(scene).find("one more"), std::string::npos);
}

/// Of a rigid body at a point.
Vector3 velocity(const RigidVelocity& of, const Vector3& at) {
  using namespace vector_algebra;
  return sum(of.translation, cross(of.rotation, difference(at, of.center)));
}

/// A beam that swings about z at a (5, 0, 0): b (6, 2, 2) moves along (-2, 1, 0), a not at all; beside it one that is
/// held, and one on nothing.
TEST(MechanismCheck, GivesTheMotionsThatItRefuses) {
  using namespace vector_algebra;
  constexpr double kRoundingOfMotions = 1e-12;  // of points and motions of order one
  Scene scene = beam({support("a", kAll, {true, true, false})});
  LooseStructure loose = loose_structure(scene);
  ASSERT_EQ(loose.motions.size(), 1u);
  const RigidVelocity& swing = loose.motions[0][0];
  EXPECT_LT(norm(velocity(swing, {5, 0, 0})), kRoundingOfMotions);
  const Vector3 tip = velocity(swing, {6, 2, 2});
  EXPECT_GT(norm(tip), 0.1);
  EXPECT_LT(norm(cross(tip, {-2, 1, 0})), kRoundingOfMotions);
  scene.points.insert(scene.points.end(), {{"c", {0, 0, 1}}, {"d", {0, 1, 1}}, {"e", {9, 0, 1}}, {"f", {9, 1, 1}}});
  scene.members.insert(scene.members.end(), {line("c", "d"), line("e", "f")});
  scene.supports.push_back(support("c", kAll, kAll));
  loose = loose_structure(scene);
  EXPECT_EQ(loose.motions.size(), 1u + 6u);
  EXPECT_EQ(std::set<int>(loose.part_of_member.begin(), loose.part_of_member.end()).size(), 3u);
  for (const auto& motion : loose.motions) EXPECT_LT(norm(velocity(motion[1], {0, 1, 1})), kRoundingOfMotions);
  EXPECT_TRUE(loose_structure(beam({support("a", kAll, kAll)})).motions.empty());
}

TEST(MechanismCheck, DoesNotDependOnScaleOrPlace) {
  for (const double scale : {1e-9, 1.0, 1e9})
    for (const double shift : {0.0, 1e3}) {
      Scene free_to_spin = beam({support("a", kAll, kNone), support("b", kAll, kNone)});
      Scene held = beam({support("a", kAll, kAll)});
      for (Scene* const scene : {&free_to_spin, &held})
        for (Point& p : scene->points)
          for (double& x : p.position) x = scale * (x + shift);
      SCOPED_TRACE("scale " + std::to_string(scale) + ", shift " + std::to_string(shift));
      expect_in(refusal(free_to_spin), {"1 way", "rotation about (0.333333, 0.666667, 0.666667)"});
      expect_held(held);
    }
}

TEST(MechanismCheck, ChecksAClosedRingOfOnePoint) {
  Scene scene = test::structure({{"a", {1, 0, 0}}}, {line("a", "a")}, {support("a", kAll, kAll)});
  scene.members[0].curve = Curve{CurveShape::circular_arc, {0, 0, 0}, {0, 0, 1}, 2.0 * M_PI, 0.0};
  expect_held(scene);
  scene.supports = {support("a", kAll, kNone)};
  expect_in(refusal(scene), {"3 ways"});
}

Joint joint(JointKind kind, const std::string& at, const std::string& member, const Vector3& axis = {0, 0, 1}) {
  return test::joint(kind, at, {member}, axis);
}

/// Two posts a-b and d-c clamped at a and d, and a bar b-c between them.
Scene portal(const std::vector<Joint>& joints) {
  Scene scene = test::structure({{"a", {0, 0, 0}}, {"b", {0, 3, 0}}, {"c", {4, 3, 0}}, {"d", {4, 0, 0}}},
                                {line("a", "b"), line("b", "c"), line("d", "c")},
                                {support("a", kAll, kAll), support("d", kAll, kAll)});
  scene.joints = joints;
  return scene;
}

TEST(MechanismCheck, ABarBetweenBallJointsSpins) {
  expect_held(portal({joint(JointKind::ball, "b", "b-c"), joint(JointKind::hinge, "c", "b-c")}));
  expect_in(refusal(portal({joint(JointKind::ball, "b", "b-c"), joint(JointKind::ball, "c", "b-c")})),
            {"connected members \"a-b\", \"b-c\", \"d-c\"", "1 way", "member \"b-c\" by rotation about (1, 0, 0)",
             "all its points lie on this axis, about which it rotates", "springs and joints"});
}

TEST(MechanismCheck, FourBarsAreAMechanism) {
  Scene scene = portal({joint(JointKind::hinge, "b", "b-c"), joint(JointKind::hinge, "c", "b-c")});
  expect_held(scene);
  scene.supports = {support("a", kAll, kAboutZ), support("d", kAll, kAboutZ)};
  expect_in(refusal(scene), {"1 way", "others with it through the joints"});
  scene.joints[0].stiffness = 1.0;
  expect_held(scene);
  scene.joints[0].stiffness = 0.0;
  scene.supports[0].rotation_stiffness = {0, 0, 1};
  expect_held(scene);
}

/// Two bars cross at a pin p, on hinges at a and b. Halves that the pin joins one by one fold.
TEST(MechanismCheck, AScissorFoldsUnlessHalvesStayTogether) {
  Scene scene =
      test::structure({{"a", {0, 0, 0}}, {"b", {4, 0, 0}}, {"c", {4, 3, 0}}, {"d", {0, 3, 0}}, {"p", {2, 1.5, 0}}},
                      {line("a", "p"), line("p", "c"), line("b", "p"), line("p", "d")},
                      {support("a", kAll, kAboutZ), support("b", kAll, kAboutZ)});
  scene.joints = {joint(JointKind::hinge, "p", "b-p")};
  scene.joints[0].members = {"b-p", "p-d"};
  expect_in(refusal(scene), {"1 way", "member \"p-d\" by rotation about (0, 0, 1) through (2, 1.5, 0)"});
  scene.joints[0].together = true;
  expect_held(scene);
  scene.supports[1].displacement_fixed = {false, true, true};
  expect_in(refusal(scene), {"1 way", "others with it through the joints"});
}

TEST(MechanismCheck, SlidersSlideAlongTheirAxis) {
  Scene scene = portal({joint(JointKind::slider, "b", "b-c", {1, 0, 0})});
  expect_held(scene);
  scene.supports.pop_back();
  expect_in(refusal(scene), {"members \"b-c\", \"d-c\" by translation along (1, 0, 0)"});
}

TEST(MechanismCheck, SupportsHoldAlongTheirAxes) {
  Scene scene = beam({support("a", {true, true, false}, kAll)});
  scene.supports[0].axes = {{{0, 0.6, 0.8}, {1, 0, 0}, {0, 0.8, -0.6}}};
  expect_in(refusal(scene), {"1 way", "translation along (0, 0.8, -0.6)"});
  scene.supports[0].displacement_stiffness = {0, 0, 1};
  expect_held(scene);
}

TEST(MechanismCheck, TellsWhenThereAreTooManyJoinedParts) {
  constexpr int kBars = 400;
  Scene scene;
  scene.points = {{"p0", {0, 0, 0}}};
  for (int i = 1; i <= kBars; ++i) {
    scene.points.push_back({"p" + std::to_string(i), {1.0 * i, 0, 0}});
    scene.members.push_back(line(scene.points[i - 1].name, scene.points[i].name));
    if (i > 1) scene.joints.push_back(joint(JointKind::hinge, scene.points[i - 1].name, scene.members.back().name));
  }
  EXPECT_THROW(check_supports(scene, ParameterSource("scene.xml")), InputError);
  scene.supports = {support("p0", kAll, kAll)};
  expect_in(check_supports(scene, ParameterSource("scene.xml")), {"was not checked", "400 parts"});
}

/// At one corner of a lattice hangs an arm that swings: its members are named, in well below a second.
TEST(MechanismCheck, NamesAnArmAtACornerOfALattice) {
  constexpr int kPoints = 16;
  Scene scene = test::lattice(kPoints);
  const std::string corner = "15,15,15";
  scene.points.insert(scene.points.end(), {{"elbow", {16, 15, 15}}, {"hand", {16, 16, 15}}});
  scene.members.insert(scene.members.end(), {line(corner, "elbow"), line("elbow", "hand")});
  EXPECT_GT(scene.members.size(), 10000U);
  expect_held(scene);
  scene.joints = {{"pin", corner, {corner + "-elbow"}, JointKind::ball, {}}};
  EXPECT_LT(processor_seconds([&] {
              expect_in(refusal(scene), {"in 3 ways", "members \"15,15,15-elbow\", \"elbow-hand\" by rotation"});
            }),
            5.0);
}

TEST(MechanismCheck, TakesAHundredThousandMembers) {
  constexpr int kMembers = 100000;
  Scene scene;
  for (int i = 0; i <= kMembers; ++i) {
    scene.points.push_back({"p" + std::to_string(i), {1.0 * i, std::sin(i), std::cos(i)}});
    if (i > 0) scene.members.push_back(line(scene.points[i - 1].name, scene.points[i].name));
  }
  scene.supports = {support("p0", kAll, kAboutZ)};
  EXPECT_LT(processor_seconds([&] {
              expect_in(refusal(scene), {"and 99994 more", "rotation about (0, 0, 1)", "point \"p100000\" moves most"});
            }),
            10.0);  // far above the 0.2 s that it takes; quadratic time would need minutes
}

TEST(MechanismCheck, FindsTheLineOfTheSupportsInTheFile) {
  XmlParameters xml = parsed(changed(kBowScene, "Point: foot", "Point: foot, Fixed Rotation: []"));
  expect_in(message_of([&] { read_scene(xml.list->sublist("Scene"), xml.source); }),
            {"scene.yaml:15:3: YAML path \"Scene / Supports\"", "\"shaft\", \"arch\"", "3 ways"});
}

}  // namespace
}  // namespace mixbeam
