/// What patterns copy along with members: the answer of a copy is the image of the answer of the original.
#include "discretization/geometry/isometry.hpp"
#include "tests/support/scene_file.hpp"
#include "tests/support/solve.hpp"
#include "tests/support/text.hpp"

namespace mixbeam::test::copied_conditions {
namespace {

constexpr double kRounding = 1e-11;  // of displacements of size 0.1: components are turned before they are added

/// A bent cantilever "a", "b" with a hinge between them that has a spring, an elastic support at its end, loads of
/// every kind and eigenstrains; and one pattern.
Scene frame(const std::string& pattern) {
  return scene_of_text(R"yaml(Scene:
  Sections: {s: {EA: 1e3, GA2: 4e2, GA3: 5e2, GIt: 1, EI2: 2, EI3: 3}}
  Points: {A: [0.3, 0.2, 0.1], B: [1.3, 0.4, 0.3], C: [1.5, 1.4, 0.5]}
  Members:
    a: {Start: A, End: B, Section: s, Elements: 4, Order: 3}
    b: {Start: B, End: C, Section: s, Elements: 4, Order: 3}
  Supports:
    foot: {Point: A}
    springs: {Point: C, Fixed Displacement: [], Fixed Rotation: [], Displacement Stiffness: [1, 2, 0.5],
              Axes: [1, 1, 0, 0, 1, 1]}
  Joints:
    hinge: {Point: B, Members: [b], Kind: hinge, Axis: [0, 1, 1], Stiffness: 2}
  Point Loads:
    dead: {Point: C, Force: [0.02, 0.03, -0.05], Moment: [0.01, 0.02, 0.03]}
    follower: {Point: C, Force: [0.01, 0.02, 0.04], Moment: [0.02, -0.01, 0.03], Frame: follower, Member: b}
  Distributed Loads:
    part: {Member: a, Force: [0.1, -0.2, 0.1], Range: [0.3, 0.8]}
    formula: {Member: b, Force Formula: [0.1*x, 0.2*sin(x), 0.05], Couple Formula: [0.02, 0.01*x, 0]}
    wind: {Member: b, Force: [0.03, 0.02, 0.05], Frame: follower}
  Eigenstrains:
    growth: {Member: a, Strain: [0.01, 0.02, 0.03], Curvature: [0.02, 0.1, 0.2]}
  Patterns:
    p: {)yaml" + pattern +
                       "}\n");
}

TEST(CopiedConditions, AnswersAreImages) {
  const Vector3 center{-0.5, 0.2, 0.1}, axis{1, 2, 3};
  const double angle = 1.1;
  const std::vector<std::pair<std::string, Isometry>> cases = {
      {"Kind: rotate, Center: [-0.5, 0.2, 0.1], Axis: [1, 2, 3], Angle: 1.1, Count: 2",
       Isometry::rotation(center, axis, angle)},
      {"Kind: mirror, Point: [-0.5, 0.2, 0.1], Normal: [1, 2, 3]", Isometry::reflection(center, axis)},
      {"Kind: repeat, Vector: [-4, 0, 1], Count: 2", Isometry::shift({-4, 0, 1})}};
  for (const auto& [pattern, motion] : cases) {
    const Simulation both = solved(frame(pattern + ", Copy: all"));
    const Vector3 original = both.displacement("C");
    EXPECT_GT(largest_component(original), 0.02);
    EXPECT_TRUE(agrees(both.displacement("C (1)"), motion.direction(original), kRounding)) << pattern;
    EXPECT_TRUE(agrees(both.displacement("B (1)"), motion.direction(both.displacement("B")), kRounding)) << pattern;
  }
}

/// The twin: nothing holds copies that bring no supports.
TEST(CopiedConditions, StayBehindByDefault) {
  try {
    frame("Kind: repeat, Vector: [-4, 0, 1], Count: 2");
    FAIL() << "held by nothing";
  } catch (const InputError& error) {
    expect_in(error.what(), {"a (1)"});
  }
}

}  // namespace
}  // namespace mixbeam::test::copied_conditions
