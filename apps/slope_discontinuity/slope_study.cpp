// Three rods joined at right angles: table, load-displacement curve and shapes of the paper's example.
#include "apps/common/studies/study.hpp"
#include "apps/common/studies/variants.hpp"
#include "apps/common/tables/printed_digits.hpp"
#include "apps/common/tables/table_printer.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <ostream>

namespace mixbeam {

namespace {

const std::string kTip = "tip";

const char* const kSlopeTableSource = "Humer, Steinbrecher, Pechstein, table \"Structure with slope discontinuity\"";

struct Row {
  int order, elements_per_member;
  std::array<const char*, 3> displacement;  // digits of the manuscript, some more than its table shows
};

// Humer, Steinbrecher, Pechstein, table "Structure with slope discontinuity: components of the tip-displacement"
constexpr std::array<Row, 8> kRows = {{{1, 1, {"-1.519637", "-0.1870366", "-2.607832"}},
                                       {2, 1, {"-1.528034", "-0.1713543", "-2.470063"}},
                                       {3, 1, {"-1.535102", "-0.175832", "-2.484094"}},
                                       {4, 1, {"-1.535068", "-0.1758733", "-2.484223"}},
                                       {1, 8, {"-1.534489", "-0.1759337", "-2.485712"}},
                                       {2, 8, {"-1.53507", "-0.1758742", "-2.484215"}},
                                       {3, 8, {"-1.535072", "-0.1758755", "-2.484219"}},
                                       {4, 8, {"-1.535072", "-0.1758755", "-2.484219"}}}};

constexpr int kPrintedFigures = 6;

/// Displacement of the free end as printed, to 6 significant digits; empty texts where the table has no such row.
std::array<std::string, 3> paper_tip_displacement(int order, int elements_per_member) {
  std::array<std::string, 3> printed;
  for (const Row& row : kRows) {
    if (row.order != order || row.elements_per_member != elements_per_member) continue;
    for (std::size_t i = 0; i < 3; ++i) printed[i] = rounded_to_figures(row.displacement[i], kPrintedFigures);
  }
  return printed;
}

/// One load step and five end in the same state up to what Newton's method leaves over: 1e-11 of the scaled residual,
/// here about 1e-11 of a member's length.
constexpr double kPathTolerance = 1e-10;

const char* const kIterationSource = "requirement: the whole load in one step";

/// Smooth curves in the figures need more samples on long elements.
constexpr int kSamplesPerElement = 17;

int total_elements(const Application& app, int elements_per_member) {
  return elements_per_member * static_cast<int>(app.scene.members.size());
}

double largest_difference(const Vector3& a, const Vector3& b) {
  return std::max({std::abs(a[0] - b[0]), std::abs(a[1] - b[1]), std::abs(a[2] - b[2])});
}

/// One row of the table: solved, checked, and ready to print.
void add_table_row(Application& app, int order, int elements, TablePrinter& table, StudyTable& csv) {
  const int total = total_elements(app, elements);
  const std::string label = "k=" + std::to_string(order) + ", " + std::to_string(total) + " elements";
  const Simulation simulation = app.solve(with_mesh(app.scene, order, elements));
  const Vector3 tip = simulation.displacement(kTip);
  const auto paper = paper_tip_displacement(order, elements);
  std::vector<ComparedValue> cells;
  for (std::size_t i = 0; i < 3; ++i)
    cells.push_back(compared(app, label + ": u" + std::to_string(i + 1), tip[i], paper[i], kSlopeTableSource));
  const int steps = simulation.result().steps, iterations = simulation.result().newton_iterations;
  app.summary.check_upper_bound(label + ": load steps", steps, 1, kIterationSource);
  app.summary.check_upper_bound(label + ": Newton iterations", iterations, app.study().get<int>("Most Iterations"),
                                kIterationSource);
  table.add_row({std::to_string(order), std::to_string(total), std::to_string(steps), std::to_string(iterations)},
                cells);
  csv.add_row({order, total, steps, iterations, tip[0], tip[1], tip[2], paper[0], paper[1], paper[2]});
}

void compare_with_table(Application& app) {
  TablePrinter table("Structure with slope discontinuity: displacement of the free end",
                     {"k", "elements", "steps", "iterations"}, {"u1 / L", "u2 / L", "u3 / L"});
  StudyTable csv(app, "table.csv",
                 {"order", "elements", "steps", "iterations", "u1", "u2", "u3", "paper_u1", "paper_u2", "paper_u3"});
  for (const int elements : study_list<int>(app, "Elements per Member")) {
    table.add_group(std::to_string(elements) + (elements == 1 ? " element" : " elements") + " in each member");
    for (const int order : study_list<int>(app, "Orders")) add_table_row(app, order, elements, table, csv);
  }
  table.print(app.out());
}

/// The largest component of the force at the tip is what the paper calls F.
double full_force(const Scene& scene) {
  double force = 0.0;
  for (const PointLoad& load : scene.point_loads)
    if (load.point == kTip)
      for (const double component : load.force) force = std::max(force, std::abs(component));
  return force;
}

/// Displacement of the tip along the load path, from the unloaded state on.
Vector3 trace_load_displacement(Application& app) {
  StudyTable csv(app, "load_displacement.csv", {"force", "u1", "u2", "u3"});
  const double force = full_force(app.scene);
  const auto add_row = [&](const Simulation& simulation, const StepReport& report) {
    const Vector3 tip = simulation.displacement(kTip);
    csv.add_row({report.load_factor * force, tip[0], tip[1], tip[2]});
  };
  const int steps = app.study().get<int>("Curve Steps");
  return app.solve(app.scene, with_fixed_steps(app.solver, steps), "", add_row).displacement(kTip);
}

/// The scene as it stands, with a shape for each of the paper's loads.
Vector3 record_shapes(Application& app) {
  const int steps = app.study().get<int>("Shape Steps");
  const Simulation simulation =
      app.solve_and_record(app.scene, with_fixed_steps(app.solver, steps), "single", kSamplesPerElement);
  app.check_expected(simulation);
  return simulation.displacement(kTip);
}

void check_path_independence(Application& app, const Vector3& in_shape_steps, const Vector3& in_curve_steps) {
  const Vector3 in_one_step = app.solve(app.scene, with_fixed_steps(app.solver, 1), "").displacement(kTip);
  const auto check = [&](const std::string& steps, const Vector3& tip) {
    const double difference = largest_difference(tip, in_one_step);
    app.summary.check_upper_bound("tip after one load step and after " + steps + " steps, difference", difference,
                                  kPathTolerance, "requirement: the state is a function of the load, not of the path");
    app.out() << "One load step and " << steps << " steps differ by " << difference << " at the tip.\n";
  };
  check(std::to_string(app.study().get<int>("Shape Steps")), in_shape_steps);
  check(std::to_string(app.study().get<int>("Curve Steps")), in_curve_steps);
}

void check_scene(const Application& app) {
  const auto is_tip = [](const Point& point) { return point.name == kTip; };
  if (std::any_of(app.scene.points.begin(), app.scene.points.end(), is_tip)) return;
  throw app.xml.source.error({"Scene", "Points"}, "no point \"" + kTip +
                                                      "\"; the study reports its displacement "
                                                      "(--single takes any scene)");
}

ListSpec slope_study_spec() {
  constexpr int kMostSteps = 10000;
  ListSpec spec("The paper's table, load-displacement curve and shapes; the point \"" + kTip +
                "\" is what they are about.");
  spec.add(counts("Orders", {1, 2, 3, 4}, 8, "Element orders of the table."));
  spec.add(counts("Elements per Member", {1, 8}, 100000, "Meshes of the table."));
  spec.add(count("Most Iterations", 18, kNoLimit, "A row of the table fails if it takes more."));
  spec.add(count("Curve Steps", 50, kMostSteps, "Load steps of the load-displacement curve."));
  spec.add(count("Shape Steps", 5, kMostSteps, "Load steps, and shapes, in single.h5."));
  return spec;
}

/// Table of orders and meshes beside the paper's; shapes under growing load (single.h5); load-displacement curve
/// (load_displacement.csv); the fully loaded state must not depend on the number of load steps.
void run_slope_study(Application& app) {
  check_scene(app);
  compare_with_table(app);
  const Vector3 in_shape_steps = record_shapes(app);
  const Vector3 in_curve_steps = trace_load_displacement(app);
  check_path_independence(app, in_shape_steps, in_curve_steps);
}

}  // namespace

}  // namespace mixbeam

int main(int argc, char** argv) {
  return mixbeam::run_study(argc, argv, "slope_discontinuity",
                            "three straight rods joined at right angles, clamped, under a force at the free end.",
                            mixbeam::slope_study_spec(), mixbeam::run_slope_study);
}
