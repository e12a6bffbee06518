// The paper's first example: a rod bent to a double circle by a moment at its tip.
#include "apps/common/studies/study.hpp"
#include "apps/common/studies/variants.hpp"
#include "apps/common/tables/convergence_table.hpp"
#include "apps/common/tables/formatted.hpp"
#include "apps/common/tables/table_printer.hpp"
#include "apps/rollup/bent_rod.hpp"

#include <algorithm>
#include <ostream>

namespace mixbeam {

namespace {

const std::string kPaper = "Humer, Steinbrecher, Pechstein, section \"Rod bent to circle\"";
const std::string kClosedForm = "closed form: constant curvature M/EI, no force strains";
const std::string kGoal = "goal of mixbeam: pure bending in 3 iterations of one load step, at any slenderness";

/// Exact but for the roundings of some hundred operations; positions divided by L, rotations in radians.
constexpr double kExact = 1e-12;
constexpr int kGoalIterations = 3;

/// The figures go down to round-off: what Newton leaves with the default of 1e-11 would be seen on fine meshes.
constexpr double kResidualTolerance = 1e-13;
/// Round-off of stiffer rods alone is more than that: strains of 1e-16 times a stiffness far above that of bending.
constexpr double kStiff = 1e2, kResidualToleranceOfStiff = 3e-12;
constexpr double kRoundOff = 1e-12;  // of the centerline's error at slenderness 1000: what Newton's tolerance lets pass
constexpr double kRateTolerance = 0.15;

/// An element locks when its error is this many times the one that both reduced integrations give. At slenderness 1000
/// and 16 elements the ratios are below 1.1 or above 100, so that any number between separates them.
constexpr double kLocked = 10.0;
constexpr int kLockingElements = 16;
constexpr double kLockingSlenderness = 1000.0;

constexpr int kSmoothSamples = 33;  // of each element in single.h5, where an element is a quarter of a circle

constexpr int kPrototypeElements = 32;
const std::vector<const char*> kPrototypeErrors = {"8.59e-04", "2.77e-05", "6.28e-07",
                                                   "1.19e-08", "1.90e-10", "2.63e-12"};

struct NamedIntegration {
  ForceIntegration integration;
  const char* name;
  std::vector<int> locking_orders;  ///< that the paper's figures show at slenderness 1000, of k = 1..4
};

const std::vector<NamedIntegration> kSelective = {{ForceIntegration::full, "full", {2, 3, 4}},
                                                  {ForceIntegration::axial_reduced, "axial reduced", {3}},
                                                  {ForceIntegration::shear_reduced, "shear reduced", {2, 4}}};
const NamedIntegration kBothReduced = {ForceIntegration::both_reduced, "both reduced", {}};

/// One row of convergence.csv.
struct RollupRun {
  BentRod rod;
  int load_steps = 0, iterations = 0;
  double l2_error = 0.0;
  VertexErrors vertices;
};
using Runs = std::vector<RollupRun>;

std::string name_of(const char* integration, double slenderness, int order) {
  return formatted("%s, rho=%g k=%d", integration, slenderness, order);
}

RollupRun compute(Application& app, const PureBending& bending, const BentRod& rod, const SolverParameters& solver) {
  const Simulation simulation = app.solve(bending.variant(rod), solver, "");
  return {rod, simulation.result().steps, simulation.result().newton_iterations, bending.centerline_error(simulation),
          bending.vertex_errors(simulation)};
}

/// Whatever the mesh, the tip closes the circle, rotations are exact, and vertices are where exact tangents put them.
void check_exact_values(Application& app, const PureBending& bending) {
  const int elements = app.study().get<int>("Exact Elements");
  app.out() << "\nWhat is exact on every mesh, and what is not: " << elements
            << " elements, one load step (positions / L, angles in radians)\n";
  StudyTable table(app, "",
                   {"slenderness", "k", "iterations", "tip position", "rotation of any vertex",
                    "vertex from k-point Gauss rule", "vertex from the circle"},
                   7);
  for (double slenderness : study_list<double>(app, "Exact Slenderness"))
    for (int order : study_list<int>(app, "Exact Orders")) {
      const BentRod rod{kBothReduced.integration, slenderness, order, elements};
      SolverParameters solver = with_fixed_steps(app.solver, 1);
      solver.newton.residual_tolerance = slenderness < kStiff ? kResidualTolerance : kResidualToleranceOfStiff;
      const RollupRun run = compute(app, bending, rod, solver);
      table.add_row({slenderness, order, run.iterations, run.vertices.tip, run.vertices.rotation,
                     run.vertices.quadrature, run.vertices.circle});
      const std::string name = name_of("exact values", slenderness, order) + ": ";
      app.summary.check_upper_bound(name + "tip, distance from the circle / L", run.vertices.tip, kExact, kClosedForm);
      app.summary.check_upper_bound(name + "vertices, distance from Gauss rule of the exact tangent / L",
                                    run.vertices.quadrature, kExact, kClosedForm);
      app.summary.check_upper_bound(name + "vertices, angle to the exact rotation", run.vertices.rotation, kExact,
                                    kClosedForm);
      app.summary.check_upper_bound(name + "Newton iterations in one load step", run.iterations, kGoalIterations,
                                    kGoal);
    }
}

void compute_all(Application& app, const PureBending& bending, const NamedIntegration& how,
                 const std::vector<double>& slendernesses, const std::vector<int>& orders, Runs& runs) {
  SolverParameters solver = app.solver;
  solver.newton.residual_tolerance = std::min(solver.newton.residual_tolerance, kResidualTolerance);
  for (double slenderness : slendernesses)
    for (int order : orders)
      for (int elements : study_list<int>(app, "Elements"))
        runs.push_back(compute(app, bending, {how.integration, slenderness, order, elements}, solver));
}

Runs compute_all(Application& app, const PureBending& bending) {
  const auto orders = study_list<int>(app, "Orders");
  Runs runs;
  for (const NamedIntegration& how : kSelective) {
    const bool full = how.integration == ForceIntegration::full;
    compute_all(app, bending, how, study_list<double>(app, full ? "Slenderness" : "Slenderness of Selective Reduction"),
                orders, runs);
  }
  compute_all(app, bending, kBothReduced, study_list<double>(app, "Slenderness"),
              study_list<int>(app, "Orders Both Reduced"), runs);
  return runs;
}

const char* integration_name(ForceIntegration integration) {
  for (const NamedIntegration& how : kSelective)
    if (how.integration == integration) return how.name;
  return kBothReduced.name;
}

void write_convergence(const Application& app, const Runs& runs) {
  StudyTable csv(app, "convergence.csv",
                 {"integration", "order", "slenderness", "elements", "l2_error", "tip_error", "vertex_error",
                  "iterations", "load_steps"});
  for (const RollupRun& run : runs)
    csv.add_row({integration_name(run.rod.integration), run.rod.order, run.rod.slenderness, run.rod.elements,
                 run.l2_error, run.vertices.tip, run.vertices.circle, run.iterations, run.load_steps});
}

/// Runs that differ in their mesh only follow each other. Checks the rates of those that cannot lock.
void report_errors(Application& app, const Runs& runs) {
  const auto elements = study_list<int>(app, "Elements");
  ConvergenceTable table("\nError of the centerline, 1/L sqrt(1/L int |r - r_exact|^2 ds)", elements, kRoundOff);
  std::string group;
  for (std::size_t first = 0; first + elements.size() <= runs.size(); first += elements.size()) {
    const BentRod& rod = runs[first].rod;
    const char* integration = integration_name(rod.integration);
    const bool full = rod.integration == ForceIntegration::full;
    const std::string heading =
        formatted("%s%s, slenderness %g", integration, full ? " integration" : "", rod.slenderness);
    if (heading != group) table.add_group(group = heading);
    std::vector<double> errors;
    for (std::size_t i = 0; i < elements.size(); ++i) errors.push_back(runs[first + i].l2_error);
    const auto rate = table.add_row(rod.order, errors);
    if (rod.integration == kBothReduced.integration && rate)
      app.summary.check_absolute(name_of(integration, rod.slenderness, rod.order) + ": convergence rate", *rate,
                                 rod.order + 1, kRateTolerance, kPaper + ": optimal rate k + 1");
  }
  table.print(app.out());
}

const RollupRun* find(const Runs& runs, const BentRod& wanted) {
  const auto same = [&](const RollupRun& run) {
    return run.rod.integration == wanted.integration && run.rod.slenderness == wanted.slenderness &&
           run.rod.order == wanted.order && run.rod.elements == wanted.elements;
  };
  const auto found = std::find_if(runs.begin(), runs.end(), same);
  return found == runs.end() ? nullptr : &*found;
}

/// Error over that of both reduced integrations: printed, and checked against what the paper's figures show.
void report_locking(Application& app, const Runs& runs) {
  app.out() << "\nLocking at slenderness " << kLockingSlenderness << " with " << kLockingElements
            << " elements: more than " << kLocked << " times the error with both parts reduced";
  StudyTable table(app, "", {"integration", "k", "ratio", "locks"}, 4);
  for (int order : study_list<int>(app, "Orders")) {
    for (const NamedIntegration& how : kSelective) {
      const RollupRun* run = find(runs, {how.integration, kLockingSlenderness, order, kLockingElements});
      const RollupRun* best = find(runs, {kBothReduced.integration, kLockingSlenderness, order, kLockingElements});
      if (run == nullptr || best == nullptr) continue;  // the user's lists do not hold this mesh
      const double ratio = run->l2_error / best->l2_error;
      table.add_row({how.name, order, ratio, ratio > kLocked ? "yes" : "no"});
      const std::string name = name_of(how.name, kLockingSlenderness, order);
      const bool locks = std::count(how.locking_orders.begin(), how.locking_orders.end(), order) > 0;
      if (locks)
        app.summary.check_upper_bound(name + ": locks, error with both reduced / error", 1.0 / ratio, 1.0 / kLocked,
                                      kPaper);
      else
        app.summary.check_upper_bound(name + ": does not lock, error / error with both reduced", ratio, kLocked,
                                      kPaper);
    }
  }
}

void compare_with_prototype(Application& app, const Runs& runs) {
  TablePrinter table("\nError of the centerline beside that of a prototype of the element (" +
                         std::to_string(kPrototypeElements) + " elements, both parts reduced)",
                     {"k"}, {"slenderness 10", "slenderness 1000"}, "prototype");
  for (int order = 1; order <= static_cast<int>(kPrototypeErrors.size()); ++order) {
    std::vector<ComparedValue> values;
    for (double slenderness : {10.0, 1000.0}) {
      const RollupRun* run = find(runs, {kBothReduced.integration, slenderness, order, kPrototypeElements});
      if (run != nullptr) values.push_back({kPrototypeErrors[order - 1], run->l2_error, Agreement::informative});
    }
    if (values.size() == 2) table.add_row({std::to_string(order)}, values);
  }
  table.print(app.out());
}

ListSpec rollup_spec() {
  constexpr double kMost = 1e10;
  ListSpec spec("Meshes, orders and slendernesses L/a (square section of side a); GA = EA/2, EI as in the scene.");
  spec.add(sizes("Slenderness", {10, 100, 1000}, kMost, "For full integration and for both parts reduced."));
  spec.add(sizes("Slenderness of Selective Reduction", {1000}, kMost, "For one of the two parts reduced."));
  spec.add(counts("Orders", {1, 2, 3, 4}, 8, "Element orders k where elements may lock."));
  spec.add(counts("Orders Both Reduced", {1, 2, 3, 4, 5, 6}, 8, "Element orders k where they do not."));
  spec.add(counts("Elements", {8, 16, 32, 64, 128, 256, 512}, 100000,
                  "Numbers of elements, ascending; fewer than 5 would turn by more than pi.", 5));
  spec.add(sizes("Exact Slenderness", {10, 1000, 1e6}, kMost, "For the values that are exact on every mesh."));
  spec.add(counts("Exact Orders", {1, 2, 3, 4, 5, 6, 7, 8}, 8, "Element orders k for these values."));
  spec.add(count("Exact Elements", 8, 100000, "Number of elements for them.", 5));
  return spec;
}

/// Records the scene as it stands (single.h5); checks what pure bending gives exactly, and in how many iterations;
/// writes convergence.csv, prints the errors of the centerline, checks their rates and which elements lock.
void run_rollup_study(Application& app) {
  const PureBending bending(app.scene);
  app.check_expected(app.solve_and_record(app.scene, app.solver, "single", kSmoothSamples));
  check_exact_values(app, bending);
  const Runs runs = compute_all(app, bending);
  write_convergence(app, runs);
  report_errors(app, runs);
  report_locking(app, runs);
  compare_with_prototype(app, runs);
}

}  // namespace

}  // namespace mixbeam

int main(int argc, char** argv) {
  return mixbeam::run_study(
      argc, argv, "rollup",
      "a straight cantilever bent to a double circle by a moment at its tip; convergence and locking.",
      mixbeam::rollup_spec(), mixbeam::run_rollup_study);
}
