// Superimposed rotation of a deformed cantilever: strains and energy of a bent rod must not notice ten turns of its
// clamp.
#include "apps/common/studies/study.hpp"
#include "apps/common/studies/variants.hpp"
#include "apps/superimposed_rotation/turned_rod.hpp"

#include <cmath>
#include <cstdio>
#include <ostream>

namespace mixbeam {

namespace {

const std::string kPaper =
    "Humer, Steinbrecher, Pechstein, section \"Superimposed rotation of deformed cantilever\": preserved up to double "
    "precision";

/// Round-off of some hundred operations on numbers of size one.
constexpr double kPreserved = 1e-12;

/// The same for configurations turned back by up to 63 radians, whose sine and cosine carry the rounding of that angle.
constexpr double kSameConfiguration = 1e-11;

/// Quantity of the list "Expected": energy of the moment strains at the end of the run.
constexpr const char* kMomentEnergy = "moment energy";

constexpr int kPointsPerElement = 9;

std::string tip_of(const Scene& scene) { return scene.members.front().end_point; }

void check(Summary& summary, const std::string& name, const TurnedRod& rod) {
  const Deviation largest = rod.largest();
  summary.check_upper_bound(name + ": change of u3(L) / L, largest of all increments", largest.relative_u3, kPreserved,
                            kPaper);
  summary.check_upper_bound(name + ": relative change of the moment energy, largest of all increments",
                            largest.relative_energy, kPreserved, kPaper);
  summary.check_upper_bound(name + ": farthest vertex after turning back / L, largest of all increments",
                            largest.position, kSameConfiguration, kPaper);
  summary.check_upper_bound(name + ": triad of a vertex after turning back, largest of all increments", largest.triad,
                            kSameConfiguration, kPaper);
}

/// Change since the bent state, turned back, at every increment.
void write_deviations(const Application& app, const TurnedRod& rod) {
  StudyTable csv(app, "deviation.csv",
                 {"rotation", "relative_u3", "relative_energy", "vertex_position", "vertex_triad", "iterations"}, 6);
  for (const Deviation& d : rod.deviations())
    csv.add_row({d.rotation, d.relative_u3, d.relative_energy, d.position, d.triad, d.iterations});
}

ListSpec rotation_study_spec() {
  ListSpec spec("Element orders to compare.");
  spec.add(array("Orders", ParameterType::integer_array)
               .at_least(1)
               .at_most(8)
               .by_default(Teuchos::tuple(1, 2, 3, 4))
               .means("Element orders k, each on the mesh of the scene."));
  return spec;
}

/// The scene as it stands: prints and checks the deviations at every increment, writes deviation.csv and single.h5.
void run_rotation(Application& app) {
  TurnedRod rod(app.scene, tip_of(app.scene));
  const Simulation simulation = app.solve_and_record(
      app.scene, app.solver, "single", kPointsPerElement,
      [&rod](const Simulation& running, const StepReport& report) { rod.observe(running, report); });
  app.check_expected(simulation, [&simulation](const ExpectedValue&) { return simulation.strain_energy().moment; });
  write_deviations(app, rod);
  check(app.summary, "scene", rod);
}

/// That, and the other element orders.
void run_rotation_study(Application& app) {
  app.quiet = true;  // the table of increments says it all
  run_rotation(app);
  char line[200];
  app.out() << "\nLargest change of all increments, by order\n"
            << "   k    u3(L) / L   moment energy   vertices / L   triads [rad]   iterations of an increment\n";
  for (int order : study_list<int>(app, "Orders")) {
    const Scene scene = with_mesh(app.scene, order, app.scene.members.front().elements);
    TurnedRod rod(scene, tip_of(scene));
    app.solve(scene, app.solver, "",
              [&rod](const Simulation& running, const StepReport& report) { rod.observe(running, report); });
    const Deviation largest = rod.largest();
    std::snprintf(line, sizeof line, "%4d %12.1e %15.1e %14.1e %14.1e %28d\n", order, largest.relative_u3,
                  largest.relative_energy, largest.position, largest.triad, largest.iterations);
    app.out() << line;
    check(app.summary, "k=" + std::to_string(order), rod);
  }
}

}  // namespace

}  // namespace mixbeam

int main(int argc, char** argv) {
  mixbeam::ApplicationDefinition definition;
  definition.name = "superimposed_rotation";
  definition.purpose = "cantilever bent by a moment, then turned with its clamp (objectivity).";
  definition.study = mixbeam::rotation_study_spec();
  definition.own_quantities = {mixbeam::kMomentEnergy};
  definition.single = mixbeam::run_rotation;
  definition.run_study = mixbeam::run_rotation_study;
  return mixbeam::run_application(argc, argv, definition);
}
