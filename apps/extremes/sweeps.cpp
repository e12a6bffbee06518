#include "apps/extremes/sweeps.hpp"

#include "apps/common/studies/variants.hpp"
#include "kernels/math/constants.hpp"

#include <cmath>

namespace mixbeam {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kRadiansPerTurn = 2.0 * kPi;

/// Scenes that need some load: F L^2 / EI, a tip that turns by 1.43 radians.
constexpr double kLoad = 10.0;
constexpr double kNext = 1e-12;  ///< to the ends of series, relative

const std::string kElastica = "elastica, elliptic integrals; plus s F / C where EA = GA = C is finite";
const std::string kCircle = "circle of curvature M / EI";
const std::string kHelix = "helix about the moment: constant spatial moment, EI2 = EI3";
const std::string kGaussRule = "k-point Gauss rule of the exact tangent of the circle, exact rotations";
const std::string kPendulum = "elastica of a thrust beside the axis, elliptic integrals; the stable equilibrium";

/// 10^from, 10^(from + step) .. 10^to
std::vector<double> decades(int from, int to, int step = 1) {
  std::vector<double> values;
  for (int i = from; i <= to; i += step) values.push_back(std::pow(10.0, i));
  return values;
}

template <class Value>
std::vector<Value> joined(std::vector<Value> first, const std::vector<Value>& second) {
  first.insert(first.end(), second.begin(), second.end());
  return first;
}

/// Ever closer to `angle` from below.
std::vector<double> approaching(double angle) {
  std::vector<double> values;
  for (double gap : {1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6}) values.push_back(angle * (1.0 - gap));
  return values;
}

void turn_elements(Cantilever& rod, int count, double turn_of_each) {
  rod.elements = count;
  rod.turn_by_gauss_rule(count * turn_of_each);
}

/// `change`: of the inextensible and shear rigid rod of the scene, for a value.
Sweep of_rod(const std::string& name, std::vector<double> values, double allowed, double from, double to,
             const std::string& source, const std::function<void(Cantilever&, double)>& change) {
  return {name,
          std::move(values),
          allowed,
          from,
          to,
          source,
          [change](const Scene& scene, const SolverParameters& solver, double value) {
            Cantilever rod(scene);
            change(rod, value);
            return Trial{rod.in(scene), rod.steps == 0 ? solver : with_fixed_steps(solver, rod.steps),
                         [rod](const Simulation& simulation) { return rod.error(simulation); }};
          }};
}

/// Bars on hinges, half span 1, EA = 1, too stiff to bend: P = 2 EA (l / l0 - 1) sin(slope), elementary. Loaded by
/// twice the load at which they snap through.
Trial snapping_truss(const Scene&, const SolverParameters& solver, double rise) {
  constexpr double kBending = 1e3;
  const double cosine = 1.0 / std::hypot(1.0, rise);
  const double limit = 2.0 * std::pow(1.0 - std::pow(cosine, 2.0 / 3.0), 1.5);
  Scene scene;
  scene.name = "truss";
  scene.sections = {{"bar", 1.0, {kInfinity, kInfinity}, kBending, {kBending, kBending}}};
  scene.points = {{"left", {-1, 0, 0}}, {"apex", {0, rise, 0}}, {"right", {1, 0, 0}}};
  scene.members = {straight_member("left", "apex", "bar", 2, 1), straight_member("apex", "right", "bar", 2, 1)};
  scene.joints = {{"hinge", "apex", {"apex to right"}, JointKind::hinge, {0, 0, 1}}};
  scene.supports = {support_of("left", {true, true, true}, {true, true, false}),
                    support_of("right", {true, true, true}, {true, true, false}),
                    support_of("apex", {true, false, true}, {false, false, false})};
  PointLoad& load = scene.point_loads.emplace_back();
  load.point = "apex";
  load.force = {0, -2.0 * limit, 0};
  return {scene, solver, {}, {0.5, -0.5}};
}

/// Length and EI are 1, and the thrust is EA times the strain of the heat until it buckles at 4 pi^2.
Trial heated_rail(const Scene&, SolverParameters solver, double axial) {
  constexpr double kOverheated = 3.0;
  solver.analysis.branch = Branch::positive;
  Scene scene;
  scene.name = "rail";
  scene.sections = {{"bar", axial, {kInfinity, kInfinity}, 1.0, {1.0, 1.0}}};
  scene.points = {{"left", {0, 0, 0}}, {"right", {1, 0, 0}}};
  scene.members = {straight_member("left", "right", "bar", 5, 16)};
  scene.members[0].inner_points = {{"middle", 0.5}};
  scene.supports = {support_of("left", {true, true, true}, {true, true, true}),
                    support_of("right", {true, true, true}, {true, true, true}),
                    support_of("middle", {false, false, true}, {true, true, false})};
  scene.eigenstrains.resize(1);
  scene.eigenstrains[0].member = "left to right";
  scene.eigenstrains[0].strain = {kOverheated * 4.0 * kPi * kPi / axial, 0, 0};
  return {scene, solver, {}, {1.0 / kOverheated}};
}

std::vector<Sweep> sweeps_of_structure(int most_elements) {
  return {
      of_rod("slenderness", joined(decades(0, 10), {kInfinity}), 1e-9, 1.0, kInfinity, kElastica,
             [](Cantilever& rod, double value) {
               rod.set_slenderness(value);
               rod.pull(kLoad);
             }),
      of_rod("stiffness_ratio", decades(-6, 6), 1e-5, 1e-6, 1e6, kHelix,
             [](Cantilever& rod, double value) {
               rod.torsion = rod.bending / value;
               rod.turn({{0.0, 1.0, 0.0}}, std::min(1.0, value));
             }),
      of_rod("unit_of_length", decades(-9, 9, 3), 1e-9, 1e-9, 1e9, kElastica,
             [](Cantilever& rod, double value) { rod.pull_in_units(value / rod.length, 1.0, kLoad); }),
      of_rod("unit_of_force", decades(-9, 9, 3), 1e-9, 1e-9, 1e9, kElastica,
             [](Cantilever& rod, double value) { rod.pull_in_units(1.0, value, kLoad); }),
      of_rod("elements", joined({1, 2, 5}, decades(1, static_cast<int>(std::log10(most_elements)))), 1e-6, 10.0, 1e5,
             kElastica,
             [](Cantilever& rod, double value) {
               rod.order = 2;
               rod.elements = static_cast<int>(value);
               rod.pull(1.0);
             }),
      of_rod("length_ratio", decades(0, 8), 1e-8, 1.0, 1e8, kElastica,
             [](Cantilever& rod, double value) {
               rod.elements = 24;
               rod.ratio = value;
               rod.pull(kLoad);
             }),
  };
}

std::vector<Sweep> sweeps_of_motion() {
  const double series = 2.0 * std::sqrt(kStumpffSeriesLimit);            // half of the turn is the largest argument
  const double logarithm = 4.0 * std::atan(std::sqrt(kLogSeriesLimit));  // twice the angle to each vertex
  return {
      of_rod("turns", {0.01, 0.1, 0.5, 1, 2, 5, 10, 20, 50, 100}, 1e-9, 0.01, 100.0, kCircle,
             [](Cantilever& rod, double value) {
               rod.elements = 8 * std::max(1, static_cast<int>(value));
               rod.turn({{0.0, 0.0, value * kRadiansPerTurn}}, 0.0);
             }),
      of_rod("load_steps", {1, 2, 5, 10, 20, 50, 100, 200, 500, 1000}, 1e-9, 1.0, 1000.0, kHelix,
             [](Cantilever& rod, double value) {
               rod.steps = static_cast<int>(value);
               rod.torsion = 0.5 * rod.bending;
               rod.turn({{0.0, 2.0, 1.0}}, 1.0);
             }),
      of_rod(
          "element_turn_k1",
          joined(joined({0.1, 1.0, 2.0}, approaching(kPi)), joined(joined({3.5, 4.5}, approaching(2.0 * kPi)), {6.5})),
          1e-9, 0.1, 2.0 * kPi, kGaussRule,
          [](Cantilever& rod, double value) {
            rod.order = 1;
            turn_elements(rod, 2, value);
          }),
      of_rod("element_turn",
             joined(joined({0.1, 1.0, 2.0}, approaching(kPi)),
                    {3.5, 4.5, 6.0, series * (1.0 - kNext), series * (1.0 + kNext), 9.0, 12.0}),
             1e-9, 0.1, 20.0, kGaussRule, [](Cantilever& rod, double value) { turn_elements(rod, 2, value); }),
      of_rod("angle",
             {0.0, 1e-300, 1e-200, 1e-100, 1e-16, 1e-12, 1e-8, 1e-6, 1e-4, logarithm * (1 - kNext),
              logarithm * (1 + kNext)},
             1e-8, 0.0, 1.0, kGaussRule,
             [](Cantilever& rod, double value) {
               rod.order = 1;
               turn_elements(rod, 1, value);
             }),
      of_rod("tip_force", decades(-12, 8, 2), 1e-8, 1e-12, 1e8, kElastica,
             [](Cantilever& rod, double value) {
               rod.elements = 24;
               rod.ratio = std::pow(1.4, 23);
               rod.pull(value);
             }),
      of_rod("order", {1, 2, 3, 4, 5, 6, 7, 8}, 1e-1, 1.0, 8.0, kElastica,
             [](Cantilever& rod, double value) {
               rod.order = static_cast<int>(value);
               rod.elements = 4;
               rod.pull(kLoad);
             }),
      of_rod("imperfection", joined(decades(-8, -1), {0.3}), 1e-8, 1e-8, 0.3, kPendulum,
             [](Cantilever& rod, double value) { rod.push(1.2, value); }),
      of_rod("thrust", {0.5, 0.9, 0.99, 1.0, 1.01, 1.05, 1.2, 1.5, 2.0, 3.0, 5.0, 8.0, 12.0, 20.0}, 1e-7, 0.5, 20.0,
             kPendulum, [](Cantilever& rod, double value) { rod.push(value, 1e-4); }),
  };
}

}  // namespace

std::vector<Sweep> all_sweeps(int most_elements) {
  return joined(sweeps_of_structure(most_elements), sweeps_of_motion());
}

std::vector<Sweep> critical_sweeps() {
  const auto sweep = [](const char* name, const std::vector<double>& values, const char* source, auto trial) {
    constexpr double kLocated = 1e-8;  // of load factors, relative: what the program promises
    return Sweep{name, values, kLocated, 0.0, kInfinity, source, trial};
  };
  return {sweep("truss_rise", {0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 3.0},
                "2 EA (1 - cos(slope)^(2/3))^(3/2), and its negative", snapping_truss),
          sweep("rail_stiffness", {1e3, 1e4, 1e5, 1e6, 1e7, 1e8}, "a third: strain of the heat = 4 pi^2 EI / (EA L^2)",
                heated_rail)};
}

}  // namespace mixbeam
