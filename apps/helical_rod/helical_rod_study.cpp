// Rod bent to helical shape: ten turns under a dead moment and a dead force.
#include "apps/common/studies/study.hpp"
#include "apps/common/studies/variants.hpp"
#include "apps/common/studies/vertex_places.hpp"
#include "apps/common/tables/formatted.hpp"

#include <algorithm>
#include <map>

namespace mixbeam {

namespace {

const std::string kPaperTable = "Humer, Steinbrecher, Pechstein, table of the rod bent to helical shape";
/// Tip position with 30 elements of an order, and its distance to 100 elements of order 5.
const PaperTable kPositions = {kPaperTable,
                               {{1, 30, {"6.698e-03", "1.166e-04", "-1.249e-1"}},
                                {2, 30, {"4.753e-03", "7.135e-05", "-7.789e-02"}},
                                {3, 30, {"4.803e-03", "7.248e-05", "-7.647e-02"}},
                                {4, 30, {"4.803e-03", "7.250e-05", "-7.644e-02"}}}};
const PaperTable kErrors = {kPaperTable,
                            {{1, 30, {"1.9e-03", "4.4e-05", "4.8e-02"}},
                             {2, 30, {"5.0e-05", "1.2e-06", "1.5e-03"}},
                             {3, 30, {"5.6e-07", "2.0e-08", "2.4e-05"}},
                             {4, 30, {"9.8e-09", "2.8e-10", "8.7e-08"}}}};

/// Newton's method ends at a scaled residual of 1e-11; the state does not depend on the path beyond that.
constexpr double kSameState = 1e-10;

constexpr int kMostIterations = 150, kOrderOfGoal = 3, kElementsOfGoal = 30;
constexpr int kPointsPerElement = 13;  // for shapes: ten turns on 30 elements
constexpr int kStrainPoints = 9;       // both ends of each element and 7 between, for strains of degree 4

Vector3 tip_of(const Simulation& simulation) {
  return simulation.position(simulation.scene().members.front().end_point);
}

/// Writes samples of these fields along the rod: s, and three columns per field.
void write_samples(const Application& app, const Simulation& simulation, const std::string& file, int points,
                   const std::string& columns, const std::vector<std::vector<Vector3> MemberSamples::*>& fields) {
  const MemberSamples rod = simulation.samples(points).front();
  StudyTable csv(app, file + std::to_string(simulation.scene().members.front().order) + ".csv", words(columns));
  for (size_t i = 0; i < rod.size(); ++i) {
    std::vector<CsvCell> row = {rod.arc_length[i]};
    for (const auto field : fields) row.insert(row.end(), (rod.*field)[i].begin(), (rod.*field)[i].end());
    csv.add_row(row);
  }
}

struct OrderRun {
  Vector3 tip{};
  int load_steps = 0, iterations = 0;
};

/// Solves the rod with every order; writes shapes and strains.
std::map<int, OrderRun> run_orders(Application& app) {
  const auto strain_orders = study_list<int>(app, "Strain Orders");
  std::map<int, OrderRun> runs;
  for (int order : study_list<int>(app, "Orders")) {
    const Simulation simulation = app.solve(with_mesh(app.scene, order, study_number(app, "Elements")));
    runs[order] = {tip_of(simulation), simulation.result().steps, simulation.result().newton_iterations};
    write_samples(app, simulation, "shape_k", kPointsPerElement, "s,x,y,z", {&MemberSamples::position});
    if (std::find(strain_orders.begin(), strain_orders.end(), order) != strain_orders.end())
      write_samples(app, simulation, "strains_k", kStrainPoints, "s,gamma1,gamma2,gamma3,kappa1,kappa2,kappa3",
                    {&MemberSamples::force_strain, &MemberSamples::moment_strain});
  }
  return runs;
}

/// Compares tip positions with the paper's, in all printed digits; then errors relative to a fine mesh.
void report_tips(Application& app, const std::map<int, OrderRun>& runs, const Vector3& reference) {
  const int elements = study_number(app, "Elements");
  TablePrinter positions("\nRod bent to helical shape: position of the tip, " + std::to_string(elements) + " elements",
                         {"k", "steps", "iterations"}, {"r1(L)", "r2(L)", "r3(L)"});
  TablePrinter errors("\nDistance of the tip to that of " + std::to_string(study_number(app, "Reference Elements")) +
                          " elements of order " + std::to_string(study_number(app, "Reference Order")),
                      {"k"}, {"e1", "e2", "e3"});
  for (const auto& [order, run] : runs)
    positions.add_row({std::to_string(order), std::to_string(run.load_steps), std::to_string(run.iterations)},
                      compared(app, "k=" + std::to_string(order) + ": r", "(L)", run.tip,
                               kPositions.row(order, elements), kPaperTable));
  positions.print(app.out());
  for (const auto& [order, run] : runs) {
    Vector3 error{};
    for (size_t i = 0; i < error.size(); ++i) error[i] = std::abs(run.tip[i] - reference[i]);
    errors.add_row({std::to_string(order)}, compared(app, "k=" + std::to_string(order) + ": e", "", error,
                                                     kErrors.row(order, elements), kPaperTable));
  }
  errors.print(app.out());
  app.out() << formatted("reference: r(L) = (%.9e, %.9e, %.9e)\n", reference[0], reference[1], reference[2]);
}

/// Checks that the final state does not depend on the load steps; the last run has enough steps for a smooth curve of
/// the tip.
void report_path_independence(Application& app) {
  const int order = study_number(app, "Evolution Order"), elements = study_number(app, "Elements");
  const Scene scene = with_mesh(app.scene, order, elements);
  const Simulation adaptive = app.solve_and_record(scene, app.solver, "single", kPointsPerElement);
  app.check_expected(adaptive);
  if (order == kOrderOfGoal && elements == kElementsOfGoal)
    app.summary.check_upper_bound("k=3, 30 elements: Newton iterations of all steps",
                                  adaptive.result().newton_iterations, kMostIterations,
                                  "goal of mixbeam: at most 150, with load steps chosen by the program");
  const auto reference = vertex_places(adaptive);
  const double length = adaptive.model().mesh().member_length.front();
  app.out() << "\nThe same final state by other load steps (k=" << order << "): largest difference to adaptive steps\n";
  StudyTable table(app, "", {"path", "steps", "iterations", "position / L", "rotation [rad]"}, 5);
  table.add_row({"adaptive", adaptive.result().steps, adaptive.result().newton_iterations, 0.0, 0.0});
  const auto report = [&](const Simulation& simulation) {
    double distance = 0.0, angle = 0.0;  // largest over the vertices
    const auto places = vertex_places(simulation);
    for (size_t v = 0; v < places.size(); ++v) {
      distance = std::max(distance, length_of(reference[v].position - places[v].position));
      angle = std::max(angle, angle_of(conjugate(reference[v].rotation) * places[v].rotation));
    }
    const LoadPathResult& result = simulation.result();
    table.add_row({"fixed", result.steps, result.newton_iterations, distance / length, angle});
    const std::string name = "path independence, " + std::to_string(result.steps) + " steps: farthest vertex, ";
    app.summary.check_upper_bound(name + "distance / L", distance / length, kSameState, "same load, same equilibrium");
    app.summary.check_upper_bound(name + "angle", angle, kSameState, "same load, same equilibrium");
  };
  for (int steps : study_list<int>(app, "Step Counts")) report(solve_in_steps(app, scene, steps));
  StudyTable csv(app, "load_displacement.csv", {"load_factor", "r1", "r2", "r3"});
  report(solve_in_steps(app, scene, study_number(app, "Evolution Steps"),
                        [&](const Simulation& simulation, const StepReport& step) {
                          const Vector3 tip = tip_of(simulation);
                          csv.add_row({step.load_factor, tip[0], tip[1], tip[2]});
                        }));
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

/// Prints and checks the paper's table; writes load_displacement.csv, strains_k*.csv, shape_k*.csv.
void run_helical_rod_study(Application& app) {
  const auto runs = run_orders(app);
  const Simulation fine =
      app.solve(with_mesh(app.scene, study_number(app, "Reference Order"), study_number(app, "Reference Elements")));
  report_tips(app, runs, tip_of(fine));
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
