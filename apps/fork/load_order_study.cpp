// Path independence: the two forces in either order.
#include "apps/common/studies/variants.hpp"
#include "apps/fork/fork_study.hpp"

#include <algorithm>
#include <cmath>
#include <ostream>

namespace mixbeam {

namespace {

/// Both paths are solved to 1e-11 of the scaled residual, and lengths of the scene are of order 1.
constexpr double kMirrorTolerance = 1e-10;

const char* const kMirrorSource = "symmetry of structure and loads: a half turn about the shaft exchanges both tines";

/// What the paper draws, at one load factor.
struct Displacements {
  double load_factor = 0.0;
  Vector3 p1{}, p2{}, branching{};
};

/// The second load first.
Scene reversed(Scene scene) {
  for (PointLoad& load : scene.point_loads) load.stage = scene.stages + 1 - load.stage;
  return scene;
}

std::vector<Displacements> follow(Application& app, const Scene& scene, const std::string& path, StudyTable& csv) {
  std::vector<Displacements> found;
  const auto note = [&](const Simulation& simulation, const StepReport& report) {
    found.push_back({report.load_factor, simulation.displacement("P1"), simulation.displacement("P2"),
                     simulation.displacement("PB")});
    std::vector<CsvCell> cells{path, report.load_factor};
    for (const Vector3& u : {found.back().p1, found.back().p2, found.back().branching})
      for (const double component : u) cells.emplace_back(component);
    csv.add_row(cells);
  };
  app.solve(scene, with_fixed_steps(app.solver, app.study().get<int>("Curve Steps")), "", note);
  return found;
}

/// Turned by half a turn about e1, the axis of the shaft.
Vector3 mirrored(const Vector3& u) { return {u[0], -u[1], -u[2]}; }

double difference(const Vector3& a, const Vector3& b) {
  return std::max({std::abs(a[0] - b[0]), std::abs(a[1] - b[1]), std::abs(a[2] - b[2])});
}

/// Largest deviation of one path from the mirror image of the other, over all steps; NaN if the paths cannot be
/// compared.
double deviation_from_mirror(const std::vector<Displacements>& forward, const std::vector<Displacements>& reverse) {
  if (forward.size() != reverse.size()) return std::nan("");
  double largest = 0.0;
  for (std::size_t i = 0; i < forward.size(); ++i)
    largest = std::max({largest, difference(forward[i].p1, mirrored(reverse[i].p2)),
                        difference(forward[i].p2, mirrored(reverse[i].p1)),
                        difference(forward[i].branching, mirrored(reverse[i].branching))});
  return largest;
}

double deviation_at_end(const Displacements& forward, const Displacements& reverse) {
  return std::max({difference(forward.p1, reverse.p1), difference(forward.p2, reverse.p2),
                   difference(forward.branching, reverse.branching)});
}

void check(Application& app, const std::string& name, double deviation, const std::string& source) {
  app.summary.check_upper_bound(name, deviation, kMirrorTolerance, source);
  app.out() << "  " << name << ": " << deviation << "\n";
}

}  // namespace

void compare_load_orders(Application& app) {
  StudyTable csv(
      app, "load_displacement.csv",
      {"path", "load_factor", "p1_u1", "p1_u2", "p1_u3", "p2_u1", "p2_u2", "p2_u3", "pb_u1", "pb_u2", "pb_u3"});
  const auto forward = follow(app, app.scene, "forward", csv);
  const auto reverse = follow(app, reversed(app.scene), "reverse", csv);
  app.out() << "Both orders of loading, largest difference of a displacement of P1, P2 or the branching point:\n";
  check(app, "loads in reverse order: one path and the mirror image of the other, all steps",
        deviation_from_mirror(forward, reverse), kMirrorSource);
  check(app, "loads in reverse order: end of both paths", deviation_at_end(forward.back(), reverse.back()),
        "path independence: the same loads, the same state");
  const Vector3 in_one_step = solve_fork(app, app.scene).p1[1];
  check(app, "P1 after " + std::to_string(app.study().get<int>("Curve Steps")) + " load steps per stage and after one",
        difference(forward.back().p1, in_one_step), "path independence: the same loads, the same state");
}

}  // namespace mixbeam
