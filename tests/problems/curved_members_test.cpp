// Members of any undeformed shape, solved: against exact arcs and helices, and against shooting on the differential
// equations of the rod, integrated here without finite elements.
#include "tests/support/solve.hpp"

#include "discretization/geometry/reference_curve.hpp"

#include <functional>

namespace mixbeam::test::curved_members_test {
namespace {

constexpr double kRelative = 1e-8;

Member formula_member(const std::array<std::string, 3>& formula, double first, double last, int order, int elements) {
  Member member = line("beam", "clamp", "tip", order, elements);
  member.curve.shape = CurveShape::parametric;
  member.curve.formula = formula;
  member.curve.range = {first, last};
  return member;
}

Scene clamped(const Member& member, const Section& section, const Vector3& start, const Vector3& force) {
  Scene scene = cantilever(section, 1.0, member.order, member.elements);
  scene.points = {{"clamp", start}};
  scene.members = {member};
  scene.point_loads = {dead_load("tip", force)};
  return scene;
}

TEST(CurvedMembers, ArcAsAFormula) {
  // 45-degree arc, see apps/verification/arc_45.xml: shooting, Runge-Kutta 7(8), step doubling below 1e-10
  const Member arc = formula_member({"100*sin(t)", "100*cos(t) - 100", "0"}, 0.0, kPi / 4.0, 4, 64);
  const Section strip = section(1e7, 5e6, 1e7 / 12.0, 1e7 / 12.0);
  EXPECT_TRUE(agrees_relatively(solved(clamped(arc, strip, {0, 0, 0}, {0, 0, 600})).displacement("tip"),
                                {-23.560239545026, 13.604521347307, 53.474858791825}, kRelative));
  EXPECT_TRUE(agrees_relatively(solved(clamped(arc, strip, {0, 0, 0}, {0, 0, 3000})).displacement("tip"),
                                {-47.686369893902, 25.056445964830, 68.539089493083}, kRelative));
}

TEST(CurvedMembers, TwistedFormulaIsTheHelix) {
  // The rotation-minimising frame of a helix, twisted by the integral of the torsion, keeps its angle to the principal
  // normal, as the frame of the exact helix does: the same beam with different bending stiffnesses.
  const double radius = 2.0, rise = 0.5, angle = 5.0, c2 = radius * radius + rise * rise;
  Section strip = section(1e4, 5e3, 1.0, 1.0);
  strip.bending_stiffness = {2.0, 10.0};
  Member exact = line("beam", "clamp", "tip", 4, 24);
  exact.curve.shape = CurveShape::helix;
  exact.curve.angle = angle;
  exact.curve.rise = rise * angle;
  exact.second_axis = {-1, 0, 0};
  Member formula = formula_member({"2*cos(t)", "2*sin(t)", "0.5*t"}, 0.0, angle, 4, 24);
  formula.second_axis = exact.second_axis;
  formula.twist = rise / c2 * angle * std::sqrt(c2);
  const Vector3 force = {0.01, -0.02, 0.06};
  const Vector3 helix = solved(clamped(exact, strip, {2, 0, 0}, force)).displacement("tip");
  EXPECT_GT(largest_component(helix), 0.5);
  EXPECT_TRUE(agrees_relatively(solved(clamped(formula, strip, {2, 0, 0}, force)).displacement("tip"), helix, 1e-10));
  formula.twist = 0.0;  // has a say
  EXPECT_FALSE(agrees_relatively(solved(clamped(formula, strip, {2, 0, 0}, force)).displacement("tip"), helix, 1e-3));
}

/// A clamped rod over 0 <= t <= 1 under a dead force at its tip.
struct Rod {
  std::function<double(double)> speed;        ///< ds/dt
  std::function<Vec3<double>(double)> kappa;  ///< kappa0, material
  Vec3<double> start;
  Mat3<double> start_triad;
  double axial, shear;  ///< stiffness
  Vec3<double> moment_stiffness;
  Vec3<double> force;
};

/// Position, triad and spatial moment, as 15 numbers.
using RodState = std::array<double, 15>;

/// r' = R (e1 + C_N^-1 R^T n), R' = R hat(kappa0 + C_M^-1 R^T m), m' = -r' x n, times ds/dt.
RodState slope(const Rod& rod, double t, const RodState& y) {
  Mat3<double> R;
  for (int i = 0; i < 9; ++i) R(i / 3, i % 3) = y[3 + i];
  const Vec3<double> N = transpose_times(R, rod.force), M = transpose_times(R, {{y[12], y[13], y[14]}});
  const Vec3<double> strain{{1.0 + N[0] / rod.axial, N[1] / rod.shear, N[2] / rod.shear}};
  Vec3<double> kappa = rod.kappa(t);
  for (int i = 0; i < 3; ++i) kappa[i] += M[i] / rod.moment_stiffness[i];
  const Vec3<double> tangent = R * strain, couple = cross(tangent, rod.force);
  const Mat3<double> turning = R * hat(kappa);
  const double speed = rod.speed(t);
  RodState result;
  for (int i = 0; i < 3; ++i) result[i] = speed * tangent[i];
  for (int i = 0; i < 9; ++i) result[3 + i] = speed * turning(i / 3, i % 3);
  for (int i = 0; i < 3; ++i) result[12 + i] = -speed * couple[i];
  return result;
}

/// Classic Runge-Kutta with Richardson's extrapolation below; `steps` of equal length.
RodState integrate(const Rod& rod, const Vec3<double>& moment, int steps) {
  RodState y{};
  for (int i = 0; i < 3; ++i) {
    y[i] = rod.start[i];
    y[12 + i] = moment[i];
  }
  for (int i = 0; i < 9; ++i) y[3 + i] = rod.start_triad(i / 3, i % 3);
  const auto moved = [](RodState from, double h, const RodState& k) {
    for (int i = 0; i < 15; ++i) from[i] += h * k[i];
    return from;
  };
  const double h = 1.0 / steps;
  for (int i = 0; i < steps; ++i) {
    const double t = h * i;
    const RodState k1 = slope(rod, t, y), k2 = slope(rod, t + 0.5 * h, moved(y, 0.5 * h, k1));
    const RodState k3 = slope(rod, t + 0.5 * h, moved(y, 0.5 * h, k2)), k4 = slope(rod, t + h, moved(y, h, k3));
    for (int j = 0; j < 15; ++j) y[j] += h / 6.0 * (k1[j] + 2.0 * k2[j] + 2.0 * k3[j] + k4[j]);
  }
  return y;
}

/// Tip position: the moment at the clamp for which that at the tip vanishes, by Newton's method.
Vec3<double> shoot(const Rod& rod, int steps, Vec3<double> moment) {
  const auto end_moment = [&](const Vec3<double>& m) {
    const RodState y = integrate(rod, m, steps);
    return Vec3<double>{{y[12], y[13], y[14]}};
  };
  for (int iteration = 0; iteration < 12; ++iteration) {
    const Vec3<double> error = end_moment(moment);
    Vec3<double> column[3];
    for (int j = 0; j < 3; ++j) {
      constexpr double kDifference = 1e-6;
      Vec3<double> next = moment;
      next[j] += kDifference;
      column[j] = (1.0 / kDifference) * (end_moment(next) - error);
    }
    const double determinant = dot(column[0], cross(column[1], column[2]));  // Cramer's rule
    for (int j = 0; j < 3; ++j) moment[j] -= dot(error, cross(column[(j + 1) % 3], column[(j + 2) % 3])) / determinant;
  }
  EXPECT_LT(norm(end_moment(moment)), 1e-11);
  const RodState y = integrate(rod, moment, steps);
  return {{y[0], y[1], y[2]}};
}

/// Extrapolated from two step lengths; what the extrapolation changes bounds the error.
Vector3 tip_by_shooting(const Rod& rod, const Vec3<double>& first_guess) {
  const Vec3<double> coarse = shoot(rod, 500, first_guess), fine = shoot(rod, 1000, first_guess);
  EXPECT_LT(norm(fine - coarse), 1e-8);
  const Vec3<double> tip = fine + (1.0 / 15.0) * (fine - coarse);
  return {tip[0], tip[1], tip[2]};
}

TEST(CurvedMembers, PreTwistedBlade) {
  // a strip, ten times stiffer across, that turns by 90 degrees along its length
  const double length = 2.0, twist = kPi / 2.0;
  Section strip = section(2e3, 1e3, 1.5, 1.0);
  strip.bending_stiffness = {10.0, 1.0};
  Scene scene = cantilever(strip, length, 4, 16);
  scene.members[0].twist = twist;
  scene.point_loads = {dead_load("tip", {0.0, 0.5, 0.8})};
  const Rod rod{[=](double) { return length; },
                [=](double) {
                  return Vec3<double>{{twist / length, 0, 0}};
                },
                {{0, 0, 0}},
                identity_matrix<double>(),
                2e3,
                1e3,
                {{1.5, 10.0, 1.0}},
                {{0.0, 0.5, 0.8}}};
  const Vector3 expected = tip_by_shooting(rod, {{0, -1.4, 0.9}});
  EXPECT_TRUE(agrees_relatively(solved(scene).position("tip"), expected, 1e-9));
  scene.members[0].twist = -twist;  // has a say
  EXPECT_FALSE(agrees_relatively(solved(scene).position("tip"), expected, 1e-3));
}

/// Parabola y = x^2, z = 0 from its vertex to x = 1: curvature 2 / (1 + 4 t^2)^(3/2) about e3.
constexpr Vector3 kParabolaForce = {0.4, 0.3, 0.6};
const Section kParabolaSection = section(2e3, 1e3, 1.5, 2.0);

Vector3 tip_of_parabola_by_shooting() {
  const Rod rod{[](double t) { return std::sqrt(1.0 + 4.0 * t * t); },
                [](double t) {
                  return Vec3<double>{{0, 0, 2.0 / std::pow(1.0 + 4.0 * t * t, 1.5)}};
                },
                {{0, 0, 0}},
                identity_matrix<double>(),
                2e3,
                1e3,
                {{1.5, 2.0, 2.0}},
                {{kParabolaForce[0], kParabolaForce[1], kParabolaForce[2]}}};
  return tip_by_shooting(rod, {{0.4, -0.4, 0.0}});
}

Scene parabola(int order, int elements) {
  return clamped(formula_member({"t", "t^2", "0"}, 0.0, 1.0, order, elements), kParabolaSection, {0, 0, 0},
                 kParabolaForce);
}

TEST(CurvedMembers, VaryingCurvatureConvergesWithOrderPlusOne) {
  const Vector3 exact = tip_of_parabola_by_shooting();
  EXPECT_TRUE(agrees_relatively(solved(parabola(4, 16)).position("tip"), exact, 1e-10));
  for (int order = 1; order <= 4; ++order) {
    const int elements = order < 3 ? 8 : 2;
    const double coarse = distance(solved(parabola(order, elements)).position("tip"), exact);
    const double fine = distance(solved(parabola(order, 2 * elements)).position("tip"), exact);
    constexpr double kAsymptotic = 0.15;  // how far a rate between two meshes may stay behind its limit
    EXPECT_GT(std::log2(coarse / fine), order + 1 - kAsymptotic) << "order " << order << ": " << coarse << ", " << fine;
  }
}

TEST(CurvedMembers, EveryIntegrationRuleConverges) {
  const Vector3 exact = tip_of_parabola_by_shooting();
  for (const ForceIntegration rule :
       {ForceIntegration::full, ForceIntegration::axial_reduced, ForceIntegration::shear_reduced}) {
    Scene scene = parabola(3, 16);
    scene.members[0].force_integration = rule;
    EXPECT_TRUE(agrees_relatively(solved(scene).position("tip"), exact, 1e-6)) << static_cast<int>(rule);
  }
}

TEST(CurvedMembers, StationsCrowdedWhereTheCurvatureIsLarge) {
  Scene scene = parabola(3, 8);
  scene.members[0].stations = {0.0, 0.06, 0.14, 0.23, 0.34, 0.47, 0.62, 0.8, 1.0};
  scene.members[0].inner_points = {{"inner", 0.47}};
  const Vector3 exact = tip_of_parabola_by_shooting();
  const Simulation crowded = solved(scene);
  EXPECT_TRUE(agrees_relatively(crowded.position("tip"), exact, 1e-6));
  EXPECT_LT(crowded.displacement("inner")[2], crowded.displacement("tip")[2]);
}

/// A ring that is one member from a clamped point to itself, pulled at the opposite point.
Scene ring(const Curve& curve) {
  Scene scene = cantilever(section(1e4, 5e3, 1.0, 1.0), 1.0, 4, 32);
  scene.points = {{"clamp", {1, 0, 0}}};
  scene.members = {line("ring", "clamp", "clamp", 4, 32)};
  scene.members[0].curve = curve;
  scene.members[0].inner_points = {{"opposite", 0.5}};
  scene.point_loads = {dead_load("opposite", {-1.0, 0.0, 0.3})};
  return scene;
}

TEST(CurvedMembers, ClosedSplineIsARing) {
  Curve circle;
  circle.shape = CurveShape::circular_arc;
  circle.angle = 2.0 * kPi;
  const auto spline = [](int points) {
    Curve curve;
    curve.shape = CurveShape::spline;
    for (int i = 1; i < points; ++i)
      curve.through.push_back({std::cos(2.0 * kPi * i / points), std::sin(2.0 * kPi * i / points), 0.0});
    return curve;
  };
  const Vector3 exact = solved(ring(circle)).displacement("opposite");
  EXPECT_LT(exact[0], -0.05);
  EXPECT_NEAR(exact[1], 0.0, 1e-10);  // symmetry
  EXPECT_TRUE(agrees_relatively(solved(ring(spline(64))).displacement("opposite"), exact, 1e-5));
  // the spline approaches the circle with the fourth power of the distance of its points
  const double coarse = distance(solved(ring(spline(16))).displacement("opposite"), exact);
  const double fine = distance(solved(ring(spline(32))).displacement("opposite"), exact);
  EXPECT_GT(std::log2(coarse / fine), 3.5) << coarse << ", " << fine;
}

}  // namespace
}  // namespace mixbeam::test::curved_members_test
