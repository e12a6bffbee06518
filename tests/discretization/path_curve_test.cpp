/// Splines, curves given by formulas, and twist: against closed forms of the textbooks and GSL's elliptic integral.
#include "discretization/geometry/reference_curve.hpp"

#include "tests/support/errors.hpp"
#include "tests/support/worst_error.hpp"

#include <gsl/gsl_sf_ellint.h>

#include <functional>
#include <random>

namespace mixbeam {
namespace {

using test::WorstError;

using test::kPi;
constexpr unsigned kSeed = 20240611;
constexpr int kIntervals = 97;  // of a sweep: no multiple of any number of panels

// Arc length and points of curves whose formulas are exact to rounding, relative to their size.
constexpr double kLengthError = 1e-14;
// Derivatives of interpolated formulas lose two to three digits: tangents and triads.
constexpr double kTriadError = 5e-13;
constexpr double kOrthonormalError = 4e-15;  // of a normalised quaternion
// Second derivatives lose four to five digits.
constexpr double kCurvatureError = 2e-11;
// Spline: points and triads without any interpolation of formulas.
constexpr double kSplineError = 4e-15;

Member formula_member(const std::string& x, const std::string& y, const std::string& z, double first, double last) {
  Member member;
  member.curve.shape = CurveShape::parametric;
  member.curve.formula = {x, y, z};
  member.curve.range = {first, last};
  return member;
}

Member spline_member(const std::vector<Vector3>& through, const std::array<Vector3, 2>& tangents = {}) {
  Member member;
  member.curve.shape = CurveShape::spline;
  member.curve.through = through;
  member.curve.end_tangents = tangents;
  return member;
}

Member helix_member(double angle, double rise) {
  Member member;
  member.curve = {CurveShape::helix, {0, 0, 0}, {0, 0, 1}, angle, rise};
  return member;
}

ReferenceCurve curve_of(const Member& member, const Vector3& start = {}, const Vector3& end = {}) {
  return make_reference_curve(member, start, end);
}

Vec3<double> column(const Quaternion<double>& triad, int j) {
  const Mat3<double> m = rotation_matrix(triad);
  return {{m(0, j), m(1, j), m(2, j)}};
}

double angle_between(const Quaternion<double>& a, const Quaternion<double>& b) {
  return norm(log_quaternion(conjugate(a) * b));
}

template <class Action>
void for_many_points(const ReferenceCurve& curve, Action f) {
  for (int i = 0; i <= kIntervals; ++i) f(curve.length * i / kIntervals);
}

/// A member that zigzags: start, inner points and end.
struct Zigzag {
  std::vector<Vector3> points;
  Member member;
  ReferenceCurve curve() const { return curve_of(member, points.front(), points.back()); }
};

Zigzag random_spline(std::mt19937_64& random, int inner_points, const std::array<Vector3, 2>& tangents = {}) {
  std::uniform_real_distribution<double> component(-1.0, 1.0);
  Zigzag zigzag;
  for (int i = 0; i <= inner_points + 1; ++i)
    zigzag.points.push_back({2.0 * i + component(random), component(random), component(random)});
  zigzag.member = spline_member({zigzag.points.begin() + 1, zigzag.points.end() - 1}, tangents);
  return zigzag;
}

TEST(PathCurve, PointsOfAParabolaByArcLength) {
  const ReferenceCurve curve = curve_of(formula_member("t", "t^2", "0", 0.0, 3.0));
  WorstError worst;
  for_many_points(curve, [&](double s) {
    const Vec3<double> r = curve.position(s);
    const double t = r[0], length = 0.5 * t * std::sqrt(1.0 + 4.0 * t * t) + 0.25 * std::asinh(2.0 * t);
    worst.see(std::abs(length - s) / curve.length, "length, s = ", s);
    worst.see(std::abs(r[1] - t * t) / curve.length, "on the parabola, s = ", s);
  });
  EXPECT_TRUE(worst.at_most(kLengthError));
}

TEST(PathCurve, LengthOfAnEllipse) {
  // 4 a E(k), k^2 = 1 - b^2 / a^2: complete elliptic integral of the second kind
  for (const double b : {1.0, 0.5, 0.1, 0.01}) {
    const ReferenceCurve curve = curve_of(formula_member("cos(t)", std::to_string(b) + "*sin(t)", "0", 0.0, 2.0 * kPi));
    const double exact = 4.0 * gsl_sf_ellint_Ecomp(std::sqrt(1.0 - b * b), GSL_PREC_DOUBLE);
    EXPECT_NEAR(curve.length, exact, kLengthError * exact) << "b = " << b;
  }
}

TEST(PathCurve, LengthDoesNotDependOnTheParameter) {
  const auto length = [](double x) { return 0.5 * x * std::sqrt(1.0 + 4.0 * x * x) + 0.25 * std::asinh(2.0 * x); };
  const std::vector<std::pair<std::string, std::function<double(double)>>> parameters = {
      {"(t^3 + t)", [](double t) { return t * t * t + t; }},
      {"exp(t)", [](double t) { return std::exp(t); }},
      {"(1/(3-t))", [](double t) { return 1.0 / (3.0 - t); }}};
  for (const auto& [x, value] : parameters) {
    const double exact = length(value(1.1)) - length(value(0.2));
    EXPECT_NEAR(curve_of(formula_member(x, x + "^2", "0", 0.2, 1.1)).length, exact, kLengthError * length(value(1.1)))
        << x;
  }
}

TEST(PathCurve, BackwardsRangeIsTheSameCurveFromItsEnd) {
  Member forward = formula_member("t", "t^2", "t^3/4", -0.5, 1.5),
         backward = formula_member("t", "t^2", "t^3/4", 1.5, -0.5);
  const ReferenceCurve a = curve_of(forward), b = curve_of(backward);
  EXPECT_NEAR(a.length, b.length, kLengthError * a.length);
  WorstError worst;
  for_many_points(a, [&](double s) {
    worst.see(norm(a.position(s) - b.position(a.length - s)), "position, s = ", s);
    worst.see(norm(a.tangent(s) + b.tangent(a.length - s)), "tangent, s = ", s);
    // the frame turns least both ways
    const Quaternion<double> between = conjugate(a.triad(s)) * b.triad(a.length - s);
    const Quaternion<double> at_end = conjugate(a.triad(a.length)) * b.triad(0.0);
    worst.see(angle_between(between, at_end), "triad, s = ", s);
  });
  EXPECT_TRUE(worst.at_most(kTriadError));
}

void expect_consistent_frame(const ReferenceCurve& curve, double triad_error, double curvature_error) {
  WorstError orthonormal, tangent, rate, twist;
  for_many_points(curve, [&](double s) {
    const Mat3<double> m = rotation_matrix(curve.triad(s)), unit = transpose(m) * m - identity_matrix<double>();
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) orthonormal.see(std::abs(unit(i, j)), "s = ", s);
    tangent.see(norm(column(curve.triad(s), 0) - curve.tangent(s)), "s = ", s);
    // the curvature is the rate of the triad: a Gauss integral of Lambda kappa over a short piece (Magnus, 4th order)
    const double h = 2.5e-4 * curve.length, a = std::min(s, curve.length - h), middle = a + 0.5 * h;
    const double offset = h * std::sqrt(3.0) / 6.0;
    const Vec3<double> k1 = curve.curvature(middle - offset), k2 = curve.curvature(middle + offset);
    const Vec3<double> step = (0.5 * h) * (k1 + k2) + (std::sqrt(3.0) * h * h / 12.0) * cross(k1, k2);
    rate.see(norm(log_quaternion(conjugate(exp_quaternion(step)) * conjugate(curve.triad(a)) * curve.triad(a + h))) / h,
             "s = ", s);
    twist.see(std::abs(curve.curvature(s)[0] - curve.twist_rate), "s = ", s);
  });
  EXPECT_TRUE(orthonormal.at_most(kOrthonormalError));
  EXPECT_TRUE(tangent.at_most(triad_error));
  EXPECT_TRUE(rate.at_most(curvature_error));
  EXPECT_TRUE(curve.path == nullptr || twist.at_most(0.0));
}

// Error of Magnus' fourth-order step over 1 / 4000 of the length, relative to the length of the curves below.
constexpr double kRateError = 1e-8;

TEST(PathCurve, FrameTurnsAtTheRateOfTheCurvature) {
  expect_consistent_frame(curve_of(formula_member("cos(t)", "sin(2*t)", "0.3*t", 0.0, 5.0)), kTriadError, kRateError);
  Member twisted = formula_member("cos(t)", "sin(2*t)", "0.3*t", 0.0, 5.0);
  twisted.twist = 4.0;
  expect_consistent_frame(curve_of(twisted), kTriadError, kRateError);
  std::mt19937_64 random(kSeed);
  for (int inner = 0; inner < 6; ++inner)  // whose third derivative jumps: there the step is of second order only
    expect_consistent_frame(random_spline(random, inner, {{{1, 1, 0}, {1, 0, -1}}}).curve(), kSplineError, 1e-3);
}

TEST(PathCurve, FrameOfAHelixTurnsBackByItsTorsion) {
  // Against Frenet's frame the rotation-minimising one turns by minus the integral of the torsion (Bishop 1975). The
  // carried frame of the exact helix keeps its angle to Frenet's.
  const double radius = 2.0, rise = 0.7;  // per radian
  const double c = std::hypot(radius, rise), torsion = rise / (c * c);
  const ReferenceCurve curve = curve_of(formula_member("2*cos(t)", "2*sin(t)", "0.7*t", 0.0, 20.0));
  EXPECT_NEAR(curve.length, 20.0 * c, kLengthError * 20.0 * c);
  Member exact = helix_member(20.0, 20.0 * rise);
  const Vec3<double> g2 = column(curve.start_triad, 1);
  exact.second_axis = {g2[0], g2[1], g2[2]};
  const ReferenceCurve helix = curve_of(exact, {2, 0, 0});
  WorstError position, triad;
  for_many_points(curve, [&](double s) {
    position.see(norm(curve.position(s) - helix.position(s)) / curve.length, "s = ", s);
    const Quaternion<double> back = exp_quaternion(Vec3<double>{{-torsion * s, 0.0, 0.0}});
    triad.see(angle_between(curve.triad(s), helix.triad(s) * back), "s = ", s);
  });
  EXPECT_TRUE(position.at_most(kLengthError));
  EXPECT_TRUE(triad.at_most(kTriadError));
}

TEST(PathCurve, CurvatureOfAnEllipse) {
  // a b / (a^2 sin^2 t + b^2 cos^2 t)^(3/2), in its plane about e3 (do Carmo, 1.5)
  const ReferenceCurve curve = curve_of(formula_member("2*cos(t)", "sin(t)", "0", 0.0, 2.0 * kPi));
  WorstError worst;
  for_many_points(curve, [&](double s) {
    const Vec3<double> r = curve.position(s), kappa = curve.curvature(s);
    const double exact = 2.0 / std::pow(4.0 * r[1] * r[1] + 0.25 * r[0] * r[0], 1.5);
    worst.see(norm(kappa - Vec3<double>{{0.0, 0.0, exact}}), "s = ", s);
  });
  EXPECT_TRUE(worst.at_most(kCurvatureError));
  EXPECT_LE(norm(column(curve.triad(0.4), 2) - Vec3<double>{{0, 0, 1}}), kTriadError);
}

TEST(PathCurve, TwistedLineArcAndHelix) {
  Member line;
  line.twist = 1.2;
  const ReferenceCurve strip = curve_of(line, {0, 0, 0}, {3, 0, 0});
  EXPECT_TRUE(strip.has_constant_curvature());
  EXPECT_NEAR(strip.curvature(1.0)[0], 0.4, 1e-15);
  EXPECT_LE(angle_between(strip.triad(2.0), exp_quaternion(Vec3<double>{{0.8, 0, 0}})), 1e-15);
  EXPECT_LE(norm(strip.position(3.0) - Vec3<double>{{3, 0, 0}}), 1e-15);

  Member helix = helix_member(4.0, 3.0);
  const ReferenceCurve plain = curve_of(helix, {1, 0, 0});
  helix.twist = -5.0;
  const ReferenceCurve twisted = curve_of(helix, {1, 0, 0});
  WorstError worst;
  for_many_points(plain, [&](double s) {
    worst.see(norm(plain.position(s) - twisted.position(s)), "position, s = ", s);
    const Quaternion<double> turn = exp_quaternion(Vec3<double>{{-5.0 * s / plain.length, 0, 0}});
    worst.see(angle_between(plain.triad(s) * turn, twisted.triad(s)), "triad, s = ", s);
    worst.see(
        std::abs(norm(twisted.curvature(s) - Vec3<double>{{-5.0 / plain.length, 0, 0}}) - norm(plain.curvature(s))),
        "curvature, s = ", s);
  });
  EXPECT_TRUE(worst.at_most(kSplineError));
  expect_consistent_frame(twisted, kSplineError, kRateError);
}

TEST(PathCurve, SplinePassesItsPoints) {
  std::mt19937_64 random(kSeed);
  WorstError worst;
  for (int inner = 0; inner < 8; ++inner)
    for (const auto& tangents : {std::array<Vector3, 2>{}, std::array<Vector3, 2>{{{0, 3, 0}, {}}},
                                 std::array<Vector3, 2>{{{0, 3, 0}, {1, 0, 1}}}}) {
      const Zigzag zigzag = random_spline(random, inner, tangents);
      const PolynomialCurve spline = make_spline(zigzag.member.curve, zigzag.points.front(), zigzag.points.back());
      for (std::size_t i = 0; i < spline.pieces.size(); ++i)
        for (std::size_t end = 0; end < 2; ++end) {
          const PolynomialPiece& piece = spline.pieces[i];
          const Vector3& p = zigzag.points[i + end];
          const Vec3<double> r = spline.origin + piece.position(end == 0 ? piece.first() : piece.last());
          worst.see(norm(r - Vec3<double>{{p[0], p[1], p[2]}}) / 10.0, inner, " inner points, piece ", i);
        }
      const ReferenceCurve curve = zigzag.curve();
      const Vector3& p = zigzag.points.back();
      worst.see(norm(curve.position(curve.length) - Vec3<double>{{p[0], p[1], p[2]}}) / 10.0, "end");
    }
  EXPECT_TRUE(worst.at_most(kSplineError));
}

TEST(PathCurve, SplineIsTwiceContinuouslyDifferentiable) {
  std::mt19937_64 random(kSeed);
  const Zigzag zigzag = random_spline(random, 6);
  const PolynomialCurve spline = make_spline(zigzag.member.curve, zigzag.points.front(), zigzag.points.back());
  WorstError worst;
  for (std::size_t i = 1; i < spline.pieces.size(); ++i) {
    const double t = spline.pieces[i].first();
    worst.see(norm(spline.pieces[i].velocity(t) - spline.pieces[i - 1].velocity(t)), "velocity at point ", i);
    worst.see(norm(spline.pieces[i].acceleration(t) - spline.pieces[i - 1].acceleration(t)), "acceleration at ", i);
  }
  worst.see(norm(spline.pieces.front().acceleration(0.0)), "natural start");
  worst.see(norm(spline.pieces.back().acceleration(spline.pieces.back().last())), "natural end");
  EXPECT_TRUE(worst.at_most(1e-13));
}

TEST(PathCurve, SplineTakesItsEndTangents) {
  std::mt19937_64 random(kSeed);
  const ReferenceCurve curve = random_spline(random, 3, {{{0, 0, 7}, {0, -1, 0}}}).curve();
  EXPECT_LE(norm(curve.tangent(0.0) - Vec3<double>{{0, 0, 1}}), kSplineError);
  EXPECT_LE(norm(curve.tangent(curve.length) - Vec3<double>{{0, -1, 0}}), kSplineError);
}

/// Largest distance of a spline through points of a circle from the circle.
double circle_error(int points, bool is_closed) {
  std::vector<Vector3> on_circle;
  for (int i = 0; i <= points; ++i) {
    const double angle = (is_closed ? 2.0 : 1.0) * kPi * (i + 0.3 * std::sin(2.0 * kPi * i / points)) / points;
    on_circle.push_back({std::cos(angle), std::sin(angle), 0.0});
  }
  if (is_closed) on_circle.back() = on_circle.front();
  Member member = spline_member({on_circle.begin() + 1, on_circle.end() - 1});
  if (!is_closed) member.curve.end_tangents = {{{0, 1, 0}, {0, -1, 0}}};
  const ReferenceCurve curve = curve_of(member, on_circle.front(), on_circle.back());
  double worst = 0.0;
  for_many_points(curve, [&](double s) { worst = std::max(worst, std::abs(norm(curve.position(s)) - 1.0)); });
  return worst;
}

TEST(PathCurve, SplineApproachesACircleWithTheFourthPower) {
  for (const bool is_closed : {false, true}) {
    const double coarse = circle_error(16, is_closed), fine = circle_error(64, is_closed);
    EXPECT_GT(std::log(coarse / fine) / std::log(4.0), 3.8) << (is_closed ? "closed" : "open");
    EXPECT_LT(fine, 1e-6);
  }
}

TEST(PathCurve, ClosedSplineIsARingWithoutAKink) {
  const ReferenceCurve curve = curve_of(spline_member({{0, 1, 0}, {-1, 0, 0}, {0, -1, 0}}), {1, 0, 0}, {1, 0, 0});
  EXPECT_LE(norm(curve.position(0.0) - curve.position(curve.length)), kSplineError);
  EXPECT_LE(norm(curve.tangent(0.0) - curve.tangent(curve.length)), kSplineError);
  EXPECT_LE(angle_between(curve.triad(0.0), curve.triad(curve.length)), kSplineError * 10.0);
  EXPECT_NEAR(curve.curvature(0.0)[2], curve.curvature(curve.length)[2], 1e-13);
  // of four points: the symmetry of the square is left
  EXPECT_LE(norm(curve.position(0.25 * curve.length) - Vec3<double>{{0, 1, 0}}), kSplineError);
}

TEST(PathCurve, TurnedAndShiftedPointsGiveTheTurnedAndShiftedSpline) {
  std::mt19937_64 random(kSeed);
  const Mat3<double> turn = exp_matrix(Vec3<double>{{0.4, -1.1, 0.7}});
  const Vec3<double> shift{{5.0, -3.0, 2.0}};
  const auto turned = [&](const Vector3& v) {
    const Vec3<double> w = turn * Vec3<double>{{v[0], v[1], v[2]}};
    return Vector3{w[0], w[1], w[2]};
  };
  Zigzag a = random_spline(random, 5, {{{1, 0.5, 0}, {}}});
  a.member.second_axis = {0, 0, 1};
  Zigzag b = a;
  b.member.second_axis = turned(a.member.second_axis);
  for (Vector3& tangent : b.member.curve.end_tangents) tangent = turned(tangent);
  const auto move = [&](Vector3& p) {
    p = turned(p);
    for (int i = 0; i < 3; ++i) p[i] += shift[i];
  };
  for (Vector3& p : b.points) move(p);
  for (Vector3& p : b.member.curve.through) move(p);
  const ReferenceCurve here = a.curve(), there = b.curve();
  EXPECT_NEAR(here.length, there.length, 1e-14 * here.length);
  WorstError worst;
  for_many_points(here, [&](double s) {
    worst.see(norm(turn * here.position(s) + shift - there.position(s)) / here.length, "position, s = ", s);
    worst.see(angle_between(quaternion_of(turn) * here.triad(s), there.triad(s)), "triad, s = ", s);
  });
  EXPECT_TRUE(worst.at_most(1e-13));
}

TEST(PathCurve, TurnedAndShiftedFormulasGiveTheTurnedAndShiftedCurve) {
  // by the angle of the triangle 3, 4, 5 about e3
  const std::string x = "(t + t^3)", y = "cos(2*t)", z = "exp(t)";
  Member a = formula_member(x, y, z, 0.0, 1.5);
  Member b =
      formula_member("0.8*" + x + " - 0.6*" + y + " + 7", "0.6*" + x + " + 0.8*" + y + " - 2", z + " + 1", 0, 1.5);
  a.second_axis = {0, 1, 0};
  b.second_axis = {-0.6, 0.8, 0};
  const Quaternion<double> turn = exp_quaternion(Vec3<double>{{0, 0, std::atan2(3.0, 4.0)}});
  const ReferenceCurve here = curve_of(a), there = curve_of(b);
  EXPECT_NEAR(here.length, there.length, kLengthError * here.length);
  WorstError position, triad;
  for_many_points(here, [&](double s) {
    const Vec3<double> expected = rotation_matrix(turn) * here.position(s) + Vec3<double>{{7, -2, 1}};
    position.see(norm(expected - there.position(s)) / here.length, "s = ", s);
    triad.see(angle_between(turn * here.triad(s), there.triad(s)), "s = ", s);
  });
  EXPECT_TRUE(position.at_most(1e-13));
  EXPECT_TRUE(triad.at_most(kTriadError));
}

TEST(PathCurve, Ends) {
  const Member parabola = formula_member("1+t", "t^2", "0", 0.0, 1.0);
  const ReferenceCurve curve = curve_of(parabola, {}, {});
  const Vec3<double> end = curve.position(curve.length);
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(end[i], (Vector3{2, 1, 0})[i], 1e-14);
  EXPECT_TRUE(defines_end(parabola.curve));
  const Member spline = spline_member({{1, 1, 0}});
  EXPECT_FALSE(defines_end(spline.curve));
  EXPECT_NEAR(curve.tangent(0.0)[0], 1.0, 1e-13);
}

void expect_refusal(const Member& member, const Vector3& start, const Vector3& end, const std::string& words) {
  expect_error<std::invalid_argument>([&] { make_reference_curve(member, start, end); }, {words});
}
void expect_refusal(const std::string& x, const std::string& y, double first, double last, const std::string& words) {
  expect_refusal(formula_member(x, y, "0", first, last), {}, {}, words);
}

TEST(PathCurve, RefusesFormulasThatMakeNoCurve) {
  expect_refusal("t", "foo(t)", 0, 1, "The formula of y, \"foo(t)\"");
  expect_refusal("t", "1/t", 0, 1, "is inf at t = 0");
  expect_refusal("t", "sqrt(t-0.5)", 0, 1, "at t = 0");
  expect_refusal("t", "abs(t-0.5)", 0, 1, "near t = 0.5");
  expect_refusal("t", "abs(t-0.3)", 0, 1, "a kink, or is not smooth, near t = 0.29999");
  expect_refusal("t", "t < 0.5 ? 0 : 1", 0, 1, "near t = 0.5");
  expect_refusal("t", "t < 0.7 ? 0 : 1", 0, 1, "a jump");
  expect_refusal("t", "sqrt(t)", 0, 1, "not smooth, near t = 0");
  expect_refusal("t", "t", 1, 1, "two different, finite ends");
  expect_refusal("3", "4", 0, 1, "no tangent");
  expect_refusal("t", "sin(1e7*t)", 0, 1, "not smooth");
  expect_refusal("1e308*t", "0", -1, 1, "no tangent");
  expect_refusal("t^2", "t^3", -1, 1, "no tangent near t = 0");
  expect_refusal("t^2", "t^3", -1, 2, "no tangent near t = ");
  expect_refusal("t^2", "t^2", 0, 1, "no tangent near t = 0");
  expect_refusal("cos(t)", "0", 0.1, 5, "no tangent near t = 3.14159");
}

TEST(PathCurve, RefusesPointsThatMakeNoSpline) {
  expect_refusal(spline_member({{1, 0, 0}, {1, 0, 1e-14}}), {0, 0, 0}, {2, 0, 0},
                 "Points 2 and 3 of the spline coincide");
  expect_refusal(spline_member({{1, std::nan(""), 0}}), {0, 0, 0}, {2, 0, 0}, "not finite");
  expect_refusal(spline_member({{1, 0, 0}}), {0, 0, 0}, {0, 0, 0}, "at least two points");
  expect_refusal(spline_member({}), {1, 1, 1}, {1, 1, 1}, "coincide");
  expect_refusal(spline_member({{1e-310, 0, 0}}), {0, 0, 0}, {2e-310, 0, 0}, "coincide");
  Member along = spline_member({{1, 0, 0}});
  along.second_axis = {-1, 0, 0};
  expect_refusal(along, {0, 0, 0}, {2, 0, 0}, "parallel to the tangent");
}

}  // namespace
}  // namespace mixbeam
