// Section axis 2 along curves: by a direction, and away from a line.
#include "scene_text.hpp"

#include "discretization/geometry/reference_curve.hpp"

#include <cmath>

namespace mixbeam::second_axis_test {
namespace {

constexpr double kClose = 1e-9;       // of unit vectors along splines and formulas, whose arc length is integrated
constexpr double kDifference = 1e-5;  // step of central differences, over the length
constexpr double kOfDifference =
    2e-7;  // their error of curvatures times the length: step squared and rounding over step

Member formula_member(const std::array<std::string, 3>& formula, double last) {
  Member member;
  member.curve.shape = CurveShape::parametric;
  member.curve.formula = formula;
  member.curve.range = {0.0, last};
  return member;
}

Member helix_member() {
  Member member;
  member.curve = {CurveShape::helix, {0, 0, 0}, {0, 0, 1}, 5.0, 2.5};
  return member;
}

Vec3<double> axis(const ReferenceCurve& curve, double s, int i) {
  const Mat3<double> m = rotation_matrix(curve.triad(s));
  return {{m(0, i), m(1, i), m(2, i)}};
}

/// Largest error of kappa0 against differences of the triad, times the length.
double curvature_error(const ReferenceCurve& curve) {
  double worst = 0.0;
  for (int i = 1; i < 20; ++i) {
    const double s = curve.length * i / 20.0, h = kDifference * curve.length;
    const Vec3<double> kappa = curve.curvature(s);
    const auto rate = [&](int j, int k) {  // g_j' . g_k
      const Vec3<double> change = axis(curve, s + h, j) - axis(curve, s - h, j);
      return dot(change, axis(curve, s, k)) / (2.0 * h);
    };
    for (const double error : {kappa[0] - rate(1, 2), kappa[1] - rate(2, 0), kappa[2] - rate(0, 1)})
      worst = std::max(worst, std::abs(error) * curve.length);
  }
  return worst;
}

/// Its default axis 2 points to its own axis, so that away from it is the other way; its formula says the same.
TEST(SecondAxis, AwayFromTheAxisOfAHelixIsItsNormal) {
  const Vector3 start = {2, 0, 0};
  const Member helix = helix_member();
  const ReferenceCurve exact = make_reference_curve(helix, start, {});
  Member turned = helix, formula = formula_member({"2*cos(t)", "2*sin(t)", "0.5*t"}, 5.0);
  turned.second_axis_from = formula.second_axis_from = std::array<double, 6>{0, 0, 7, 0, 0, 2};
  for (const Member& member : {turned, formula}) {
    const ReferenceCurve curve = make_reference_curve(member, start, {});
    for (int i = 0; i <= 10; ++i) {
      const double s = exact.length * i / 10.0;
      EXPECT_NEAR(dot(axis(curve, s, 1), axis(exact, s, 1)), -1.0, kClose);
      EXPECT_NEAR(curve.curvature(s)[0], exact.curvature(s)[0], kClose);
      EXPECT_NEAR(curve.curvature(s)[2], -exact.curvature(s)[2], kClose);
    }
    EXPECT_LT(curvature_error(curve), kOfDifference);
  }
  const ReferenceCurve carried =
      make_reference_curve(formula_member({"2*cos(t)", "2*sin(t)", "0.5*t"}, 5.0), start, {});
  EXPECT_GT(std::abs(carried.curvature(0.0)[0] - exact.curvature(0.0)[0]), 0.1);  // the twin: it turns least
}

TEST(SecondAxis, KeepsADirection) {
  Member arc;  // in a plane that the direction is askew to
  arc.curve = {CurveShape::circular_arc, {0, 0, 0}, {0, 0, 1}, 2.0, 0.0};
  Member formula = formula_member({"t", "sin(t)", "0.3*t^2"}, 2.0);
  const Vector3 wanted = {0.2, -0.3, 1.0};
  for (Member member : {arc, formula}) {
    const Vector3 start = member.curve.shape == CurveShape::parametric ? Vector3{0, 0, 0} : Vector3{3, 0, 0};
    member.second_axis = wanted;
    const ReferenceCurve carried = make_reference_curve(member, start, {});
    member.keeps_second_axis = true;
    member.twist = 0.7;
    const ReferenceCurve curve = make_reference_curve(member, start, {});
    member.twist = 0.0;
    const ReferenceCurve plain = make_reference_curve(member, start, {});
    const Vec3<double> w{{wanted[0], wanted[1], wanted[2]}};
    for (int i = 0; i <= 10; ++i) {
      const double s = curve.length * i / 10.0;
      EXPECT_NEAR(dot(axis(plain, s, 2), w), 0.0, kClose);  // in the plane of tangent and direction
      EXPECT_GT(dot(axis(plain, s, 1), w), 0.0);
      EXPECT_NEAR(dot(axis(curve, s, 1), axis(plain, s, 1)), std::cos(0.07 * i), kClose);
      EXPECT_NEAR(dot(axis(curve, s, 1), axis(plain, s, 2)), std::sin(0.07 * i), kClose);
    }
    EXPECT_LT(curvature_error(curve), kOfDifference);
    EXPECT_LT(curvature_error(plain), kOfDifference);
    EXPECT_GT(std::abs(dot(axis(carried, carried.length, 2), w)), 0.01);  // the twin
    EXPECT_NEAR(dot(axis(plain, 0.0, 1), axis(carried, 0.0, 1)), 1.0, kClose);
  }
}

/// A straight member past a line, as the generator of a ruled surface.
TEST(SecondAxis, TurnsAlongALineThatPassesAnother) {
  Member member;
  member.second_axis_from = std::array<double, 6>{0, 0, 0, 0, 0, 1};
  const ReferenceCurve curve = make_reference_curve(member, {1, -1, 0}, {1, 1, 0});
  EXPECT_LT(curvature_error(curve), kOfDifference);
  for (const double s : {0.0, 0.5, 1.0, 2.0}) EXPECT_NEAR(axis(curve, s, 1)[0], 1.0, kClose);
  const ReferenceCurve askew = make_reference_curve(member, {1, -1, 0}, {1, 1, 1});
  EXPECT_LT(curvature_error(askew), kOfDifference);
  EXPECT_GT(std::abs(askew.curvature(askew.length / 2)[0]), 0.01);
}

TEST(SecondAxis, ASectionMustNotTurnOver) {
  Member arc;
  arc.curve = {CurveShape::circular_arc, {0, 0, 0}, {0, 0, 1}, 3.0, 0.0};
  arc.second_axis = {-1, 0, 0};  // the tangent after a quarter turn
  arc.keeps_second_axis = true;
  EXPECT_THROW(make_reference_curve(arc, {3, 0, 0}, {}), std::invalid_argument);
  arc.curve.angle = 1.5;
  EXPECT_NO_THROW(make_reference_curve(arc, {3, 0, 0}, {}));
  Member helix = helix_member();
  helix.second_axis_from = std::array<double, 6>{2, 0, 0, 0, 0, 1};
  EXPECT_THROW(make_reference_curve(helix, {2, 0, 0}, {}), std::invalid_argument);
}

TEST(SecondAxis, ScenesSayIt) {
  const auto text = [](const std::string& more,
                       const std::string& of_curve = "Center: [0, 0, 0], Axis: [0, 0, 1], Angle: 3") {
    return scene_text("A: [3, 0, 0]", member("m", "A", "B", curve("arc", of_curve) + more));
  };
  EXPECT_TRUE(scene_from(text("Second Axis: [0, 0, 1], Keep Second Axis: true")).members[0].keeps_second_axis);
  EXPECT_EQ((*scene_from(text("Second Axis From: [0, 0, 0, 0, 0, 1]")).members[0].second_axis_from)[5], 1.0);
  expect_text_refused(text("Keep Second Axis: true"), {"m / Keep Second Axis", "without \"Second Axis\""});
  expect_text_refused(text("Second Axis From: [0, 0, 0, 0, 0, 1], Second Axis: [0, 0, 1]"),
                      {"m / Second Axis From", "beside"});
  expect_text_refused(text("Second Axis From: [0, 0, 0, 0, 0, 0]"), {"m / Second Axis From", "is zero"});
  expect_text_refused(text("Second Axis: [-1, 0, 0], Keep Second Axis: true"), {"Members / m", "turn over"});
}

}  // namespace
}  // namespace mixbeam::second_axis_test
