// Paths near singular points that are easily got wrong, each with an answer that no finite element computed: shooting
// on the rod equations, or a closed form. The table below is data; one judge looks at every path, and once more at the
// same path with each number of the answer changed, which it must refuse.
#include "discretization/scene/section_shape.hpp"
#include "nonlinear/run/accurate_run.hpp"
#include "tests/support/constrained_scenes.hpp"
#include "tests/support/solve.hpp"

#include <ctime>
#include <functional>
#include <optional>

namespace mixbeam::test::known_paths_test {
namespace {

/// Of what is compared, unless a path says otherwise: the digits of the references.
constexpr double kDigits = 1e-8;
/// By which each number of an answer is changed for the twin.
constexpr double kTwin = 1e-3;
/// What no path of the table may take, with room for a busy machine.
constexpr double kMostSeconds = 30.0;

constexpr int kX = 0, kY = 1, kZ = 2, kNorm = 3;

struct End {
  std::string point;
  int component;
  double value;
  double tolerance = kDigits;
};
struct Critical {
  double load_factor;
  std::optional<CriticalKind> kind{};
  int modes = 0;  ///< 0: any
};

struct Answer {
  std::vector<End> ends{}, forces{};  ///< displacements; forces of supports
  std::optional<double> load_factor{};
  std::optional<double> moment_energy{};
  std::vector<Critical> critical{};
  double critical_tolerance = kDigits;
  bool all_critical = true;  ///< false: more may follow
  bool only_limits = false;  ///< `critical` are the limit points alone, bifurcations are not looked at
  int negative = 0;          ///< of the last state; -1: not looked at
  std::optional<Verdict> verdict{};
  bool counts_follow = true;  ///< false: a branch or a controlled motion, where counts change their meaning
  std::optional<double> largest_step{};
  std::vector<double> buckling{};  ///< linear, nearest to zero first
  bool may_be_refused = false;
};

struct KnownPath {
  std::string name;
  Scene scene;
  SolverParameters parameters{};
  Answer answer{};
};

/// What Google Test prints of it.
void PrintTo(const KnownPath& path, std::ostream* out) { *out << path.name; }

// ---- what was computed

struct Walk {
  bool refused = false, late = false;
  std::string failure{};
  double load_factor = 0.0, largest_step = 0.0, moment_energy = 0.0;
  int negative = -1;
  std::optional<Verdict> verdict{};  ///< of the last state
  std::vector<CriticalPoint> critical{};
  std::vector<Vector3> ends{}, forces{};  ///< in the order of the answer
  std::vector<double> buckling{};
};

double component(const Vector3& v, int i) { return i == kNorm ? std::hypot(v[0], v[1], v[2]) : v[i]; }

class Walker {
 public:
  explicit Walker(const KnownPath& path) : path_(path) {}

  Walk walk() {
    try {
      path_.scene.accuracy ? accurately() : plainly();
    } catch (const InputError& error) {
      walk_.refused = true;
      walk_.failure = error.what();
    }
    return walk_;
  }

 private:
  bool is_late() {
    walk_.late = static_cast<double>(std::clock() - start_) / CLOCKS_PER_SEC > kMostSeconds;
    return walk_.late;
  }
  void see(const StepReport& report) {
    walk_.critical.insert(walk_.critical.end(), report.critical_points.begin(), report.critical_points.end());
    walk_.largest_step = std::max(walk_.largest_step, std::abs(report.load_factor - walk_.load_factor));
    walk_.load_factor = report.load_factor;
    walk_.negative = report.stability ? report.stability->negative : -1;
    walk_.verdict.reset();
    if (report.stability) walk_.verdict = report.stability->verdict();
  }
  void plainly() {
    Simulation simulation(path_.scene, path_.parameters, this_rank());
    if (!path_.answer.buckling.empty())
      for (const auto& mode : simulation.buckling_modes(static_cast<int>(path_.answer.buckling.size()), 3))
        walk_.buckling.push_back(mode.load_factor);
    PathControl control;
    control.stop = [this] { return is_late(); };
    simulation.run([this](const StepReport& report, const State&) { see(report); }, control);
    finish(simulation);
  }
  void accurately() {
    AccurateRunObserver observer;
    observer.begin = [this](const Simulation&) {
      walk_.critical.clear();
      walk_.load_factor = 0.0;
    };
    observer.step = [this](const Simulation&, const StepReport& report) { see(report); };
    observer.end = [this](const Simulation&, const StepReport& report, const ErrorEstimate&) { see(report); };
    observer.stop = [this] { return is_late(); };
    const AccurateRun run = run_accurately(path_.scene, path_.parameters, this_rank(), true, observer);
    finish(run.simulation);
  }
  void finish(const Simulation& simulation) {
    walk_.refused = !simulation.result().finished;
    walk_.failure = simulation.result().failure;
    walk_.moment_energy = simulation.strain_energy().moment;
    for (const End& end : path_.answer.ends) walk_.ends.push_back(simulation.displacement(end.point));
    for (const End& force : path_.answer.forces)
      for (const Reaction& reaction : simulation.reactions())
        if (reaction.point == force.point) walk_.forces.push_back(reaction.force);
  }

  const KnownPath& path_;
  Walk walk_{};
  std::clock_t start_ = std::clock();
};

// ---- the judge

void compare(std::vector<std::string>& wrong, const std::string& what, double value, double right, double tolerance) {
  // a value of zero is one of a structure whose size is about one
  if (std::abs(value - right) <= tolerance * (right == 0.0 ? 1.0 : std::abs(right))) return;
  std::ostringstream text;
  text << std::setprecision(12) << what << " " << value << " in place of " << right;
  wrong.push_back(text.str());
}

std::vector<CriticalPoint> looked_at(const Walk& walk, const Answer& answer) {
  std::vector<CriticalPoint> points;
  for (const CriticalPoint& point : walk.critical)
    if (!answer.only_limits || point.kind == CriticalKind::limit_point) points.push_back(point);
  return points;
}

void judge_critical(std::vector<std::string>& wrong, const Walk& walk, const Answer& answer) {
  const std::vector<CriticalPoint> points = looked_at(walk, answer);
  if (points.size() < answer.critical.size() || (answer.all_critical && points.size() > answer.critical.size()))
    wrong.push_back(std::to_string(points.size()) + " critical points in place of " +
                    std::to_string(answer.critical.size()));
  for (size_t i = 0; i < std::min(points.size(), answer.critical.size()); ++i) {
    const std::string name = "critical point " + std::to_string(i + 1) + ": ";
    const Critical& known = answer.critical[i];
    compare(wrong, name + "load factor", points[i].load_factor, known.load_factor, answer.critical_tolerance);
    if (known.kind && points[i].kind != *known.kind) wrong.push_back(name + name_of(points[i].kind));
    if (known.modes > 0) compare(wrong, name + "modes", points[i].modes, known.modes, 0.0);
  }
}

/// Each critical point begins with the count that the one before left, and the last state has what remains.
void judge_counts(std::vector<std::string>& wrong, const Walk& walk) {
  int count = 0;
  for (const CriticalPoint& point : walk.critical) {
    if (point.negative_before != count) wrong.push_back("counts of critical points do not follow one another");
    count = point.negative_after;
  }
  if (walk.negative >= 0 && walk.negative != count)
    wrong.push_back("the last count is not that of the critical points");
}

std::vector<std::string> judge(const Walk& walk, const Answer& answer) {
  if (walk.late) return {"takes more than " + std::to_string(kMostSeconds) + " s"};
  if (walk.refused && answer.may_be_refused) return {};
  if (walk.refused) return {"given up: " + walk.failure};
  std::vector<std::string> wrong;
  for (size_t i = 0; i < answer.ends.size(); ++i)
    compare(wrong, answer.ends[i].point, component(walk.ends[i], answer.ends[i].component), answer.ends[i].value,
            answer.ends[i].tolerance);
  for (size_t i = 0; i < answer.forces.size(); ++i)
    compare(wrong, "force at " + answer.forces[i].point, component(walk.forces[i], answer.forces[i].component),
            answer.forces[i].value, answer.forces[i].tolerance);
  if (answer.load_factor) compare(wrong, "load factor", walk.load_factor, *answer.load_factor, kDigits);
  if (answer.moment_energy) compare(wrong, "energy", walk.moment_energy, *answer.moment_energy, 10.0 * kDigits);
  judge_critical(wrong, walk, answer);
  if (answer.counts_follow) judge_counts(wrong, walk);
  if (answer.negative >= 0 && walk.negative >= 0)
    compare(wrong, "negative eigenvalues", walk.negative, answer.negative, 0);
  if (answer.verdict && walk.verdict != answer.verdict)
    wrong.push_back(std::string("stable: ") + (walk.verdict ? text_of(*walk.verdict) : "unknown"));
  if (answer.largest_step && walk.largest_step > *answer.largest_step * (1.0 + kDigits))
    wrong.push_back("a step is too large");
  for (size_t i = 0; i < answer.buckling.size(); ++i)
    compare(wrong, "buckling factor", i < walk.buckling.size() ? walk.buckling[i] : 0.0, answer.buckling[i], kTwin);
  return wrong;
}

/// Every answer that differs from the right one in one number.
std::vector<Answer> twins(const Answer& answer) {
  std::vector<Answer> all;
  const auto add = [&](const std::function<void(Answer&)>& change) {
    all.push_back(answer);
    change(all.back());
  };
  const auto off = [](double& value, double tolerance) {
    value += (value == 0.0 ? 1.0 : value) * std::max(kTwin, 10.0 * tolerance);
  };
  for (size_t i = 0; i < answer.ends.size(); ++i) add([&](Answer& a) { off(a.ends[i].value, a.ends[i].tolerance); });
  for (size_t i = 0; i < answer.forces.size(); ++i)
    add([&](Answer& a) { off(a.forces[i].value, a.forces[i].tolerance); });
  for (size_t i = 0; i < answer.critical.size(); ++i)
    add([&](Answer& a) { off(a.critical[i].load_factor, a.critical_tolerance); });
  for (size_t i = 0; i < answer.buckling.size(); ++i) add([&](Answer& a) { off(a.buckling[i], kTwin); });
  if (answer.load_factor) add([&](Answer& a) { off(*a.load_factor, kDigits); });
  if (answer.all_critical) add([&](Answer& a) { a.critical.push_back({0.5}); });
  if (answer.largest_step) add([&](Answer& a) { *a.largest_step *= 0.5; });
  if (answer.verdict)
    add([&](Answer& a) { a.verdict = a.verdict == Verdict::stable ? Verdict::neutral : Verdict::stable; });
  return all;
}

// ---- structures

Scene without_section(Scene scene, const Section& section) {
  scene.sections = {section};
  scene.sections[0].name = "section";
  return scene;
}

Support in_plane(const std::string& point) { return support(point, {false, false, true}, {true, true, false}); }

Support ball(const std::string& point) { return support(point, {true, true, true}, {}); }

Member member(const std::string& name, const std::string& start, const std::string& end, int order, int elements,
              const Vector3& second_axis) {
  Member member = line(name, start, end, order, elements);
  member.second_axis = second_axis;
  return member;
}

const Section kInextensible = section(kRigid, kRigid, 1.0, 1.0);
Section rod(double axial) { return section(axial, kRigid, 1.0, 1.0); }

/// A cantilever along x under a dead thrust and a force across.
Scene thrust_column(double thrust, double across, bool planar, int order = 5, int elements = 16) {
  Scene scene = cantilever(kInextensible, 1.0, order, elements);
  scene.point_loads = {dead_load("tip", {-thrust, across, 0})};
  if (planar) scene.supports.push_back(in_plane("tip"));
  return scene;
}

/// Between "left" and "right", clamped, with a point "middle" that stays in the plane.
Scene clamped_rod(const Section& section, double length, int order = 5, int elements = 16) {
  Scene scene = structure({{"left", {0, 0, 0}}, {"right", {length, 0, 0}}},
                          {member("rod", "left", "right", order, elements, {0, 1, 0})},
                          {clamp("left"), clamp("right"), in_plane("middle")});
  scene.members[0].inner_points = {{"middle", 0.5}};
  return without_section(scene, section);
}

Scene shortened_column(double axial, double shortening, int order = 5, int elements = 16) {
  Scene scene = clamped_rod(rod(axial), 1.0, order, elements);
  scene.supports[1].prescribed_displacement = {-shortening, 0, 0};
  return scene;
}

/// Polysilicon beam of 500 x 4 x 2 um in um and uN, bent to an arc of this rise.
Scene heated_beam(double kelvin, double rise = 0.0) {
  constexpr double kLength = 500.0, kExpansion = 2.6e-6;
  SectionShape shape;
  shape.kind = SectionShapeKind::rectangle;
  shape.size2 = 2.0;
  shape.size3 = 4.0;
  shape.youngs_modulus = 160000.0;
  shape.poisson_ratio = 0.22;
  Scene scene = clamped_rod(make_section("section", shape), kLength);
  if (rise > 0.0) {
    const double radius = (0.25 * kLength * kLength + rise * rise) / (2.0 * rise);
    scene.members[0].curve.shape = CurveShape::circular_arc;
    scene.members[0].curve.center = {0.5 * kLength, rise - radius, 0};
    scene.members[0].curve.axis = {0, 0, -1};
    scene.members[0].curve.angle = 2.0 * std::asin(0.5 * kLength / radius);
  }
  scene.eigenstrains = {{"rod", {kelvin * kExpansion, 0, 0}}};
  return scene;
}

/// Head guided along the axis and sideways, not turning.
Scene guided_column(double load, bool planar) {
  Scene scene = thrust_column(load, 0.0, false);
  scene.supports.push_back(support("tip", {false, false, planar}, {true, true, true}));
  return scene;
}

Scene sliding_clamps(double load, int order, int elements) {
  Scene scene = thrust_column(load, 0.0, false, order, elements);
  scene.supports.push_back(support("tip", {false, true, true}, {true, true, true}));
  return scene;
}

Scene bowed_column() {
  Scene scene = clamped_rod(rod(1e5), 1.0, 5, 8);
  for (int i : {0, 1}) scene.supports[static_cast<size_t>(i)].rotation_fixed = {true, true, false};
  scene.supports[1].displacement_fixed[0] = false;
  scene.members[0].curve.shape = CurveShape::parametric;
  scene.members[0].curve.formula = {"t", "0.002*sin(3.14159265358979323846*t)", "0"};
  scene.point_loads = {dead_load("right", {-15, 0, 0})};
  return scene;
}

Scene argyris_frame(double load) {
  return structure(
      {{"clamp", {0, 0, 0}}, {"corner", {240, 0, 0}}, {"tip", {240, -240, 0}}},
      {member("leg 1", "clamp", "corner", 5, 12, {0, 1, 0}), member("leg 2", "corner", "tip", 5, 12, {1, 0, 0})},
      {clamp("clamp")}, {dead_load("tip", {load, 0, 2e-4})},
      {"", 1282320.0, {489435.0, 489435.0}, 58732.21374, {38469.6, 96174000.0}});
}

Scene dome(int legs, double rise, double first, int elements) {
  Scene scene;
  scene.points = {{"apex", {0, 0, rise}}};
  for (int i = 0; i < legs; ++i) {
    const double angle = first + 2.0 * kPi * i / legs;
    const std::string foot = "foot " + std::to_string(i);
    scene.points.push_back({foot, {std::cos(angle), std::sin(angle), 0}});
    scene.members.push_back(
        member("leg " + std::to_string(i), foot, "apex", 5, elements, {-std::sin(angle), std::cos(angle), 0}));
    scene.supports.push_back(clamp(foot));
  }
  return scene;
}

Scene star_dome(double load) {
  Scene scene = dome(3, 0.5, 0.0, 16);
  scene.supports.push_back(support("apex", {true, true, false}, {true, true, true}));
  scene.point_loads = {dead_load("apex", {0, 0, -load})};
  return without_section(scene, {"", 1e4, {kRigid, kRigid}, 1.0, {1.0, 100.0}});
}

/// A shallow star of six legs that nothing holds at its apex, with a lateral force of a hundredth of its load.
Scene free_star_dome() {
  Scene scene = dome(6, 0.15, std::atan2(0.7732386091692593, 0.6341151735213323), 6);
  scene.point_loads = {dead_load("apex", {-0.0018930637415044583, -0.17232142998206598, -18.1})};
  return without_section(scene, {"", 3000.0, {1500.0, 1500.0}, 0.4, {0.5, 0.5}});
}

/// Four quarters of radius 1 and EA = 1e4 under a pressure of 5 that follows them, with a dead force at the top.
Scene pressed_ring(const Vector3& force) {
  const auto name = [](int i) { return "p" + std::to_string(i % 4); };
  Scene scene;
  scene.points = {{"p0", {1, 0, 0}}, {"p1", {0, 1, 0}}, {"p2", {-1, 0, 0}}, {"p3", {0, -1, 0}}};
  for (int i = 0; i < 4; ++i) {
    const Vector3& start = scene.points[static_cast<size_t>(i)].position;
    const std::string quarter = "quarter " + std::to_string(i);
    scene.members.push_back(arc(quarter, name(i), name(i + 1), {0, 0, 0}, {0, 0, 1}, 0.5 * kPi, 5, 16));
    scene.members.back().second_axis = {-start[0], -start[1], 0};
    scene.distributed_loads.push_back({quarter, {0, 5, 0}});
    scene.distributed_loads.back().frame = LoadFrame::follower;
    scene.supports.push_back(in_plane(name(i)));
  }
  scene.supports[0].displacement_fixed = {true, true, true};
  scene.supports[2].displacement_fixed = {false, true, true};
  scene.point_loads = {dead_load("p1", force)};
  return without_section(scene, rod(1e4));
}

/// Williams' toggle.
Scene toggle(double load) {
  return structure({{"left", {-12.943, 0, 0}}, {"apex", {0, 0.386, 0}}, {"right", {12.943, 0, 0}}},
                   {line("left bar", "left", "apex", 5, 12), line("right bar", "apex", "right", 5, 12)},
                   {clamp("left"), clamp("right"), support("apex", {true, false, true}, {true, true, true})},
                   {dead_load("apex", {0, -load, 0})}, section(1.885e6, kRigid, 9.27e3, 9.27e3));
}

/// Da Deppo and Schmidt: 215 degrees, one foot clamped, the other one hinged.
Scene clamped_hinged_arch(double load) {
  const double half = 1.8762289458939043, x = 100.0 * std::sin(half), y = 100.0 * std::cos(half);
  return structure({{"left", {-x, y, 0}}, {"crown", {0, 100, 0}}, {"right", {x, y, 0}}},
                   {arc("left half", "left", "crown", {0, 0, 0}, {0, 0, -1}, half, 5, 16),
                    arc("right half", "crown", "right", {0, 0, 0}, {0, 0, -1}, half, 5, 16)},
                   {clamp("left"), hinged("right"), in_plane("crown")}, {dead_load("crown", {0, -load, 0})},
                   section(1e8, 1e8, 1e6, 1e6));
}

/// Upright on a rotational spring of stiffness 1.
Scene spring_column(double bending) {
  Scene scene = cantilever(section(kRigid, kRigid, bending, bending), 1.0, 2, 2);
  scene.points[1].position = {0, 0, 1};
  scene.supports[0].rotation_fixed = {true, false, true};
  scene.supports[0].rotation_stiffness = {0, 1.0, 0};
  scene.point_loads = {dead_load("tip", {0, 0, -1.2})};
  return scene;
}
/// EI x tan(x) = 1, P = EI x^2
double spring_load(double bending) {
  double low = 0.0, high = 1.0;
  for (int i = 0; i < 200; ++i) {
    const double x = 0.5 * (low + high);
    (bending * x * std::tan(x) < 1.0 ? low : high) = x;
  }
  return bending * low * low;
}

/// The frame of scenes.md under its snow.
Scene three_hinged_frame() {
  SectionShape shape;
  shape.kind = SectionShapeKind::i_section;
  shape.size2 = 0.1;
  shape.size3 = 0.2;
  shape.wall = 0.01;
  shape.web = 0.006;
  shape.youngs_modulus = 206e9;
  shape.poisson_ratio = 0.3;
  Scene scene;
  scene.points = {
      {"foot 1", {0, 0, 0}}, {"eave 1", {0, 0, 3}}, {"ridge", {4, 0, 5}}, {"eave 2", {8, 0, 3}}, {"foot 2", {8, 0, 0}}};
  scene.members = {line("column 1", "foot 1", "eave 1", 2, 4), line("rafter 1", "eave 1", "ridge", 2, 4),
                   line("rafter 2", "ridge", "eave 2", 2, 4), line("column 2", "eave 2", "foot 2", 2, 4)};
  for (Member& member : scene.members) member.second_axis = {0, 1, 0};
  for (const char* foot : {"foot 1", "foot 2"})
    scene.supports.push_back(support(foot, {true, true, true}, {true, false, true}));
  scene.joints = {joint(JointKind::hinge, "ridge", {"rafter 2"}, {0, 1, 0})};
  scene.distributed_loads = {{"rafter 1", {0, 0, -4000}, {}, 1}, {"rafter 2", {0, 0, -4000}, {}, 1}};
  return without_section(scene, make_section("section", shape));
}

/// A shallow gridshell of 4 x 4 cells on ball joints, steel, loaded far beyond its buckling.
Scene gridshell() {
  constexpr int kCells = 4;
  SectionShape shape;
  shape.size2 = 0.01;
  shape.youngs_modulus = 2.1e11;
  shape.poisson_ratio = 0.3;
  Scene scene;
  const auto border = [](int i) { return i == 0 || i == kCells; };
  const auto name = [](int i, int j) { return "p" + std::to_string(i) + std::to_string(j); };
  for (int i = 0; i <= kCells; ++i)
    for (int j = 0; j <= kCells; ++j) {
      if (border(i) && border(j)) continue;
      const double z = 16.0 * i * (kCells - i) * j * (kCells - j) / std::pow(kCells, 4);
      scene.points.push_back({name(i, j), {static_cast<double>(i), static_cast<double>(j), z}});
      if (border(i) || border(j))
        scene.supports.push_back(ball(name(i, j)));
      else
        scene.point_loads.push_back(dead_load(name(i, j), {0, 0, -5e3}));
      for (const auto& [k, l] : {std::pair{i + 1, j}, {i, j + 1}})
        if (k <= kCells && l <= kCells && !((border(i) || border(j)) && (border(k) || border(l))))
          scene.members.push_back(line(name(i, j) + name(k, l), name(i, j), name(k, l), 2, 4));
    }
  return without_section(scene, make_section("section", shape));
}

/// Two half circles, turned at one side by two full turns.
Scene deployed_ring() {
  Scene scene;
  scene.accuracy = 1e-8;
  scene.points = {{"A", {0, 0, 0}}, {"C", {40, 0, 0}}};
  scene.members = {arc("upper", "A", "C", {20, 0, 0}, {0, 0, -1}, kPi, 2, 1),
                   arc("lower", "C", "A", {20, 0, 0}, {0, 0, -1}, kPi, 2, 1)};
  scene.members[0].second_axis = {1, 0, 0};
  scene.members[1].second_axis = {-1, 0, 0};
  scene.supports = {clamp("A"), clamp("C")};
  scene.supports[1].displacement_fixed[0] = false;
  scene.supports[1].prescribed_rotation = {4.0 * kPi, 0, 0};
  return without_section(
      scene,
      {"", 7e6, {2692307.6923076925, 2692307.6923076925}, 78774.23076923077, {583333.3333333334, 64814.81481481482}});
}

/// Rolled to a closed ring by its end.
Scene rolled_ring() {
  Scene scene = cantilever(section(kRigid, kRigid, 0.7, 1.3), 4.0 * kPi, 2, 1);
  scene.accuracy = 1e-6;
  Support end = clamp("tip");
  end.prescribed_rotation = {0, 0, 2.0 * kPi};
  end.prescribed_displacement = {-4.0 * kPi, 0, 0};
  scene.supports.push_back(end);
  return scene;
}

Scene heavy_column() {
  Scene scene = cantilever(section(kRigid, kRigid, 0.7, 1.3), 2.0, 2, 1);
  scene.accuracy = 1e-6;
  scene.distributed_loads = {{"beam", {-2.5471379176566376, 0, 0}, {}, 1}};
  return scene;
}

Scene lateral_cantilever() {
  Scene scene = cantilever(kInextensible, 1.0, 2, 16);
  scene.sections[0].bending_stiffness = {100.0, 1.0};
  scene.members[0].second_axis = {0, 1, 0};
  scene.point_loads = {dead_load("tip", {0, 0, -1})};
  return scene;
}

Scene lateral_frame() {
  return structure({{"a", {0, 0, 0}}, {"b", {0, 0, 1}}, {"tip", {1, 0, 1}}},
                   {member("column", "a", "b", 3, 8, {0, 1, 0}), member("beam", "b", "tip", 3, 8, {0, 1, 0})},
                   {clamp("a")}, {dead_load("tip", {0, 0, -10})}, {"", kRigid, {kRigid, kRigid}, 1.0, {1000.0, 10.0}});
}

// ---- the table

constexpr double kEuler = kPi * kPi / 4.0;

SolverParameters controlled(const std::string& point, int component, double target) {
  SolverParameters parameters;
  parameters.analysis.control = MonitoredComponent{point, component, target};
  return parameters;
}
SolverParameters traced() {
  SolverParameters parameters;
  parameters.analysis.trace = true;
  return parameters;
}
SolverParameters on_branch(double maximum_step = 1.0) {
  SolverParameters parameters;
  parameters.analysis.branch = Branch::positive;
  parameters.load_path.maximum_step = maximum_step;
  return parameters;
}
SolverParameters without_stability() {
  SolverParameters parameters;
  parameters.analysis.stability = false;
  return parameters;
}
Answer at_end(std::vector<End> ends, int negative = 0) {
  Answer answer;
  answer.ends = std::move(ends);
  answer.negative = negative;
  return answer;
}
/// After one bifurcation, on its stable branch.
Answer on_branch_at(double bifurcation, std::vector<End> ends, std::vector<End> forces = {},
                    double critical_tolerance = kDigits) {
  Answer answer = at_end(std::move(ends));
  answer.forces = std::move(forces);
  answer.critical = {{bifurcation, CriticalKind::bifurcation}};
  answer.critical_tolerance = critical_tolerance;
  answer.all_critical = answer.counts_follow = false;
  return answer;
}
Answer at_load_factor(double load_factor, std::vector<End> ends = {}) {
  Answer answer = at_end(std::move(ends), -1);
  answer.load_factor = load_factor;
  answer.all_critical = answer.counts_follow = false;
  return answer;
}
Answer limits(std::vector<double> load_factors) {
  Answer answer;
  for (double load_factor : load_factors) answer.critical.push_back({load_factor, CriticalKind::limit_point});
  answer.negative = -1;
  return answer;
}

void add(std::vector<KnownPath>& table, const std::string& name, const Scene& scene, const Answer& answer,
         const SolverParameters& parameters = {}) {
  table.push_back({name, scene, parameters, answer});
}

/// P / P_cr, e, x, y of the tip by shooting. Each in the plane with e and in space with -e, where y changes its sign.
void add_imperfect_columns(std::vector<KnownPath>& table) {
  struct Row {
    double load, e, x, y;
  };
  for (const Row& row : {Row{1.05, 1e-4, 0.90498259324, 0.38064428348}, Row{1.2, 1e-6, 0.67391082498, 0.64878450511},
                         Row{1.2, 1e-2, 0.66263391594, 0.65716809204}, Row{1.5, 1e-4, 0.36356255916, 0.78858405530},
                         Row{1.5, 0.1, 0.34171752220, 0.79568923565}, Row{2, 1e-6, 0.07086194455, 0.79696148213},
                         Row{4, 1e-2, -0.33452079981, 0.63016719375}, Row{8, 1e-4, -0.54784720364, 0.44971259087}}) {
    const double load = row.load * kEuler;
    std::ostringstream name;
    name << "ImperfectColumnOf" << row.load << "Euler" << row.e;
    add(table, name.str(), thrust_column(load, row.e * load, true),
        at_end({{"tip", kX, row.x - 1.0}, {"tip", kY, row.y}}));
    add(table, name.str() + "InSpace", thrust_column(load, -row.e * load, false),
        at_end({{"tip", kX, row.x - 1.0}, {"tip", kY, -row.y}}));
  }
  add(table, "ImperfectColumnWithoutStability", thrust_column(1.2 * kEuler, 0.012 * kEuler, true),
      at_end({{"tip", kX, -0.33736608406}, {"tip", kY, 0.65716809204}}), without_stability());
  // twice the load on the way, and back
  SolverParameters small_steps;
  small_steps.load_path.initial_step = small_steps.load_path.maximum_step = 0.02;
  Scene there_and_back = thrust_column(1.5 * kEuler, 1.5e-4 * kEuler, true);
  there_and_back.point_loads[0].amplitude = "sqrt(2)*sin(0.75*pi*t)";
  add(table, "ImperfectColumnThereAndBack", there_and_back,
      at_end({{"tip", kX, 0.36356255916 - 1.0}, {"tip", kY, 0.78858405530}}), small_steps);
  // Shooting with Runge-Kutta 8(5, 3): the real eigenvalues that pass zero are two, which no determinant tells.
  add(table, "RingUnderPressure", pressed_ring({2e-5, -1e-4, 0}),
      at_end({{"p1", kX, -0.2479916520321, 1e-5},
              {"p1", kY, -0.9419831507033, 1e-5},
              {"p2", kX, -0.7068451300314, 1e-5}}));
  add(table, "ImperfectColumnControlled", thrust_column(1.2 * kEuler, 0.012 * kEuler, true),
      at_load_factor(1.0, {{"tip", kX, -0.33736608406, 1e-7}}), controlled("tip", kY, 0.65716809204));
  add(table, "BowedColumn", bowed_column(),
      at_end({{"middle", kY, 0.394240682192777, 1e-7}, {"right", kX, -0.6562971067206078, 1e-7}}));
  for (const auto& [load, tip] : {std::pair<double, Vector3>{1.1, {3.0843324211, 2.2520658869, 17.7595856454}},
                                  {1.5, {63.1635638908, 52.2465921473, 60.8029956898}}})
    add(table, "ArgyrisFrame" + std::to_string(load), argyris_frame(load),
        at_end({{"tip", kX, tip[0], 1e-6}, {"tip", kY, tip[1], 1e-6}, {"tip", kZ, tip[2], 1e-6}}));
}

/// Pinned at the origin and at `far`, which moves in the stage in which the weight grows; EI carries next to nothing.
Scene limp_cable(const Section& section, const Vector3& far, const Vector3& moved, double weight) {
  Scene scene = structure({{"near", {0, 0, 0}}, {"far", far}}, {line("cable", "near", "far", 4, 40)},
                          {support("near", {true, true, true}, {true, false, false}), ball("far")});
  scene.supports[1].prescribed_displacement = moved;
  scene.distributed_loads = {{"cable", {0, 0, -weight}}};
  return without_section(scene, section);
}

/// Sixteen cables that cannot stretch, drawn flat; three points of the net move as its weight grows. Outside: each
/// cable the catenary of closed form between its ends, the free points where forces balance, by Newton's method.
Scene limp_net() {
  const std::vector<Vector3> points = {{2, -6, 0},  {31, -2, 0}, {61, -3, 0}, {21, 28, 0}, {44, 35, 0},
                                       {87, 31, 0}, {-6, 52, 0}, {27, 56, 0}, {65, 57, 0}};
  const std::vector<std::pair<int, int>> ends = {{0, 1}, {0, 3}, {1, 2}, {1, 3}, {1, 4}, {2, 4}, {2, 5}, {3, 4},
                                                 {3, 6}, {3, 7}, {4, 5}, {4, 7}, {4, 8}, {5, 8}, {6, 7}, {7, 8}};
  const std::vector<std::pair<int, Vector3>> moved = {{2, {-5, 6, 7}}, {8, {-2, -2, -13}}, {0, {7, 7, 9}}};
  Scene scene;
  for (size_t i = 0; i < points.size(); ++i) scene.points.push_back({std::to_string(i), points[i]});
  for (const auto& [from, to] : ends) {
    const std::string name = "m" + std::to_string(scene.members.size());
    scene.members.push_back(line(name, std::to_string(from), std::to_string(to), 4, 6));
    scene.distributed_loads.push_back({name, {0, 0, -0.3}});
  }
  for (const auto& [point, motion] : moved) {
    scene.supports.push_back(ball(std::to_string(point)));
    scene.supports.back().prescribed_displacement = motion;
  }
  return without_section(scene, section(kRigid, kRigid, 0.055, 0.055));
}

/// Extensible catenary, H and V by bisection; bending at the ends changes them by up to sqrt(EI / H) / L.
void add_cables(std::vector<KnownPath>& table) {
  const auto hangs = [](double horizontal, double vertical, double tolerance) {
    Answer answer = at_end({});
    answer.forces = {{"near", kX, -horizontal, tolerance}, {"near", kZ, -vertical, tolerance}};
    answer.counts_follow = false;
    return answer;
  };
  add(table, "CableInTension",
      limp_cable(section(1.00104e7, kRigid, 0.000888065, 0.000888065), {6.345707182475867, 0, 33.5848565658017},
                 {0.009148334269823977, 0, 0.048417849332302865}, 0.400491),
      hangs(2679.380401753061, 14173.862616968127, 3e-5));
  add(table, "CableSlackAndSteep",
      limp_cable(section(157784, kRigid, 0.000181466, 0.000181466), {2.155790280685684, 0, 7.134435175402628},
                 {-0.31818290247413317, 0, -1.0530037694117134}, 5.85337),
      hangs(2.1962189218648644, -3.7489758218681395, 2e-3));
  add(table, "CableInextensible",
      limp_cable(section(kRigid, kRigid, 3.21527e-05, 3.21527e-05), {39.13529337123328, 0, 13.124504664246897},
                 {-0.0020011047118728698, 0, -0.0006710952151429694}, 0.0118851),
      hangs(12.587611157887025, 3.9765978569347524, 4.9e-05));
  Answer net = hangs(0.0, 0.0, 0.0);
  net.forces = {
      {"2", kX, 17.331701, 2e-3}, {"2", kZ, 55.265522, 2e-3}, {"8", kY, 47.917013, 2e-3}, {"0", kZ, 65.515054, 2e-3}};
  add(table, "NetOfInextensibleCables", limp_net(), net);
  // As limp as a cable under its thrust, but nothing tells it a side: it buckles, and does not turn over unseen.
  Answer buckled = on_branch_at(1.0 / 12000.0, {});
  buckled.negative = -1;
  add(table, "LimpColumnBuckles", thrust_column(12000.0 * kEuler, 0.0, true), buckled);
}

void add_held_rods(std::vector<KnownPath>& table) {
  add(table, "Shortened", shortened_column(1e5, 0.1),
      on_branch_at(0.003949401537686192, {{"middle", kNorm, 0.2008676085929182, 1e-7}},
                   {{"right", kX, -41.577476268473255, 1e-7}}),
      on_branch());
  add(table, "ShortenedByLittle", shortened_column(1e6, 1e-4),
      on_branch_at(0.3947997627284927, {{"middle", kY, 0.004952416568474079, 1e-7}},
                   {{"right", kX, -39.481170954514695, 1e-7}}, 1e-7),
      on_branch());
  add(table, "ShortenedOnTheFirstMode", shortened_column(1e5, 0.05),
      on_branch_at(0.007898803075372385, {{"middle", kY, 0.1395600431444605, 1e-7}},
                   {{"right", kX, -40.50150664874485, 1e-7}}, 1e-7),
      on_branch());
  add(table, "ShortenedStiff", shortened_column(1e6, 0.05),
      on_branch_at(0.0007895995254569854, {{"middle", kY, 0.14005566841015288, 3e-6}},
                   {{"right", kX, -40.4947233951129, 3e-6}}, 3e-6),
      on_branch());
  // d / L = 2 (1 - E(k) / K(k)), P = (4 K)^2 EI / L^2, rise 4 k / sqrt(P): four quarters of the elastica
  Answer stiffest = at_end({{"middle", kX, -0.15, 1e-7}, {"middle", kY, 0.3143126129561071, 1e-7}});
  stiffest.forces = {{"right", kX, -46.61212087983138, 1e-7}};
  stiffest.counts_follow = false;
  Scene shortened = shortened_column(kRigid, 0.3);
  add(table, "ShortenedInextensible", shortened, stiffest, on_branch());
  shortened.sections.push_back(section(1e6, 1e6, 1e-6, 1e-6));
  shortened.sections.back().name = "unused";  // a soft section that no member has makes no cable
  add(table, "ShortenedBesideAnUnusedSection", shortened, stiffest, on_branch());
  add(table, "ShortenedFortyElements", shortened_column(1e5, 0.2, 2, 40),
      on_branch_at(0.001974700768843096, {{"middle", kY, 0.26606599340507237, 1e-3}},
                   {{"right", kX, -43.93556761494532, 1e-3}}, 1e-3),
      on_branch());
  Scene rail = clamped_rod(rod(1e5), 1.0);
  rail.eigenstrains = {{"rod", {1.184352528130723e-3, 0, 0}}};
  add(table, "HeatedRail", rail,
      on_branch_at(1.0 / 3.0, {{"middle", kNorm, 0.017896489281772322, 1e-7}},
                   {{"right", kX, -39.46282370657218, 1e-7}}),
      on_branch());
  add(table, "HeatedBeam", heated_beam(60),
      on_branch_at(0.3373711649271528, {{"middle", kY, 3.236481657255322, 1e-7}},
                   {{"right", kX, -67.36279424079446, 1e-7}}),
      on_branch());
  Answer thousand = on_branch_at(0.02024226989562917, {{"middle", kY, 16.07387567361276, 1e-7}});
  thousand.largest_step = 0.01;
  add(table, "HeatedBeamInSteps", heated_beam(1000), thousand, on_branch(0.01));
  Answer arch = at_end({{"middle", kY, 3.224683882753302, 1e-7}});
  arch.forces = {{"right", kX, -67.02577371328903, 1e-7}};
  add(table, "HeatedArch", heated_beam(60, 0.02), arch);
  Answer higher = at_end({{"middle", kY, 3.1204569246337304, 1e-7}});
  higher.forces = {{"right", kX, -64.0330661697116, 1e-7}};
  add(table, "HeatedArchTenth", heated_beam(60, 0.2), higher);
  Scene pushed = heated_beam(60);
  pushed.point_loads = {dead_load("middle", {0, 1e-4, 0})};
  add(table, "HeatedBeamTinyForce", pushed, at_end({{"middle", kY, 3.236522407056696, 1e-7}}));
}

void add_branches(std::vector<KnownPath>& table) {
  Answer guided = on_branch_at(0.6585928481674665, {{"tip", kX, -0.6510106995851659, 1e-7}});
  add(table, "GuidedColumn", guided_column(14.985896716843365, true), guided, on_branch());
  guided.may_be_refused = true;
  guided.negative = -1;  // it may turn about its axis at no cost
  add(table, "GuidedColumnInSpace", guided_column(14.985896716843365, false), guided, on_branch());
  add(table, "GuidedColumn15", guided_column(15.0, true),
      on_branch_at(0.6579736267392905, {{"tip", kX, -0.652128645004348, 1e-6}, {"tip", kNorm, 1.025742454279261, 1e-6}},
                   {}, 1e-7),
      on_branch());
  Scene above = thrust_column(1.001 * kEuler, 0.0, true);
  above.sections[0] = rod(1e5);
  above.sections[0].name = "section";
  // P (1 - P / EA) = pi^2 / 4
  const double critical = 0.5e5 * (1.0 - std::sqrt(1.0 - 4e-5 * kEuler));
  add(table, "JustAboveCritical", above, on_branch_at(critical / (1.001 * kEuler), {}), on_branch());
  Scene column = clamped_rod(kInextensible, 1.0);
  column.supports[1].displacement_fixed[0] = false;
  column.point_loads = {dead_load("right", {-1, 0, 0})};
  SolverParameters both = controlled("right", kX, -0.1);
  both.analysis.branch = Branch::positive;
  // elliptic integrals; the column of EA = 1e4, by shooting, buckles at another load
  add(table, "BranchUnderControl", column, at_load_factor(41.5702557932, {{"middle", kY, 0.194924311376, 1e-7}}), both);
  column.accuracy = 1e-8;
  column.point_loads = {dead_load("right", {-46.6121208798, 0, 0})};
  const Answer to_positive_y =
      on_branch_at(0.8469560461786656, {{"right", kX, -0.3, 1e-7}, {"middle", kY, 0.314312612956, 1e-7}});
  add(table, "SignOfTheBranch", column, to_positive_y, on_branch());
  column.accuracy.reset();
  for (const auto& [order, elements] : {std::pair{4, 24}, {5, 17}, {8, 6}}) {  // components of the mode tie
    column.members[0].order = order;
    column.members[0].elements = elements;
    add(table, "SignOfTheBranchOn" + std::to_string(elements), column, to_positive_y, on_branch());
  }
  for (const double bending : {1e4, 1e6, 1e8, 1e9, 1e10}) {
    std::ostringstream name;
    name << "StiffColumnOnASpring" << bending;
    const double digits = 1e-7 + 10.0 / bending;  // of the rigid bar, theta = 1.2 sin(theta)
    Answer stiff = on_branch_at(spring_load(bending) / 1.2, {{"tip", kZ, -0.4823876389877719, digits}});
    add(table, name.str(), spring_column(bending), stiff, on_branch());
  }
  Answer neutral = on_branch_at(4.0 * kPi * kPi / 50.0, {}, {}, 1e-6);
  neutral.verdict = Verdict::neutral;
  add(table, "RoundColumnIsNeutral", sliding_clamps(50.0, 5, 8), neutral, on_branch());
}

void add_snaps(std::vector<KnownPath>& table) {
  for (const auto& [w, load] :
       {std::pair{0.10, 53.08729238}, {0.25, 22.31637839}, {0.50, -11.32642851}, {0.75, -4.006548209}})
    add(table, "StarDomeDownBy" + std::to_string(w), star_dome(1.0), at_load_factor(load), controlled("apex", kZ, -w));
  add(table, "StarDomeTraced", star_dome(100.0), limits({0.7452625445, -0.1583784735}), traced());
  table.back().answer.only_limits = true;
  // two-node elements by arc length, the end by multiple shooting; steps once led to another path, and round and round
  Answer beyond;
  beyond.ends = {{"apex", kZ, -0.275933219767}};
  beyond.all_critical = false;
  beyond.verdict = Verdict::stable;
  add(table, "FreeStarDomeBeyondItsLimit", free_star_dome(), beyond);
  for (const double load : {40.0, 80.0, 100.0})
    add(table, "ToggleTraced" + std::to_string(static_cast<int>(load)), toggle(load),
        limits({33.86123302 / load, 31.26258313 / load}), traced());
  add(table, "Toggle", toggle(100.0), limits({0.3386123302, 0.3126258313}));
  // Da Deppo and Schmidt 1975: 8.97 EI / R^2; its digits and the second one by 394 steps of release 0.1.0
  Answer arch = limits({0.4486445669, -0.03652438011});
  arch.negative = 0;
  add(table, "ClampedHingedArch", clamped_hinged_arch(2000.0), arch);
}

void add_counts(std::vector<KnownPath>& table) {
  const auto primary = [](std::vector<Critical> critical, double tolerance) {
    Answer answer;
    answer.critical = std::move(critical);
    answer.critical_tolerance = tolerance;
    answer.negative = 0;
    for (const Critical& point : answer.critical) answer.negative += std::max(point.modes, 1);
    return answer;
  };
  const CriticalKind bifurcation = CriticalKind::bifurcation;
  // q (1 - q / EA) = 3, for both directions of the ellipse
  Answer ellipse = primary({{0.2 * 0.5e4 * (1.0 - std::sqrt(1.0 - 12e-4)), bifurcation, 2}}, 1e-5);
  ellipse.verdict = Verdict::unstable;
  add(table, "PerfectRingUnderPressure", pressed_ring({}), ellipse);
  for (const double apart : {1e-2, 1e-4}) {  // two points, not a double one
    Scene nearly_round = thrust_column(1.2 * kEuler, 0.0, false);
    nearly_round.sections[0].bending_stiffness = {1.0, 1.0 + apart};
    add(table, "NearlyRoundColumn" + std::to_string(static_cast<int>(-std::log10(apart))), nearly_round,
        primary({{1.0 / 1.2, bifurcation, 1}, {(1.0 + apart) / 1.2, bifurcation, 1}}, kDigits));
  }
  SolverParameters halves;  // the first ends where an eigenvalue is zero
  halves.load_path.method = LoadPathMethod::fixed;
  halves.load_path.steps = 2;
  for (const bool planar : {false, true})
    add(table, planar ? "StepToEulersLoad" : "StepToEulersLoadInSpace", thrust_column(2.0 * kEuler, 0.0, planar),
        primary({{0.5, bifurcation, planar ? 1 : 2}}, kDigits), halves);
  // On an axis of no direction of the coordinates: next to the critical load rounding is motion.
  for (const double share : {1.0 - 1e-5, 1.0 - 1e-6, 1.0 + 1e-6}) {
    Scene turned = thrust_column(0.0, 0.0, false, 4, 8);
    const Vector3 axis = {1.0 / std::sqrt(14.0), 2.0 / std::sqrt(14.0), 3.0 / std::sqrt(14.0)};
    turned.points.back().position = axis;
    const double thrust = -share * kEuler;
    turned.point_loads[0].force = {thrust * axis[0], thrust * axis[1], thrust * axis[2]};
    Answer beside = primary({}, 1e-7);
    if (share > 1.0) beside.critical = {{1.0 / share, bifurcation, 2}}, beside.negative = 2;
    add(table, "EndsAt" + std::to_string(share) + "OfEulersLoad", turned, beside);
  }
  add(table, "BucklesInsideItsElement", sliding_clamps(60.0, 8, 1),
      primary({{4.0 * kPi * kPi / 60.0, bifurcation, 2}}, 1e-6));
  add(table, "CantileverOfOneElement", thrust_column(70.0, 0.0, false, 8, 1),
      primary({{kEuler / 70, bifurcation, 2}, {9 * kEuler / 70, bifurcation, 2}, {25 * kEuler / 70, bifurcation, 2}},
              1e-2));
  Answer split = primary({{4.0 * kPi * kPi / 100.0, bifurcation, 2}}, 0.25);
  split.all_critical = false;
  split.negative = -1;
  add(table, "DoublePointIsNotSplit", sliding_clamps(100.0, 2, 2), split);
  for (const double axial : {1e5, 1e8}) {
    Scene column = cantilever(rod(axial), 1.0, 2, 1);
    column.supports.push_back(in_plane("tip"));
    column.accuracy = 1e-6;
    column.point_loads = {dead_load("tip", {-1.5 * kEuler, 0, 0})};
    // P (1 - P / EA) = pi^2 / 4
    const double critical = 0.5 * axial * (1.0 - std::sqrt(1.0 - 4.0 * kEuler / axial));
    add(table, "PerfectColumnToAccuracy" + std::to_string(static_cast<int>(std::log10(axial))), column,
        primary({{critical / (1.5 * kEuler), bifurcation, 1}}, 1e-6));
  }
  add(table, "HeavyColumnToAccuracy", heavy_column(), primary({{0.5, bifurcation, 2}}, 1e-6));
  Answer frame = primary({{0.2819452262389, bifurcation, 1}}, 3e-5);
  frame.all_critical = false;
  frame.negative = -1;
  add(table, "FrameOfThePages", three_hinged_frame(), frame);
  Answer shell;
  shell.negative = -1;
  shell.may_be_refused = true;
  shell.all_critical = false;
  add(table, "Gridshell", gridshell(), shell);
}

void add_others(std::vector<KnownPath>& table) {
  Scene bent = thrust_column(0.0, 1.0, false, 5, 8);
  bent.sections[0] = rod(1e3);
  bent.sections[0].name = "section";
  add(table, "ControlOfSecondOrder", bent, at_load_factor(1.4290197764670223, {{"tip", kY, 0.397695562}}),
      controlled("tip", kX, -0.1));
  Answer ring = at_end({{"C", kX, 0.0}}, -1);
  ring.all_critical = false;
  add(table, "RingTurnedTwice", deployed_ring(), ring);
  Answer rolled = at_end({}, -1);
  rolled.all_critical = false;
  rolled.moment_energy = 2.0420352248333655;
  rolled.verdict = Verdict::neutral;
  add(table, "RodRolledToARing", rolled_ring(), rolled);
  // A closed ring turns about the tangent of its clamp at no cost; at orders 3 and 5 two ways of counting disagreed.
  for (const auto& [order, elements] : {std::pair{3, 100}, {5, 38}}) {
    Scene closed = rolled_ring();
    closed.accuracy.reset();
    closed.sections[0].axial_stiffness = 1e4;
    closed.members[0].order = order;
    closed.members[0].elements = elements;
    add(table, "RodRolledToARingOf" + std::to_string(elements), closed, rolled);
  }
  // 2 j_{-1/4,1} and the next, sqrt(EI GIt) / L^2; the load reversed buckles it too
  for (auto& [scene, factors] : {std::pair<Scene, std::vector<double>>{lateral_cantilever(), {4.0125993, -4.0125993}},
                                 {lateral_frame(), {0.4349214, -0.5267867}}}) {
    Answer linear;
    linear.negative = -1;
    linear.all_critical = false;
    linear.buckling = factors;
    add(table, scene.points.size() == 2 ? "LateralBuckling" : "LateralBucklingOfAFrame", scene, linear);
  }
}

std::vector<KnownPath> known_paths() {
  std::vector<KnownPath> table;
  add_imperfect_columns(table);
  add_held_rods(table);
  add_cables(table);
  add_branches(table);
  add_snaps(table);
  add_counts(table);
  add_others(table);
  for (KnownPath& path : table) path.scene.name = path.name;
  return table;
}

std::string joined(const std::vector<std::string>& texts) {
  std::string all;
  for (const std::string& text : texts) all += "\n  " + text;
  return all;
}

class KnownPaths : public testing::TestWithParam<KnownPath> {};

TEST_P(KnownPaths, EndAtTheAnswerAndNowhereElse) {
  const KnownPath& path = GetParam();
  const Walk walk = Walker(path).walk();
  const std::vector<std::string> wrong = judge(walk, path.answer);
  EXPECT_TRUE(wrong.empty()) << path.name << joined(wrong);
  if (!wrong.empty() || walk.refused) return;
  for (const Answer& twin : twins(path.answer))
    EXPECT_FALSE(judge(walk, twin).empty()) << path.name << ": a wrong answer passes";
}

std::string name_of_path(const testing::TestParamInfo<KnownPath>& info) {
  std::string name;
  for (char letter : info.param.name) name += std::isalnum(static_cast<unsigned char>(letter)) ? letter : '_';
  return name;
}

INSTANTIATE_TEST_SUITE_P(All, KnownPaths, testing::ValuesIn(known_paths()), name_of_path);

}  // namespace
}  // namespace mixbeam::test::known_paths_test
