/// Reference curves against the classic parametrisation of circle and helix, written here with cosine and sine:
///   r(t) = c + R (cos t b1 + sin t b2) + t / angle * rise b3,     t = angle s / L.
#include "discretization/geometry/reference_curve.hpp"

#include "tests/support/errors.hpp"
#include "tests/support/worst_error.hpp"

#include <Sacado_No_Kokkos.hpp>

#include <array>
#include <functional>
#include <random>

namespace mixbeam::reference_curve_test {
namespace {

using test::kRounding;
using test::WorstError;

using test::kPi;
constexpr unsigned kSeed = 20240611;

// All errors are bounded by small multiples of one rounding (1.1e-16), about twice what was measured with and without
// fused multiply-add. Positions, relative to length plus coordinates (measured 4): the swept angle, the triad and the
// sum.
constexpr double kPositionError = 8 * kRounding;
// Columns of a triad, relative to 1 + swept angle, and for the direction to the axis to the coordinates over the radius
// (measured 4.4 on curves; 10 on lines, where the rounding of two quaternions' norms enters).
constexpr double kDirectionError = 16 * kRounding;
// Products of columns: a relative error of the norm of the quaternion enters them fourfold (measured 20).
constexpr double kOrthonormalError = 32 * kRounding;
// The tangent is divided by its norm (measured 3).
constexpr double kUnitError = 6 * kRounding;
// kappa0, relative to angle / length and to the same sharpness (measured 2.5).
constexpr double kCurvatureError = 6 * kRounding;

template <class S>
using Frame = std::array<Vec3<S>, 3>;

/// What a member says about its arc (rise = 0) or helix.
struct Description {
  const char* name;
  Vector3 start, center, axis;
  double angle, rise;

  Member member(const Vector3& second_axis = {}) const {
    Member m;
    m.curve = {rise == 0.0 ? CurveShape::circular_arc : CurveShape::helix, center, axis, angle, rise};
    m.second_axis = second_axis;
    return m;
  }
};

std::vector<Description> descriptions() {
  const Vector3 e3 = {0, 0, 1}, tilted = {2, -1, 2};
  return {{"45 degrees, radius 100, towards e2", {0, 0, 0}, {0, 100, 0}, e3, kPi / 4, 0},
          {"semicircle", {3, 2, 3}, {1, 2, 3}, {0, 0, 7}, kPi, 0},
          {"full circle, tilted", {-0.5, 1.5, 7}, {-1, 0.5, 7}, tilted, 2 * kPi, 0},
          {"shallow arc", {3e5, 6e5, 0}, {0, 0, 0}, tilted, 1e-6, 0},
          {"three turns of a circle", {0, 0.6, 0.3}, {0, 0, 0}, tilted, 6 * kPi, 0},
          {"helix of ten turns", {1, 0, 0.5}, {0, 0, 0}, e3, 20 * kPi, 5},
          {"steep, tilted helix", {3.005, 2.01, 1}, {3, 2, 1}, tilted, 1.5, 10},
          {"falling helix", {1, 3, 2}, {3, 2, 1}, tilted, 4, -3},
          {"helix in tiny units", {1e-9, 3e-9, 2e-9}, {3e-9, 2e-9, 1e-9}, tilted, 4, -3e-9},
          {"helix in huge units", {1e12, 3e12, 2e12}, {3e12, 2e12, 1e12}, tilted, 4, -3e12}};
}

/// The classic parametrisation, in a frame computed with long double from the very numbers that the program gets:
/// b3 along the axis, b1 from the axis to the start.
struct ClassicCurve {
  explicit ClassicCurve(const Description& given);

  template <class S>
  Vec3<S> direction(const S& along_b1, const S& along_b2, const S& along_b3) const {
    return along_b1 * cast<S>(b[0]) + along_b2 * cast<S>(b[1]) + along_b3 * cast<S>(b[2]);
  }

  template <class S>
  Vec3<S> position(const S& s) const {
    using std::cos;
    using std::sin;
    const S t = s * S(w), R = S(radius);
    return cast<S>(foot) + direction<S>(R * cos(t), R * sin(t), s * S(rise / length));
  }

  /// Frenet's frame: tangent, principal normal (towards the axis), binormal.
  template <class S>
  Frame<S> frenet(const S& s) const {
    using std::cos;
    using std::sin;
    const S t = s * S(w), around = S(radius * w), along = S(rise / length);
    return {direction<S>(-around * sin(t), around * cos(t), along), direction<S>(-cos(t), -sin(t), S(0.0)),
            direction<S>(along * sin(t), -along * cos(t), around)};
  }

  template <class S>
  static Vec3<S> cast(const Vec3<long double>& v) {
    return {{S(v[0]), S(v[1]), S(v[2])}};
  }

  std::string name;
  Frame<long double> b;
  Vec3<long double> foot;  ///< of the start point on the axis
  long double radius, angle, rise, length;
  long double w;     ///< angle / length
  double size;       ///< of the coordinates and the length: what positions are rounded relative to
  double sharpness;  ///< of the direction to the axis: rounding of the coordinates over the radius
};

Vec3<long double> to_long(const Vector3& v) { return {{v[0], v[1], v[2]}}; }

ClassicCurve::ClassicCurve(const Description& given) : name(given.name), angle(given.angle), rise(given.rise) {
  const Vec3<long double> axis = to_long(given.axis), from_center = to_long(given.start) - to_long(given.center);
  b[2] = (1.0L / norm(axis)) * axis;
  const long double height = dot(from_center, b[2]);
  const Vec3<long double> radius_vector = from_center - height * b[2];
  radius = norm(radius_vector);
  b[0] = (1.0L / radius) * radius_vector;
  b[1] = cross(b[2], b[0]);
  foot = to_long(given.start) - radius_vector;
  length = std::hypot(radius * angle, rise);
  w = angle / length;
  size = static_cast<double>(length + norm(to_long(given.start)) + norm(to_long(given.center)));
  sharpness = static_cast<double>(1.0L + norm(from_center) / radius);
}

/// Calls f(s) for s = 0, ..., L.
template <class Action>
void for_many_points(const ReferenceCurve& curve, Action f) {
  constexpr int kIntervals = 200;
  for (int i = 0; i <= kIntervals; ++i) f(curve.length * i / kIntervals);
}

template <class A, class B>
double distance(const Vec3<A>& a, const Vec3<B>& b) {
  long double sum = 0.0L;
  for (int i = 0; i < 3; ++i) sum += (static_cast<long double>(a[i]) - b[i]) * (static_cast<long double>(a[i]) - b[i]);
  return static_cast<double>(std::sqrt(sum));
}

Vec3<double> column(const Quaternion<double>& triad, int j) {
  const Mat3<double> m = rotation_matrix(triad);
  return {{m(0, j), m(1, j), m(2, j)}};
}

double largest_entry(const Mat3<double>& m) {
  double largest = 0.0;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) largest = std::max(largest, std::abs(m(i, j)));
  return largest;
}

/// Neither along nor normal to any of the curves.
constexpr Vector3 kOtherSecondAxis = {1.0, 0.2, -0.4};

ReferenceCurve curve_of(const Description& given, const Vector3& second_axis = {}) {
  return make_reference_curve(given.member(second_axis), given.start, {});
}

/// Distance from the classic parametrisation, relative to the size of the coordinates.
WorstError position_error(const ClassicCurve& exact, const ReferenceCurve& curve) {
  WorstError worst;
  for_many_points(curve, [&](double s) {
    worst.see(distance(curve.position(s), exact.position<long double>(s)) / exact.size, exact.name, ", s = ", s);
  });
  return worst;
}

TEST(ReferenceCurve, PointsLieOnCircleAndHelix) {
  for (const Description& given : descriptions()) {
    const ClassicCurve exact(given);
    const ReferenceCurve curve = curve_of(given);
    const auto length = static_cast<double>(exact.length);
    EXPECT_NEAR(curve.length, length, 4 * kRounding * exact.sharpness * length) << exact.name;
    EXPECT_TRUE(position_error(exact, curve).at_most(kPositionError));
    EXPECT_TRUE(position_error(exact, curve_of(given, kOtherSecondAxis)).at_most(kPositionError)) << "second axis";
  }
}

TEST(ReferenceCurve, CurvatureInAnotherFrameIsSeen) {
  // The components of kappa0 for the principal normal, used with another second axis: the classic mistake.
  for (const Description& given : descriptions()) {
    ReferenceCurve curve = curve_of(given, kOtherSecondAxis);
    curve.start_curvature = curve_of(given).start_curvature;
    EXPECT_FALSE(position_error(ClassicCurve(given), curve).at_most(kPositionError)) << given.name;
  }
}

TEST(ReferenceCurve, EndPosition) {
  for (const Description& given : descriptions()) {
    const ClassicCurve exact(given);
    const Vec3<long double> end = to_long(curve_end(given.member().curve, given.start));
    EXPECT_LE(distance(end, exact.position(exact.length)), kPositionError * exact.size) << exact.name;
  }
}

TEST(ReferenceCurve, TriadIsFrenetsFrameWithoutSecondAxis) {
  for (const Description& given : descriptions()) {
    const ClassicCurve exact(given);
    const ReferenceCurve curve = curve_of(given);
    WorstError worst;
    for_many_points(curve, [&](double s) {
      const Frame<long double> g = exact.frenet<long double>(s);
      const double scale = given.angle + exact.sharpness;
      for (int j = 0; j < 3; ++j)
        worst.see(distance(column(curve.triad(s), j), g[static_cast<std::size_t>(j)]) / scale, exact.name, ", g", j + 1,
                  ", s = ", s);
    });
    EXPECT_TRUE(worst.at_most(kDirectionError));
  }
}

TEST(ReferenceCurve, TangentIsTheDerivativeOfThePosition) {
  using Fad = Sacado::Fad::SFad<long double, 1>;
  for (const Description& given : descriptions()) {
    const ClassicCurve exact(given);
    const ReferenceCurve curve = curve_of(given, kOtherSecondAxis);
    WorstError direction, length;
    for_many_points(curve, [&](double s) {
      const Vec3<Fad> r = exact.position<Fad>(Fad(1, 0, s));
      const Vec3<long double> slope{{r[0].dx(0), r[1].dx(0), r[2].dx(0)}};
      direction.see(distance(curve.tangent(s), slope) / (given.angle + exact.sharpness), exact.name, ", s = ", s);
      length.see(std::abs(norm(curve.tangent(s)) - 1.0), exact.name, ", s = ", s);
    });
    EXPECT_TRUE(direction.at_most(kDirectionError));
    EXPECT_TRUE(length.at_most(kUnitError));
  }
}

TEST(ReferenceCurve, TriadIsOrthonormalAndRightHanded) {
  for (const Description& given : descriptions()) {
    const ReferenceCurve curve = curve_of(given, kOtherSecondAxis);
    WorstError orthonormal, right_handed;
    for_many_points(curve, [&](double s) {
      const Mat3<double> m = rotation_matrix(curve.triad(s));
      const Vec3<double> g1 = column(curve.triad(s), 0), g2 = column(curve.triad(s), 1), g3 = column(curve.triad(s), 2);
      orthonormal.see(largest_entry(transpose(m) * m - identity_matrix<double>()), given.name, ", s = ", s);
      right_handed.see(distance(cross(g1, g2), g3), given.name, ", s = ", s);
    });
    EXPECT_TRUE(orthonormal.at_most(kOrthonormalError));
    EXPECT_TRUE(right_handed.at_most(kOrthonormalError));
  }
}

/// Frenet's frame turned about the tangent by a constant angle, with its derivative: Lambda^T Lambda' = hat(kappa0).
Vec3<double> curvature_by_differentiation(const ClassicCurve& exact, double turn, double s) {
  using Fad = Sacado::Fad::SFad<long double, 1>;
  const Frame<Fad> f = exact.frenet<Fad>(Fad(1, 0, s));
  const Fad c = std::cos(turn), d = std::sin(turn);
  const Frame<Fad> g = {f[0], c * f[1] + d * f[2], c * f[2] - d * f[1]};
  const auto component = [&](std::size_t i, std::size_t j) {  // g_i . g_j'
    long double sum = 0.0L;
    for (int k = 0; k < 3; ++k) sum += g[i][k].val() * g[j][k].dx(0);
    return static_cast<double>(sum);
  };
  return {{component(2, 1), component(0, 2), component(1, 0)}};
}

TEST(ReferenceCurve, CurvatureIsTheRateOfTheTriad) {
  for (const Description& given : descriptions())
    for (const Vector3& second_axis : {Vector3{}, kOtherSecondAxis}) {
      const ClassicCurve exact(given);
      const ReferenceCurve curve = curve_of(given, second_axis);
      const Frame<double> start = exact.frenet<double>(0.0);
      const Vec3<double> g2 = column(curve.start_triad, 1);
      const double turn = std::atan2(dot(g2, start[2]), dot(g2, start[1]));
      WorstError worst;
      for_many_points(curve, [&](double s) {
        const Vec3<double> kappa = curvature_by_differentiation(exact, turn, s);
        worst.see(distance(curve.start_curvature, kappa) / (norm(kappa) * exact.sharpness), exact.name, ", s = ", s);
      });
      EXPECT_TRUE(worst.at_most(kCurvatureError));
    }
}

TEST(ReferenceCurve, CurvatureAndTorsionOfTheTextbook) {
  // Curvature R w^2 and torsion (rise / L) w with w = angle / L (do Carmo, Differential Geometry of Curves and
  // Surfaces, 1.5).
  for (const Description& given : descriptions()) {
    const ClassicCurve exact(given);
    const auto torsion = static_cast<double>(exact.w * exact.rise / exact.length);
    const auto bending = static_cast<double>(exact.w * exact.w * exact.radius);
    const double bound = kCurvatureError * exact.sharpness * static_cast<double>(exact.w);
    const Vec3<double> kappa = curve_of(given).start_curvature;
    EXPECT_LE(distance(kappa, Vec3<double>{{torsion, 0.0, bending}}), bound) << exact.name;
    const Vec3<double> turned = curve_of(given, kOtherSecondAxis).start_curvature;
    EXPECT_NEAR(turned[0], torsion, bound) << exact.name;
    EXPECT_NEAR(std::hypot(turned[1], turned[2]), bending, bound) << exact.name;
  }
}

TEST(ReferenceCurve, SecondAxisIsProjected) {
  std::mt19937_64 random(kSeed);
  std::uniform_real_distribution<double> component(-1.0, 1.0);
  WorstError in_plane;
  for (int i = 0; i < 1000; ++i) {
    Member line;
    const Vector3 end = {component(random), component(random), component(random)};
    line.second_axis = {1e3 * component(random), 1e3 * component(random), 1e3 * component(random)};
    const Quaternion<double> triad = make_reference_curve(line, {0.1, 0.2, 0.3}, end).start_triad;
    const Vec3<double> wanted{{line.second_axis[0], line.second_axis[1], line.second_axis[2]}};
    const double size = norm(wanted);
    in_plane.see(std::abs(dot(wanted, column(triad, 2))) / size, "seed ", kSeed, ", case ", i);
    EXPECT_GT(dot(wanted, column(triad, 1)), 0.0) << "seed " << kSeed << ", case " << i;
  }
  EXPECT_TRUE(in_plane.at_most(kDirectionError));
}

TEST(ReferenceCurve, NearlyParallelSecondAxisKeepsTheTangent) {
  Member line;
  line.second_axis = {1.0, 2e-6, 0.0};  // twice the smallest angle
  const Quaternion<double> triad = make_reference_curve(line, {0, 0, 0}, {5, 0, 0}).start_triad;
  EXPECT_LE(distance(column(triad, 0), Vec3<double>{{1, 0, 0}}), kDirectionError);
  EXPECT_LE(distance(column(triad, 1), Vec3<double>{{0, 1, 0}}), kDirectionError);
}

TEST(ReferenceCurve, SecondAxisOfAnArcKeepsItsAngleToTheNormal) {
  // g2 along the axis of the arc at the start stays there: then g3 points away from the centre and kappa0 = (0, 1/R,
  // 0).
  const Description arc = {"arc", {4, 0, 0}, {0, 0, 0}, {0, 0, 1}, 2.0, 0.0};
  const ReferenceCurve curve = curve_of(arc, {0, 0, 1});
  EXPECT_LE(distance(curve.start_curvature, Vec3<double>{{0, 0.25, 0}}), kCurvatureError);
  for (const double s : {0.0, 3.0, 8.0})
    EXPECT_LE(distance(column(curve.triad(s), 1), Vec3<double>{{0, 0, 1}}), kDirectionError);
}

Mat3<double> line_triad(const Vector3& direction) {
  return rotation_matrix(make_reference_curve(Member{}, {0, 0, 0}, direction).start_triad);
}

TEST(ReferenceCurve, LineAlongE1HasTheIdentity) {
  const ReferenceCurve curve = make_reference_curve(Member{}, {1, 2, 3}, {8, 2, 3});
  const Quaternion<double>& triad = curve.start_triad;
  EXPECT_EQ((std::array{triad.w, triad.x, triad.y, triad.z}), (std::array{1.0, 0.0, 0.0, 0.0}));
  EXPECT_EQ(norm(curve.start_curvature), 0.0);
  EXPECT_EQ(curve.length, 7.0);
  EXPECT_EQ(distance(curve.position(3.5), Vec3<double>{{4.5, 2, 3}}), 0.0);
}

TEST(ReferenceCurve, LinesInThePlaneHaveTheThirdAxisE3) {
  for (int degrees = 0; degrees < 360; ++degrees) {
    const double a = degrees * kPi / 180.0;
    const Mat3<double> m = line_triad({std::cos(a), std::sin(a), 0.0});
    EXPECT_LE(largest_entry(m - exp_matrix(Vec3<double>{{0, 0, a}})), kDirectionError) << degrees << " degrees";
  }
}

TEST(ReferenceCurve, VerticalLinesHaveTheSecondAxisE2) {
  for (const double up : {1.0, -1.0}) {
    const Mat3<double> expected = {{{0, 0, -up}, {0, 1, 0}, {up, 0, 0}}};
    EXPECT_LE(largest_entry(line_triad({0, 0, 3.0 * up}) - expected), kDirectionError);
    // coordinates that carry the rounding of a decimal fraction must not turn the section
    constexpr double noise = 1e-7;
    EXPECT_LE(largest_entry(line_triad({noise, -noise, up}) - expected), 4 * noise);
  }
}

TEST(ReferenceCurve, RandomLines) {
  std::mt19937_64 random(kSeed);
  std::uniform_real_distribution<double> component(-1.0, 1.0);
  WorstError position, direction;
  for (int i = 0; i < 1000; ++i) {
    const Vec3<double> start{{component(random), component(random), component(random)}};
    const Vec3<double> end{{component(random), component(random), component(random)}};
    const ReferenceCurve curve =
        make_reference_curve(Member{}, {start[0], start[1], start[2]}, {end[0], end[1], end[2]});
    const double size = curve.length + norm(start) + norm(end);
    position.see(distance(curve.position(curve.length), end) / size, "seed ", kSeed, ", case ", i);
    direction.see(distance((1.0 / curve.length) * (end - start), curve.tangent(0.3)), "g1, seed ", kSeed, ", case ", i);
    direction.see(std::abs(column(curve.triad(0.1), 1)[2]), "g2 not horizontal, seed ", kSeed, ", case ", i);
    EXPECT_GT(column(curve.start_triad, 2)[2], 0.0) << "seed " << kSeed << ", case " << i;
  }
  EXPECT_TRUE(position.at_most(kPositionError));
  EXPECT_TRUE(direction.at_most(kDirectionError));
}

using Refusal = std::invalid_argument;

TEST(ReferenceCurve, RefusesDegenerateCurves) {
  using Spoil = std::function<void(Member & arc, Vector3 & start)>;
  const double nan = std::nan("");
  const std::vector<std::pair<std::string, Spoil>> rows = {
      {"no error", [](Member&, Vector3&) {}},
      {"axis of the curve is zero", [](Member& m, Vector3&) { m.curve.axis[2] = 0; }},
      {"angle of the curve must be positive", [](Member& m, Vector3&) { m.curve.angle = 0; }},
      {"angle of the curve must be positive", [](Member& m, Vector3&) { m.curve.angle = -1; }},
      {"angle of the curve must be positive", [=](Member& m, Vector3&) { m.curve.angle = nan; }},
      {"radius is zero", [](Member& m, Vector3&) { m.curve.center[0] = 1; }},
      {"not in the plane", [](Member& m, Vector3&) { m.curve.center[2] = 1; }},
      {"no rise", [](Member& m, Vector3&) { m.curve.rise = 1; }},
      {"start point are not finite", [=](Member&, Vector3& start) { start[1] = nan; }},
      {"parallel to the tangent", [](Member& m, Vector3&) { m.second_axis[1] = 1; }}};
  for (const auto& [words, spoil] : rows) {
    Vector3 start = {1, 0, 0};
    Member member = Description{"arc", start, {0, 0, 0}, {0, 0, 1}, 1.0, 0.0}.member();
    spoil(member, start);
    expect_error<Refusal>([&] { make_reference_curve(member, start, {0, 1, 0}); }, {words});
  }
}

TEST(ReferenceCurve, RefusesDegenerateLines) {
  const auto line = [](const Vector3& start, const Vector3& end, const std::string& words, const Vector3& axis = {}) {
    Member member;
    member.second_axis = axis;
    expect_error<Refusal>([&] { make_reference_curve(member, start, end); }, {words});
  };
  line({1, 1, 1}, {1, 1, 2}, "no error");
  line({0, 0, 0}, {0, 0, 1e-30}, "no error");
  line({1, 1, 1}, {1, 1, 1}, "no length");
  line({1, 1, 1}, {1, 1, 1 + 1e-15}, "no length");
  line({1, 1, 1}, {1, 1, std::nan("")}, "end point are not finite");
  line({0, 0, 0}, {2, 2, 2}, "parallel to the tangent", {-1, -1, -1 - 1e-7});
  line({0, 0, 0}, {2, 2, 2}, "no error", {1, 1, 1.001});
}

}  // namespace
}  // namespace mixbeam::reference_curve_test
