// Rod bent to helical shape: ten turns under a moment and a force that keep their directions in space.
#include "apps/common/studies/study.hpp"
#include "apps/common/studies/variants.hpp"
#include "apps/common/studies/vertex_places.hpp"
#include "apps/common/tables/formatted.hpp"
#include "apps/common/tables/table_printer.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <ostream>
#include <string>
#include <vector>

namespace mixbeam {

namespace {

/// Tip position with 30 elements of an order, and its distance to 100 elements of order 5.
struct PaperRow {
  int order = 0;
  std::array<std::string, 3> position;  ///< r1(L), r2(L), r3(L)
  std::array<std::string, 3> error;     ///< e1, e2, e3
};

inline const std::string kPaperTable = "Humer, Steinbrecher, Pechstein, table of the rod bent to helical shape";
constexpr int kPaperElements = 30;

inline const std::vector<PaperRow>& paper_rows() {
  static const std::vector<PaperRow> rows = {
      {1, {"6.698e-03", "1.166e-04", "-1.249e-1"}, {"1.9e-03", "4.4e-05", "4.8e-02"}},
      {2, {"4.753e-03", "7.135e-05", "-7.789e-02"}, {"5.0e-05", "1.2e-06", "1.5e-03"}},
      {3, {"4.803e-03", "7.248e-05", "-7.647e-02"}, {"5.6e-07", "2.0e-08", "2.4e-05"}},
      {4, {"4.803e-03", "7.250e-05", "-7.644e-02"}, {"9.8e-09", "2.8e-10", "8.7e-08"}},
  };
  return rows;
}

/// Newton stops at a scaled residual of 1e-11; the state of a given load does not depend on the way there beyond that.
constexpr double kSameState = 1e-10;

constexpr int kMostIterations = 150;
constexpr int kOrderOfGoal = 3;
constexpr int kPointsPerElement = 13;  // of shapes: ten turns on 30 elements
constexpr int kStrainPoints = 9;       // both ends of every element and 7 between, for strains of degree 4

using Tip = Vector3;

std::string tip_of(const Scene& scene) { return scene.members.front().end_point; }

std::string label(int order) { return "k=" + std::to_string(order); }

/// The paper's row for that order; empty texts when it has none.
PaperRow paper_row(int order, int elements) {
  for (const PaperRow& row : paper_rows())
    if (row.order == order && elements == kPaperElements) return row;
  return {};
}

void write_shape(const Application& app, const Simulation& simulation, int order) {
  const MemberSamples rod = simulation.samples(kPointsPerElement).front();
  StudyTable csv(app, ("shape_k" + std::to_string(order) + ".csv"), {"s", "x", "y", "z"});
  for (size_t i = 0; i < rod.size(); ++i)
    csv.add_row({rod.arc_length[i], rod.position[i][0], rod.position[i][1], rod.position[i][2]});
}

void write_strains(const Application& app, const Simulation& simulation, int order) {
  const MemberSamples rod = simulation.samples(kStrainPoints).front();
  StudyTable csv(app, ("strains_k" + std::to_string(order) + ".csv"),
                 {"s", "gamma1", "gamma2", "gamma3", "kappa1", "kappa2", "kappa3"});
  for (size_t i = 0; i < rod.size(); ++i) {
    const Vector3 &gamma = rod.force_strain[i], &kappa = rod.moment_strain[i];
    csv.add_row({rod.arc_length[i], gamma[0], gamma[1], gamma[2], kappa[0], kappa[1], kappa[2]});
  }
}

struct OrderRun {
  Tip tip{};
  int load_steps = 0, iterations = 0;
};

/// The rod with every order; shapes and strains along the way.
std::map<int, OrderRun> run_orders(Application& app) {
  const auto strain_orders = study_list<int>(app, "Strain Orders");
  std::map<int, OrderRun> runs;
  for (int order : study_list<int>(app, "Orders")) {
    const Simulation simulation =
        app.solve(with_mesh(app.scene, order, app.study().get<int>("Elements")), app.solver, "");
    runs[order] = {simulation.position(tip_of(app.scene)), simulation.result().steps,
                   simulation.result().newton_iterations};
    write_shape(app, simulation, order);
    if (std::find(strain_orders.begin(), strain_orders.end(), order) != strain_orders.end())
      write_strains(app, simulation, order);
  }
  return runs;
}

/// Tip positions beside the paper's; every printed digit counts.
void report_positions(Application& app, const std::map<int, OrderRun>& runs) {
  const int elements = app.study().get<int>("Elements");
  TablePrinter table("\nRod bent to helical shape: position of the tip, " + std::to_string(elements) + " elements",
                     {"k", "steps", "iterations"}, {"r1(L)", "r2(L)", "r3(L)"});
  for (const auto& [order, run] : runs) {
    const PaperRow paper = paper_row(order, elements);
    std::vector<ComparedValue> values;
    for (int i = 0; i < 3; ++i)
      values.push_back(compared(app, label(order) + ": r" + std::to_string(i + 1) + "(L)", run.tip[i],
                                paper.position[i], kPaperTable));
    table.add_row({std::to_string(order), std::to_string(run.load_steps), std::to_string(run.iterations)}, values);
  }
  table.print(app.out());
}

/// Errors against an own fine mesh beside the paper's.
void report_errors(Application& app, const std::map<int, OrderRun>& runs, const Tip& reference) {
  const int elements = app.study().get<int>("Elements"), finest = app.study().get<int>("Reference Elements");
  TablePrinter table("\nDistance of the tip to that of " + std::to_string(finest) + " elements of order " +
                         std::to_string(app.study().get<int>("Reference Order")),
                     {"k"}, {"e1", "e2", "e3"});
  for (const auto& [order, run] : runs) {
    const PaperRow paper = paper_row(order, elements);
    std::vector<ComparedValue> values;
    for (int i = 0; i < 3; ++i)
      values.push_back(compared(app, label(order) + ": e" + std::to_string(i + 1), std::abs(run.tip[i] - reference[i]),
                                paper.error[i], kPaperTable));
    table.add_row({std::to_string(order)}, values);
  }
  table.print(app.out());
  app.out() << formatted("reference: r(L) = (%.9e, %.9e, %.9e)\n", reference[0], reference[1], reference[2]);
}

std::vector<VertexPlace> vertex_places(const Simulation& simulation) {
  std::vector<VertexPlace> places;
  for (int vertex = 0; vertex < simulation.model().mesh().vertices(); ++vertex)
    places.push_back(place_of(simulation, vertex));
  return places;
}

/// Largest distance of two positions of a vertex, and largest angle between two of its rotations.
std::array<double, 2> largest_difference(const std::vector<VertexPlace>& a, const std::vector<VertexPlace>& b) {
  std::array<double, 2> largest{};
  for (size_t v = 0; v < a.size(); ++v) {
    largest[0] = std::max(largest[0], length_of(a[v].position - b[v].position));
    largest[1] = std::max(largest[1], angle_of(conjugate(a[v].rotation) * b[v].rotation));
  }
  return largest;
}

/// The tip over the load factor, in steps small enough for a smooth curve.
Simulation record_evolution(Application& app, const Scene& scene, int steps) {
  StudyTable csv(app, "load_displacement.csv", {"load_factor", "r1", "r2", "r3"});
  return app.solve(scene, with_fixed_steps(app.solver, steps), "",
                   [&](const Simulation& simulation, const StepReport& report) {
                     const Tip tip = simulation.position(tip_of(simulation.scene()));
                     csv.add_row({report.load_factor, tip[0], tip[1], tip[2]});
                   });
}

/// The same final state whatever the steps.
void report_path_independence(Application& app) {
  const int order = app.study().get<int>("Evolution Order"), elements = app.study().get<int>("Elements");
  const Scene scene = with_mesh(app.scene, order, elements);
  const Simulation adaptive = app.solve_and_record(scene, app.solver, "single", kPointsPerElement);
  app.check_expected(adaptive);
  if (order == kOrderOfGoal && elements == kPaperElements)
    app.summary.check_upper_bound("k=3, 30 elements: Newton iterations of all steps",
                                  adaptive.result().newton_iterations, kMostIterations,
                                  "goal of mixbeam: at most 150, with load steps chosen by the program");
  const auto reference = vertex_places(adaptive);
  const double length = adaptive.model().mesh().member_length.front();
  app.out() << "\nThe same final state by other load steps (k=" << order << "): largest difference to adaptive steps\n";
  StudyTable table(app, "", {"path", "steps", "iterations", "position / L", "rotation [rad]"}, 5);
  table.add_row({"adaptive", adaptive.result().steps, adaptive.result().newton_iterations, 0.0, 0.0});
  const auto report = [&](const Simulation& simulation) {
    const auto [distance, angle] = largest_difference(reference, vertex_places(simulation));
    table.add_row(
        {"fixed", simulation.result().steps, simulation.result().newton_iterations, distance / length, angle});
    const std::string name =
        "path independence, " + std::to_string(simulation.result().steps) + " steps: farthest vertex, ";
    app.summary.check_upper_bound(name + "distance / L", distance / length, kSameState, "same load, same equilibrium");
    app.summary.check_upper_bound(name + "angle", angle, kSameState, "same load, same equilibrium");
  };
  for (int steps : study_list<int>(app, "Step Counts"))
    report(app.solve(scene, with_fixed_steps(app.solver, steps), ""));
  report(record_evolution(app, scene, app.study().get<int>("Evolution Steps")));
}

ListSpec helical_rod_study_spec() {
  constexpr double kMost = 1e5;
  ListSpec spec("Orders, meshes and load steps of the study; the scene gives load and section.");
  spec.add(counts("Orders", {1, 2, 3, 4}, 8, "Element orders k of the table."));
  spec.add(counts("Strain Orders", {1, 4}, 8, "Those whose strains are written along the axis."));
  spec.add(count("Elements", 30, kMost, "Number of elements of the table."));
  spec.add(count("Reference Order", 5, 8, "Order of the fine mesh that errors refer to."));
  spec.add(count("Reference Elements", 100, kMost, "Elements of that mesh."));
  spec.add(count("Evolution Order", 3, 8, "Order for the load-displacement curve and the test of path independence."));
  spec.add(count("Evolution Steps", 400, kMost, "Equal load steps of the load-displacement curve."));
  spec.add(counts("Step Counts", {10, 20, 37}, kMost,
                  "Numbers of equal load steps that must end at the state of the adaptive steps."));
  return spec;
}

/// Prints and checks the paper's table; writes load_displacement.csv, strains_k*.csv, shape_k*.csv,
/// path_independence.csv.
void run_helical_rod_study(Application& app) {
  const auto runs = run_orders(app);
  const Simulation fine = app.solve(
      with_mesh(app.scene, app.study().get<int>("Reference Order"), app.study().get<int>("Reference Elements")),
      app.solver, "");
  report_positions(app, runs);
  report_errors(app, runs, fine.position(tip_of(app.scene)));
  report_path_independence(app);
}

}  // namespace

}  // namespace mixbeam

int main(int argc, char** argv) {
  return mixbeam::run_study(
      argc, argv, "helical_rod",
      "straight rod that a dead moment and a dead force at its tip wind to ten turns (rod bent to helical shape).",
      mixbeam::helical_rod_study_spec(), mixbeam::run_helical_rod_study);
}
