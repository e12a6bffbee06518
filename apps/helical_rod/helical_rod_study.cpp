// Rod bent to helical shape: ten turns under a moment and a force that keep their directions in space.
#include "apps/common/studies/study.hpp"
#include "apps/common/studies/variants.hpp"
#include "apps/common/tables/table_printer.hpp"
#include "apps/helical_rod/paper_table.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <ostream>

namespace mixbeam {

namespace {

/// Newton stops at a scaled residual of 1e-11; the state of a given load does not depend on the way there beyond that.
constexpr double kSameState = 1e-10;

constexpr int kMostIterations = 150;
constexpr int kOrderOfGoal = 3;
constexpr int kPointsPerElement = 13;  // of shapes: ten turns on 30 elements
constexpr int kStrainPoints = 9;       // both ends of every element and 7 between, for strains of degree 4

using Tip = Vector3;

struct Settings {
  std::vector<int> orders, strain_orders, step_counts;
  int elements = 0, reference_order = 0, reference_elements = 0, evolution_order = 0, evolution_steps = 0;
};

Settings read_settings(Application& app) {
  const Teuchos::ParameterList& study = app.study();
  const auto list = [&study](const char* name) { return study.get<Teuchos::Array<int>>(name).toVector(); };
  return {list("Orders"),
          list("Strain Orders"),
          list("Step Counts"),
          study.get<int>("Elements"),
          study.get<int>("Reference Order"),
          study.get<int>("Reference Elements"),
          study.get<int>("Evolution Order"),
          study.get<int>("Evolution Steps")};
}

std::string tip_of(const Scene& scene) { return scene.members.front().end_point; }

std::string label(int order) { return "k=" + std::to_string(order); }

/// The paper's row for that order; null when it has none.
const PaperRow* paper_row(int order, int elements) {
  for (const PaperRow& row : paper_rows())
    if (row.order == order && elements == kPaperElements) return &row;
  return nullptr;
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
std::map<int, OrderRun> run_orders(Application& app, const Settings& settings) {
  std::map<int, OrderRun> runs;
  for (int order : settings.orders) {
    const Simulation simulation = app.solve(with_mesh(app.scene, order, settings.elements), app.solver, "");
    runs[order] = {simulation.position(tip_of(app.scene)), simulation.result().steps,
                   simulation.result().newton_iterations};
    write_shape(app, simulation, order);
    if (std::find(settings.strain_orders.begin(), settings.strain_orders.end(), order) != settings.strain_orders.end())
      write_strains(app, simulation, order);
  }
  return runs;
}

/// Tip positions beside the paper's; every printed digit counts.
void report_positions(Application& app, const Settings& settings, const std::map<int, OrderRun>& runs) {
  TablePrinter table(
      "\nRod bent to helical shape: position of the tip, " + std::to_string(settings.elements) + " elements",
      {"k", "steps", "iterations"}, {"r1(L)", "r2(L)", "r3(L)"});
  for (const auto& [order, run] : runs) {
    const PaperRow* paper = paper_row(order, settings.elements);
    std::vector<ComparedValue> values;
    for (int i = 0; i < 3; ++i) {
      if (paper == nullptr) {
        values.push_back({"", run.tip[i], Agreement::informative});
        continue;
      }
      values.push_back(compare_printed(paper->position[i], run.tip[i]));
      app.summary.check_printed_digits(label(order) + ": r" + std::to_string(i + 1) + "(L)", run.tip[i],
                                       paper->position[i], kPaperTable);
    }
    table.add_row({std::to_string(order), std::to_string(run.load_steps), std::to_string(run.iterations)}, values);
  }
  table.print(app.out());
}

/// Errors against an own fine mesh beside the paper's.
void report_errors(Application& app, const Settings& settings, const std::map<int, OrderRun>& runs,
                   const Tip& reference) {
  TablePrinter table("\nDistance of the tip to that of " + std::to_string(settings.reference_elements) +
                         " elements of order " + std::to_string(settings.reference_order),
                     {"k"}, {"e1", "e2", "e3"});
  for (const auto& [order, run] : runs) {
    const PaperRow* paper = paper_row(order, settings.elements);
    std::vector<ComparedValue> values;
    for (int i = 0; i < 3; ++i) {
      const double error = std::abs(run.tip[i] - reference[i]);
      if (paper == nullptr) {
        values.push_back({"", error, Agreement::informative});
        continue;
      }
      values.push_back(compare_printed(paper->error[i], error));
      app.summary.check_printed_digits(label(order) + ": e" + std::to_string(i + 1), error, paper->error[i],
                                       kPaperTable);
    }
    table.add_row({std::to_string(order)}, values);
  }
  table.print(app.out());
  char line[120];
  std::snprintf(line, sizeof line, "reference: r(L) = (%.9e, %.9e, %.9e)\n", reference[0], reference[1], reference[2]);
  app.out() << line;
}

/// Position and rotation vector of every vertex.
std::vector<std::array<double, 6>> vertex_motions(const Simulation& simulation) {
  std::vector<std::array<double, 6>> motions;
  for (int vertex = 0; vertex < simulation.model().mesh().vertices(); ++vertex)
    motions.push_back(vertex_motion(simulation.model(), simulation.state(), vertex));
  return motions;
}

/// Largest distance of two positions of a vertex, and largest angle between two of its rotations.
std::array<double, 2> largest_difference(const std::vector<std::array<double, 6>>& a,
                                         const std::vector<std::array<double, 6>>& b) {
  std::array<double, 2> largest{};
  const auto rotation = [](const std::array<double, 6>& m) { return exp_quaternion(Vec3<double>{{m[3], m[4], m[5]}}); };
  for (size_t v = 0; v < a.size(); ++v) {
    const Vec3<double> turn = log_quaternion(conjugate(rotation(a[v])) * rotation(b[v]));
    largest[0] = std::max(largest[0], std::hypot(a[v][0] - b[v][0], a[v][1] - b[v][1], a[v][2] - b[v][2]));
    largest[1] = std::max(largest[1], std::hypot(turn[0], turn[1], turn[2]));
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
void report_path_independence(Application& app, const Settings& settings) {
  const Scene scene = with_mesh(app.scene, settings.evolution_order, settings.elements);
  const Simulation adaptive = app.solve_and_record(scene, app.solver, "single", kPointsPerElement);
  app.check_expected(adaptive);
  if (settings.evolution_order == kOrderOfGoal && settings.elements == kPaperElements)
    app.summary.check_upper_bound("k=3, 30 elements: Newton iterations of all steps",
                                  adaptive.result().newton_iterations, kMostIterations,
                                  "goal of mixbeam: at most 150, with load steps chosen by the program");
  const auto reference = vertex_motions(adaptive);
  const double length = adaptive.model().mesh().members.front().curve.length;
  char line[200];
  app.out() << "\nThe same final state by other load steps (k=" << settings.evolution_order
            << "): largest difference to adaptive steps\n"
            << "        path   steps   iterations   position / L   rotation [rad]\n";
  std::snprintf(line, sizeof line, "    adaptive %7d %12d\n", adaptive.result().steps,
                adaptive.result().newton_iterations);
  app.out() << line;
  const auto report = [&](const Simulation& simulation) {
    const auto [distance, angle] = largest_difference(reference, vertex_motions(simulation));
    std::snprintf(line, sizeof line, "       fixed %7d %12d %14.1e %16.1e\n", simulation.result().steps,
                  simulation.result().newton_iterations, distance / length, angle);
    app.out() << line;
    const std::string name =
        "path independence, " + std::to_string(simulation.result().steps) + " steps: farthest vertex, ";
    app.summary.check_upper_bound(name + "distance / L", distance / length, kSameState, "same load, same equilibrium");
    app.summary.check_upper_bound(name + "angle", angle, kSameState, "same load, same equilibrium");
  };
  for (int steps : settings.step_counts) report(app.solve(scene, with_fixed_steps(app.solver, steps), ""));
  report(record_evolution(app, scene, settings.evolution_steps));
}

ListSpec helical_rod_study_spec() {
  const auto orders = [](const char* name, const Teuchos::Array<int>& by_default, const char* meaning) {
    return array(name, ParameterType::integer_array).at_least(1).at_most(8).by_default(by_default).means(meaning);
  };
  constexpr double kMost = 1e5;
  ListSpec spec("Orders, meshes and load steps of the study; the scene gives load and section.");
  spec.add(orders("Orders", Teuchos::tuple(1, 2, 3, 4), "Element orders k of the table."));
  spec.add(orders("Strain Orders", Teuchos::tuple(1, 4), "Those whose strains are written along the axis."));
  spec.add(integer("Elements").at_least(1).at_most(kMost).by_default(30).means("Number of elements of the table."));
  spec.add(integer("Reference Order")
               .at_least(1)
               .at_most(8)
               .by_default(5)
               .means("Order of the fine mesh that errors refer to."));
  spec.add(integer("Reference Elements").at_least(1).at_most(kMost).by_default(100).means("Elements of that mesh."));
  spec.add(integer("Evolution Order")
               .at_least(1)
               .at_most(8)
               .by_default(3)
               .means("Order for the load-displacement curve and the test of path independence."));
  spec.add(integer("Evolution Steps")
               .at_least(1)
               .at_most(kMost)
               .by_default(400)
               .means("Equal load steps of the load-displacement curve."));
  spec.add(array("Step Counts", ParameterType::integer_array)
               .at_least(1)
               .at_most(kMost)
               .by_default(Teuchos::tuple(10, 20, 37))
               .means("Numbers of equal load steps that must end at the state of the adaptive steps."));
  return spec;
}

/// Prints and checks the paper's table; writes load_displacement.csv, strains_k*.csv, shape_k*.csv,
/// path_independence.csv.
void run_helical_rod_study(Application& app) {
  const Settings settings = read_settings(app);
  const auto runs = run_orders(app, settings);
  const Simulation fine =
      app.solve(with_mesh(app.scene, settings.reference_order, settings.reference_elements), app.solver, "");
  report_positions(app, settings, runs);
  report_errors(app, settings, runs, fine.position(tip_of(app.scene)));
  report_path_independence(app, settings);
}

}  // namespace

}  // namespace mixbeam

int main(int argc, char** argv) {
  mixbeam::ApplicationDefinition definition;
  definition.name = "helical_rod";
  definition.purpose =
      "straight rod that a dead moment and a dead force at its tip wind to ten turns (rod bent to helical shape).";
  definition.study = mixbeam::helical_rod_study_spec();
  definition.run_study = mixbeam::run_helical_rod_study;
  return mixbeam::run_application(argc, argv, definition);
}
