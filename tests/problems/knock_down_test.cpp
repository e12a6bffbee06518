/// Knock-down of imperfect structures over the amplitude, both signs, against shooting: a frame of two beams pressed at
/// its corner (Roorda's, and a shallow one), a shallow arch, a bowed column.
#include "nonlinear/run/imperfect_scene.hpp"
#include "tests/support/scene_file.hpp"
#include "tests/support/solve.hpp"

#include <functional>

namespace mixbeam::test::knock_down {
namespace {

constexpr double kAgreement = 1e-8;  // of load factors: what the program promises for critical points
constexpr std::size_t kShots = 300;  // steps of Runge and Kutta along a member: 1e-9 of a wave of four radians

using Plane = std::array<double, 2>;
template <std::size_t n>
using Numbers = std::array<double, n>;

/// Newton's method with differences; the residuals are smooth and the start is close.
template <std::size_t n>
Numbers<n> solved_by_newton(const std::function<Numbers<n>(const Numbers<n>&)>& residual, Numbers<n> x) {
  constexpr double kStep = 1e-7, kSettled = 1e-11;
  for (int iteration = 0; iteration < 12; ++iteration) {
    const Numbers<n> r = residual(x);
    std::array<std::array<double, n + 1>, n> a{};
    for (std::size_t j = 0; j < n; ++j) {
      Numbers<n> y = x;
      y[j] += kStep;
      const Numbers<n> moved = residual(y);
      for (std::size_t i = 0; i < n; ++i) a[i][j] = (moved[i] - r[i]) / kStep;
    }
    for (std::size_t i = 0; i < n; ++i) a[i][n] = r[i];
    for (std::size_t k = 0; k < n; ++k) {
      std::size_t pivot = k;
      for (std::size_t i = k; i < n; ++i)
        if (std::abs(a[i][k]) > std::abs(a[pivot][k])) pivot = i;
      std::swap(a[k], a[pivot]);
      for (std::size_t i = 0; i < n; ++i)
        if (i != k)
          for (std::size_t j = n + 1; j-- > k;) a[i][j] -= a[i][k] / a[k][k] * a[k][j];
    }
    double moved = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
      x[i] -= a[i][n] / a[i][i];
      moved = std::max(moved, std::abs(a[i][n] / a[i][i]));
    }
    if (moved < kSettled) break;
  }
  return x;
}

/// x, y, rotation, moment along a beam of the force `n` in its sections: EI phi' = M - M0, M' = - r' x n.
struct Beam {
  double axial = kRigid, bending = 1.0;
  std::vector<Plane> nodes{};  ///< angle of the undeformed tangent, and ds / dt, where t from 0 to 1 is looked at

  template <class Tangent>
  Beam(double stiffness, const Tangent& tangent) : axial(stiffness) {
    for (std::size_t i = 0; i <= 2 * kShots; ++i) nodes.push_back(tangent(0.5 * static_cast<double>(i) / kShots));
  }
  void integrate(const Plane& n, Numbers<4>& state) const {
    const auto rate = [&](std::size_t node, const Numbers<4>& y) {
      const auto [alpha, speed] = nodes[node];
      const double c = std::cos(alpha + y[2]), s = std::sin(alpha + y[2]);
      const double stretch = (1.0 + (n[0] * c + n[1] * s) / axial) * speed;
      return Numbers<4>{stretch * c, stretch * s, speed * y[3] / bending, stretch * (s * n[0] - c * n[1])};
    };
    const double h = 1.0 / kShots;
    const auto moved = [](const Numbers<4>& y, double by, const Numbers<4>& k) {
      return Numbers<4>{y[0] + by * k[0], y[1] + by * k[1], y[2] + by * k[2], y[3] + by * k[3]};
    };
    for (std::size_t node = 0; node < 2 * kShots; node += 2) {
      const auto k1 = rate(node, state), k2 = rate(node + 1, moved(state, 0.5 * h, k1));
      const auto k3 = rate(node + 1, moved(state, 0.5 * h, k2)), k4 = rate(node + 2, moved(state, h, k3));
      for (std::size_t i = 0; i < 4; ++i) state[i] += h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]);
    }
  }
};

/// Two beams from a pin to a corner to a pin; the load presses the corner down. EI = 1. The first beam is bowed along
/// x by a half sine.
struct CornerFrame {
  Plane foot, corner, end;
  double axial = kRigid, bow = 0.0;
  Beam first = beam(foot, corner, bow), second = beam(corner, end, 0.0);

  Beam beam(const Plane& from, const Plane& to, double amplitude) const {
    return {axial, [=](double t) {
              const double dx = to[0] - from[0] + amplitude * kPi * std::cos(kPi * t), dy = to[1] - from[1];
              return Plane{std::atan2(dy, dx), std::hypot(dx, dy)};
            }};
  }
  /// Unknowns: force in the first beam, rotation of its pin, load. `corner_angle`: how far the corner has turned.
  Numbers<4> shot(const Numbers<4>& unknown, double corner_angle) const {
    Numbers<4> state{foot[0], foot[1], unknown[2], 0.0};
    first.integrate({unknown[0], unknown[1]}, state);
    const double turned = state[2];
    second.integrate({unknown[0], unknown[1] + unknown[3]}, state);
    return {state[0] - end[0], state[1] - end[1], state[3], turned - corner_angle};
  }
  Numbers<4> at(double corner_angle, const Numbers<4>& start) const {
    return solved_by_newton<4>([&](const Numbers<4>& x) { return shot(x, corner_angle); }, start);
  }
  /// Angle and load where the load is largest, on the path that begins unloaded and turns the corner to `side`.
  Plane limit(double side) const {
    constexpr double kFirst = 1e-4, kGrowth = 1.4;
    double angle = side * kFirst;
    Numbers<4> now{}, next = at(angle, now);
    while (next[3] > now[3]) {
      now = next;
      next = at(angle *= kGrowth, next);
    }
    const double step = angle * (1.0 - 1.0 / kGrowth);
    double middle = angle - step;
    for (double h = 0.5 * step; std::abs(h) > 1e-3 * std::abs(step); h *= 0.25) {  // the top of a parabola
      const double low = at(middle - h, now)[3], high = at(middle + h, now)[3], mean = at(middle, now)[3];
      middle += 0.5 * h * (low - high) / (low - 2.0 * mean + high);
    }
    return {middle, at(middle, now)[3]};
  }
};

std::string vector(double x, double y, double z = 0.0) {
  std::ostringstream text;
  text << std::setprecision(17) << "[" << x << ", " << y << ", " << z << "]";
  return text.str();
}

Scene read(const std::string& lists) {
  XmlParameters xml = parsed("Scene: {" + lists + "}");
  return with_mode_shapes(read_scene(xml.list->sublist("Scene"), xml.source), {}, this_rank(), {xml.source, {"Scene"}});
}

std::string section(double axial) {
  const std::string stretch = std::isinf(axial) ? "Inextensible: true, " : "EA: " + std::to_string(axial) + ", ";
  return "Sections: {s: {" + stretch + "Shear Rigid: true, GIt: 1, EI2: 1, EI3: 1}}, ";
}
std::string member(const std::string& start, const std::string& end, const std::string& more = "") {
  return "Start: " + start + ", End: " + end + ", Section: s, Order: 6, Elements: 8, " + more;
}
std::string pin(const std::string& point, const std::string& fixed) {
  return point + ": {Point: " + point + ", Fixed Displacement: " + fixed + ", Fixed Rotation: [x, y]}, ";
}

/// The frame as drawn, with a list "Imperfection".
Scene scene_of(const CornerFrame& drawn, const std::string& imperfection, double load) {
  return read(section(drawn.axial) + "Points: {foot: " + vector(drawn.foot[0], drawn.foot[1]) +
              ", corner: " + vector(drawn.corner[0], drawn.corner[1]) + ", end: " + vector(drawn.end[0], drawn.end[1]) +
              "}, Members: {a: {" + member("foot", "corner") + "}, b: {" + member("corner", "end") + "}}, Supports: {" +
              pin("foot", "[x, y, z]") + pin("end", "[x, y, z]") + "}, Point Loads: {p: {Point: corner, Force: " +
              vector(0.0, -load) + "}}, Imperfection: {" + imperfection + "}");
}
std::string corner_moved(double offset) { return "Points: {corner: " + vector(offset, 0.0) + "}, "; }
std::string bow_of(const std::string& name, double amplitude, const std::string& direction) {
  std::ostringstream number;
  number << std::setprecision(17) << amplitude;
  return "Bows: {bow: {Member: " + name + ", Direction: " + direction + ", Amplitude: " + number.str() + "}}, ";
}

struct Path {
  std::vector<double> limits{};  ///< load factors of limit points
  double corner_angle = 0.0, load_factor = 0.0;
};

/// Up to the full load, or a limit point ends it.
Path path_of(const Scene& scene) {
  Simulation simulation(scene, {}, this_rank());
  Path path;
  PathControl control;
  control.stop = [&path] { return !path.limits.empty(); };
  simulation.run(
      [&](const StepReport& report, const State&) {
        for (const CriticalPoint& point : report.critical_points)
          if (point.kind == CriticalKind::limit_point) path.limits.push_back(point.load_factor);
      },
      control);
  path.corner_angle = simulation.rotation("corner")[2];
  path.load_factor = simulation.load_factor();
  return path;
}

CornerFrame roorda(double bow) { return {{0, 0}, {0, 1}, {1, 1}, kRigid, bow}; }
constexpr double kRoordaRoot = 3.7264;  // near it: 3 (1 - u cot u) + u^2 = 0, the column held by the beam's 3 EI / L

double roorda_load() {
  const auto residual = [](const Numbers<1>& u) {
    return Numbers<1>{3.0 * (1.0 - u[0] / std::tan(u[0])) + u[0] * u[0]};
  };
  const double u = solved_by_newton<1>(residual, {kRoordaRoot})[0];
  return u * u;
}

/// Which sign of the bow leads to a limit point; the other one has none.
TEST(KnockDown, RoordaFrameOverTheAmplitude) {
  const double load = 1.2 * roorda_load();
  for (const double amplitude : {1e-3, 1e-2}) {
    int limits = 0;
    for (const double bow : {amplitude, -amplitude}) {
      SCOPED_TRACE(bow);
      const Path path = path_of(scene_of(roorda(0.0), bow_of("a", bow, "[1, 0, 0]"), load));
      const double side = path.corner_angle > 0.0 ? 1.0 : -1.0;
      if (path.limits.empty()) {
        ASSERT_EQ(path.load_factor, 1.0);
        Numbers<4> shot{};
        for (double angle = 1e-4 * side; std::abs(angle) < std::abs(path.corner_angle); angle *= 1.4)
          shot = roorda(bow).at(angle, shot);
        EXPECT_NEAR(roorda(bow).at(path.corner_angle, shot)[3] / load, 1.0, kAgreement);
      } else {
        ++limits;
        EXPECT_NEAR(path.limits[0], roorda(bow).limit(side)[1] / load, kAgreement);
        EXPECT_LT(path.limits[0] * load / roorda_load(), 1.0 - 0.5 * std::sqrt(amplitude));  // Koiter's half power
      }
    }
    EXPECT_EQ(limits, 1) << amplitude;
  }
}

/// W. T. Koiter, Post-buckling analysis of a simple two-bar frame (1966): P / P_cr = 1 + 0.3805 times the rotation of
/// the corner. The difference of both signs has no second-order part.
TEST(KnockDown, RoordaFrameHasKoitersSlope) {
  constexpr double kKoiter = 0.3805, kDigits = 1e-3, kTarget = 0.005, kAlmostPerfect = 1e-8;
  Plane angle{}, load{};
  for (std::size_t i = 0; i < 2; ++i) {
    const double sign = i == 0 ? 1.0 : -1.0;
    Scene scene = scene_of(roorda(0.0), bow_of("a", sign * kAlmostPerfect, "[1, 0, 0]"), 1.05 * roorda_load());
    scene.members[0].inner_points = {{"middle", 0.5}};
    SolverParameters parameters;
    parameters.analysis.control = MonitoredComponent{"middle", 0, sign * kTarget};
    const Simulation simulation = solved(scene, parameters);
    angle[i] = simulation.rotation("corner")[2];
    load[i] = simulation.load_factor() * 1.05;
  }
  EXPECT_LT(angle[0] * angle[1], 0.0);
  EXPECT_NEAR(std::abs((load[0] - load[1]) / (angle[0] - angle[1])), kKoiter, kDigits * kKoiter);
}

/// Two beams of rise 0.2 of half their span; an offset of the crown lowers the load at which they snap, whatever its
/// sign.
TEST(KnockDown, ShallowFrameOverTheAmplitude) {
  const auto frame = [](double offset) { return CornerFrame{{-1, 0}, {offset, 0.2}, {1, 0}, 1e4}; };
  const double load = 12.0;
  double before = 1.0;
  for (const double amplitude : {0.01, 0.02, 0.05}) {
    double shot = 0.0;
    for (const double offset : {amplitude, -amplitude}) {
      const Path path = path_of(scene_of(frame(0.0), corner_moved(offset), load));
      ASSERT_FALSE(path.limits.empty()) << offset;
      if (shot == 0.0) shot = frame(offset).limit(path.corner_angle > 0.0 ? 1.0 : -1.0)[1] / load;
      EXPECT_NEAR(path.limits[0], shot, kAgreement) << offset;
    }
    EXPECT_LT(shot, before);
    before = shot;
  }
}

/// An arch of the rise 0.2 of half its span, pressed at its crown: a half sine, on which a whole sine is laid. The path
/// of the perfect one bifurcates; the imperfection, whatever its sign, makes of that a limit point of a lower load.
TEST(KnockDown, ShallowArchOverTheAmplitude) {
  constexpr double kRise = 0.2, kStretch = 1e4, kLoad = 10.0;
  const auto arch = [](double amplitude) {
    const auto half = [amplitude](double first) {
      return Beam(kStretch, [=](double t) {
        const double x = first + t;  // from -1 to 1
        const double slope = -0.5 * kPi * kRise * std::sin(0.5 * kPi * x) + kPi * amplitude * std::cos(kPi * x);
        return Plane{std::atan(slope), std::hypot(1.0, slope)};
      });
    };
    CornerFrame frame{{-1, 0}, {0, kRise}, {1, 0}, kStretch};
    frame.first = half(-1.0);
    frame.second = half(0.0);
    return frame;
  };
  const auto scene = [](double amplitude) {
    std::ostringstream height;
    height << std::setprecision(17) << kRise << "*cos(0.5*pi*t)+(" << amplitude << ")*sin(pi*t)";
    const auto curve = [&](const std::string& range) {
      return "Curve: {Shape: parametric, Formula: [t, " + height.str() + ", 0], Range: " + range + "}, ";
    };
    return read(section(kStretch) + "Points: {foot: " + vector(-1, 0) + ", corner: " + vector(0, kRise) +
                "}, Members: {a: {" + member("foot", "corner", curve("[-1, 0]")) + "}, b: {" +
                member("corner", "end", curve("[0, 1]")) + "}}, Supports: {" + pin("foot", "[x, y, z]") +
                pin("end", "[x, y, z]") + "}, Point Loads: {p: {Point: corner, Force: " + vector(0.0, -kLoad) + "}}");
  };
  double before = 1.0;
  for (const double amplitude : {1e-3, 0.01, 0.02}) {
    for (const double signed_amplitude : {amplitude, -amplitude}) {
      const Path path = path_of(scene(signed_amplitude));
      ASSERT_FALSE(path.limits.empty()) << signed_amplitude;
      const double shot = arch(signed_amplitude).limit(path.corner_angle > 0.0 ? 1.0 : -1.0)[1] / kLoad;
      EXPECT_NEAR(path.limits[0], shot, kAgreement) << signed_amplitude;
      EXPECT_GT(std::abs(path.limits[0] -
                         arch(1.1 * signed_amplitude).limit(path.corner_angle > 0.0 ? 1.0 : -1.0)[1] / kLoad),
                1e3 * kAgreement);  // the twin: another amplitude
      EXPECT_LT(path.limits[0], before) << signed_amplitude;
    }
    before = arch(amplitude).limit(1.0)[1] / kLoad;
  }
}

/// A pinned column in the shape of a half sine, up to twice Euler's load.
TEST(KnockDown, BowedColumnOverTheAmplitude) {
  for (const double amplitude : {1e-4, 1e-3, 1e-2, 0.1})
    for (const double sign : {1.0, -1.0})
      for (const double share : {0.5, 0.9, 1.0, 2.0}) {
        const double bow = sign * amplitude, force = share * kPi * kPi;
        const Scene scene =
            read(section(kRigid) + "Points: {foot: " + vector(0, 0) + ", head: " + vector(1, 0) +
                 "}, Members: {strut: {" + member("foot", "head") + "}}, Supports: {" + pin("foot", "[x, y, z]") +
                 pin("head", "[y, z]") + "}, Point Loads: {p: {Point: head, Force: " + vector(-force, 0) +
                 "}}, Imperfection: {" + bow_of("strut", bow, "[0, 1, 0]") + "}");
        const Simulation loaded = solved(scene);
        // shot from the foot to the middle, whose tangent keeps its direction; it turns at the foot by
        const Beam half(kRigid, [bow](double t) {
          const double slope = bow * kPi * std::cos(0.5 * kPi * t);
          return Plane{std::atan(slope), 0.5 * std::hypot(1.0, slope)};
        });
        const auto middle = [&](double turned) {
          Numbers<4> state{0.0, 0.0, turned, 0.0};
          half.integrate({-force, 0.0}, state);
          return state;
        };
        const double foot = loaded.rotation("foot")[2];
        const Numbers<1> turned =
            solved_by_newton<1>([&](const Numbers<1>& x) { return Numbers<1>{middle(x[0])[2]}; }, {foot});
        EXPECT_NEAR(foot, turned[0], kAgreement) << bow << " " << share;
        EXPECT_NEAR(loaded.sample("strut", 0.5).position[1], middle(turned[0])[1], kAgreement) << bow << " " << share;
      }
}

}  // namespace
}  // namespace mixbeam::test::knock_down
