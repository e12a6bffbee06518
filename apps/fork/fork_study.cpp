// Fork under a force couple: table, representations of its semicircle, and independence of the order of loading.
#include "apps/fork/fork_study.hpp"

#include <algorithm>

namespace mixbeam {

namespace {

constexpr int kMostElements = 100000;
constexpr int kMostSteps = 10000;

/// Smooth curves in the figures need more samples on long elements.
constexpr int kSamplesPerElement = 17;

ParameterSpec integers_spec(const std::string& name, const std::vector<int>& by_default, int at_most) {
  return array(name, ParameterType::integer_array)
      .at_least(1)
      .at_most(at_most)
      .by_default(Teuchos::Array<int>(by_default));
}

void check_scene(const Application& app) {
  for (const std::string name : {"P1", "P2", "PB"}) {
    const auto is_it = [&name](const Point& point) { return point.name == name; };
    if (std::any_of(app.scene.points.begin(), app.scene.points.end(), is_it)) continue;
    throw app.xml.source.error(
        {"Scene", "Points"},
        "no point \"" + name + "\"; the study reports its displacement (--single takes any scene)");
  }
  if (app.scene.stages == 2) return;
  throw app.xml.source.error({"Scene", "Point Loads"}, std::to_string(app.scene.stages) +
                                                           " stages of loading; the study needs 2, one for each force "
                                                           "(--single takes any scene)");
}

/// The scene as it stands, with its expected answers in both configurations.
void record_shapes(Application& app) {
  app.solve_and_record(app.scene, app.solver, "single", kSamplesPerElement,
                       [&app](const Simulation& simulation, const StepReport& report) {
                         app.check_expected(simulation, report.load_factor);
                       });
}

ListSpec fork_study_spec() {
  ListSpec spec(
      "The paper's table and load-displacement curves, and convergence for two representations of the semicircle.");
  spec.add(integers_spec("Orders", {1, 2, 3, 4}, 8).means("Element orders of the table."));
  spec.add(integers_spec("Elements per Member", {3, 10}, kMostElements).means("Meshes of the table."));
  spec.add(integer("Most Iterations")
               .at_least(1)
               .by_default(24)
               .means("Newton iterations of both stages; a row of the table fails if it takes more."));
  spec.add(integer("Curve Steps")
               .at_least(1)
               .at_most(kMostSteps)
               .by_default(10)
               .means("Load steps of the load-displacement curves, for each stage."));
  spec.add(integers_spec("Convergence Orders", {1, 2, 3, 4}, 8).means("Element orders of the convergence study."));
  spec.add(integers_spec("Convergence Elements per Member", {3, 6, 12, 24}, kMostElements)
               .means("Meshes of the convergence study, from coarse to fine."));
  spec.add(integer("Reference Order").at_least(1).at_most(8).by_default(6).means("Order of its reference solution."));
  spec.add(integer("Reference Elements per Member")
               .at_least(1)
               .at_most(kMostElements)
               .by_default(24)
               .means("Mesh of its reference solution."));
  return spec;
}

}  // namespace

ForkSolution solve_fork(Application& app, const Scene& scene) {
  ForkSolution solution;
  const Simulation simulation =
      app.solve(scene, app.solver, "", [&solution](const Simulation& running, const StepReport& report) {
        if (report.load_factor <= 1.0) solution.p1[0] = running.displacement("P1");
      });
  solution.p1[1] = simulation.displacement("P1");
  solution.steps = simulation.result().steps;
  solution.iterations = simulation.result().newton_iterations;
  return solution;
}

namespace {

/// All of these, and the scene as it stands in single.h5.
void run_fork_study(Application& app) {
  check_scene(app);
  compare_with_table(app);
  compare_representations(app);
  compare_load_orders(app);
  record_shapes(app);
}

}  // namespace

}  // namespace mixbeam

int main(int argc, char** argv) {
  mixbeam::ApplicationDefinition definition;
  definition.name = "fork";
  definition.purpose = "a shaft that branches into a semicircle, whose tips are pulled apart one after the other.";
  definition.study = mixbeam::fork_study_spec();
  definition.run_study = mixbeam::run_fork_study;
  return mixbeam::run_application(argc, argv, definition);
}
