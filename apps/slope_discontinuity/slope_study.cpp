// Three rods joined at right angles: table, load-displacement curve and shapes of the paper's example.
#include "apps/common/studies/study.hpp"
#include "apps/common/studies/variants.hpp"
#include "kernels/math/vector_algebra.hpp"

#include <algorithm>

namespace mixbeam {

namespace {

const std::string kTip = "tip";

/// Tip displacement by order and elements per member: digits of the manuscript, some more than in its table.
const PaperTable kPaper = {"Humer, Steinbrecher, Pechstein, table \"Structure with slope discontinuity\"",
                           {{1, 1, {"-1.519637", "-0.1870366", "-2.607832"}},
                            {2, 1, {"-1.528034", "-0.1713543", "-2.470063"}},
                            {3, 1, {"-1.535102", "-0.175832", "-2.484094"}},
                            {4, 1, {"-1.535068", "-0.1758733", "-2.484223"}},
                            {1, 8, {"-1.534489", "-0.1759337", "-2.485712"}},
                            {2, 8, {"-1.53507", "-0.1758742", "-2.484215"}},
                            {3, 8, {"-1.535072", "-0.1758755", "-2.484219"}},
                            {4, 8, {"-1.535072", "-0.1758755", "-2.484219"}}},
                           6};

/// Difference of the end states of one and five load steps: Newton's method ends at a scaled residual of 1e-11, here
/// about 1e-11 of a member's length.
constexpr double kPathTolerance = 1e-10;

/// Smooth curves in the figures need more samples on long elements.
constexpr int kSamplesPerElement = 17;

/// Solves and checks one row of the table.
void add_table_row(Application& app, int order, int elements, TablePrinter& table, StudyTable& csv) {
  const std::string requirement = "requirement: the whole load in one step";
  const int total = elements * static_cast<int>(app.scene.members.size());
  const std::string label = "k=" + std::to_string(order) + ", " + std::to_string(total) + " elements";
  const Simulation simulation = app.solve(with_mesh(app.scene, order, elements));
  const Vector3 tip = simulation.displacement(kTip);
  const auto paper = kPaper.row(order, elements);
  const auto cells = compared(app, label + ": u", "", tip, paper, kPaper.source);
  const int steps = simulation.result().steps, iterations = simulation.result().newton_iterations;
  app.summary.check_upper_bound(label + ": load steps", steps, 1, requirement);
  app.summary.check_upper_bound(label + ": Newton iterations", iterations, study_number(app, "Most Iterations"),
                                requirement);
  table.add_row({std::to_string(order), std::to_string(total), std::to_string(steps), std::to_string(iterations)},
                cells);
  csv.add_row({order, total, steps, iterations, tip[0], tip[1], tip[2], paper[0], paper[1], paper[2]});
}

void compare_with_table(Application& app) {
  TablePrinter table("Structure with slope discontinuity: displacement of the free end",
                     {"k", "elements", "steps", "iterations"}, {"u1 / L", "u2 / L", "u3 / L"});
  StudyTable csv(app, "table.csv", words("order,elements,steps,iterations,u1,u2,u3,paper_u1,paper_u2,paper_u3"));
  for (const int elements : study_list<int>(app, "Elements per Member")) {
    table.add_group(std::to_string(elements) + (elements == 1 ? " element" : " elements") + " in each member");
    for (const int order : study_list<int>(app, "Orders")) add_table_row(app, order, elements, table, csv);
  }
  table.print(app.out());
}

/// Writes the displacement of the tip along the load path. The paper's F is the largest component of the force at the
/// tip.
Vector3 trace_load_displacement(Application& app, int steps) {
  StudyTable csv(app, "load_displacement.csv", {"force", "u1", "u2", "u3"});
  double force = 0.0;
  for (const PointLoad& load : app.scene.point_loads)
    if (load.point == kTip) force = std::max(force, vector_algebra::largest_component(load.force));
  const auto add_row = [&](const Simulation& simulation, const StepReport& report) {
    const Vector3 tip = simulation.displacement(kTip);
    csv.add_row({report.load_factor * force, tip[0], tip[1], tip[2]});
  };
  return solve_in_steps(app, app.scene, steps, add_row).displacement(kTip);
}

/// Compares orders and meshes with the paper's table; records the scene as it stands with a shape for each of the
/// paper's loads (single.h5); writes the load-displacement curve (load_displacement.csv); checks that the fully loaded
/// state does not depend on the number of load steps.
void run_slope_study(Application& app) {
  require_point(app, kTip);
  compare_with_table(app);
  const int shapes = study_number(app, "Shape Steps"), steps = study_number(app, "Curve Steps");
  const Simulation simulation =
      app.solve_and_record(app.scene, with_fixed_steps(app.solver, shapes), "single", kSamplesPerElement);
  app.check_expected(simulation);
  const Vector3 in_curve_steps = trace_load_displacement(app, steps);
  const Vector3 in_one_step = solve_in_steps(app, app.scene, 1).displacement(kTip);
  for (const auto& [count, tip] : {std::pair{shapes, simulation.displacement(kTip)}, {steps, in_curve_steps}}) {
    const double difference = vector_algebra::largest_component(vector_algebra::difference(tip, in_one_step));
    app.summary.check_upper_bound("tip after one load step and after " + std::to_string(count) + " steps, difference",
                                  difference, kPathTolerance,
                                  "requirement: the state is a function of the load, not of the path");
    app.out() << "One load step and " << count << " steps differ by " << difference << " at the tip.\n";
  }
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

}  // namespace

}  // namespace mixbeam

int main(int argc, char** argv) {
  return mixbeam::run_study(argc, argv, "slope_discontinuity",
                            "three straight rods joined at right angles, clamped, under a force at the free end.",
                            mixbeam::slope_study_spec(), mixbeam::run_slope_study);
}
