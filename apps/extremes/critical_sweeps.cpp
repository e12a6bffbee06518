#include "apps/extremes/critical_sweeps.hpp"

#include "apps/common/tables/csv_table.hpp"
#include "apps/extremes/extremes_page.hpp"

#include <cmath>
#include <cstdio>
#include <ctime>
#include <functional>
#include <limits>
#include <ostream>

namespace mixbeam {

namespace {

/// Of critical load factors, relative: what the program promises.
constexpr double kLocated = 1e-8;
constexpr double kNoLimit = std::numeric_limits<double>::infinity();

struct CriticalCase {
  Scene scene;
  SolverParameters solver;
  std::vector<double> load_factors;
};

Member straight_bar(const std::string& start, const std::string& end, int order, int elements) {
  Member bar;
  bar.name = start + " to " + end;
  bar.start_point = start;
  bar.end_point = end;
  bar.section = "bar";
  bar.order = order;
  bar.elements = elements;
  return bar;
}

Support held(const std::string& point, const std::array<bool, 3>& displacement, const std::array<bool, 3>& rotation) {
  Support support;
  support.point = point;
  support.displacement_fixed = displacement;
  support.rotation_fixed = rotation;
  return support;
}

/// Bars on hinges, half span 1, EA = 1, too stiff to bend: P = 2 EA (l / l0 - 1) sin(slope), elementary.
CriticalCase snapping_truss(double rise, SolverParameters solver) {
  constexpr double kBending = 1e3;
  const double cosine = 1.0 / std::hypot(1.0, rise);
  const double limit = 2.0 * std::pow(1.0 - std::pow(cosine, 2.0 / 3.0), 1.5);
  Scene scene;
  scene.name = "truss";
  scene.sections = {{"bar", 1.0, {kNoLimit, kNoLimit}, kBending, {kBending, kBending}}};
  scene.points = {{"left", {-1, 0, 0}}, {"apex", {0, rise, 0}}, {"right", {1, 0, 0}}};
  scene.members = {straight_bar("left", "apex", 2, 1), straight_bar("apex", "right", 2, 1)};
  scene.joints = {{"hinge", "apex", {"apex to right"}, JointKind::hinge, {0, 0, 1}}};
  scene.supports = {held("left", {true, true, true}, {true, true, false}),
                    held("right", {true, true, true}, {true, true, false}),
                    held("apex", {true, false, true}, {false, false, false})};
  PointLoad load;
  load.point = "apex";
  load.force = {0, -2.0 * limit, 0};
  scene.point_loads = {load};
  return {scene, solver, {0.5, -0.5}};
}

/// Length and EI are 1, and the thrust is EA times the strain of the heat until it buckles at 4 pi^2.
CriticalCase heated_rail(double axial, SolverParameters solver) {
  constexpr double kOverheated = 3.0;
  solver.analysis.branch = Branch::positive;
  Scene scene;
  scene.name = "rail";
  scene.sections = {{"bar", axial, {kNoLimit, kNoLimit}, 1.0, {1.0, 1.0}}};
  scene.points = {{"left", {0, 0, 0}}, {"right", {1, 0, 0}}};
  scene.members = {straight_bar("left", "right", 5, 16)};
  scene.members[0].inner_points = {{"middle", 0.5}};
  scene.supports = {held("left", {true, true, true}, {true, true, true}),
                    held("right", {true, true, true}, {true, true, true}),
                    held("middle", {false, false, true}, {true, true, false})};
  Eigenstrain heat;
  heat.member = "left to right";
  heat.strain = {kOverheated * 4.0 * M_PI * M_PI / axial, 0, 0};
  scene.eigenstrains = {heat};
  return {scene, solver, {1.0 / kOverheated}};
}

CriticalRow compute(Application& app, const CriticalCase& trial, double value) {
  CriticalRow row;
  row.value = value;
  row.expected = static_cast<int>(trial.load_factors.size());
  std::vector<double> found;
  const std::clock_t start = std::clock();
  const Simulation simulation =
      app.try_to_solve(trial.scene, trial.solver, [&](const Simulation&, const StepReport& report) {
        for (const CriticalPoint& point : report.critical_points) found.push_back(point.load_factor);
        row.negative = report.stability ? report.stability->negative : -1;
      });
  row.processor_seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  row.finished = simulation.result().finished;
  row.steps = simulation.result().steps;
  row.iterations = simulation.result().newton_iterations;
  row.failure = simulation.result().failure;
  row.found = static_cast<int>(found.size());
  if (row.found != row.expected || !row.finished) row.error = kNoLimit;
  for (size_t i = 0; i < found.size() && i < trial.load_factors.size(); ++i)
    row.error = std::max(row.error, std::abs(found[i] / trial.load_factors[i] - 1.0));
  return row;
}

CriticalSweep compute(Application& app, CriticalSweep sweep, const std::vector<double>& values, int most,
                      const std::function<CriticalCase(double, SolverParameters)>& trial) {
  app.out() << "\n"
            << sweep.name << ": " << sweep.parameter << "\n  " << sweep.what << "\n"
            << "     value  end  critical points     error  negative  steps  iterations  seconds\n";
  const int count = static_cast<int>(values.size()), kept = std::min(most, count);
  for (int i = 0; i < kept; ++i) {
    const double value = values[static_cast<size_t>(i * (count - 1) / std::max(1, kept - 1))];
    const CriticalRow row = compute(app, trial(value, app.solver), value);
    char line[200];
    std::snprintf(line, sizeof line, "%10s  %-3s %11d of %d %9.1e %9d %6d %11d %8.3f\n", value_text(value).c_str(),
                  row.finished ? "yes" : "NO", row.found, row.expected, row.error, row.negative, row.steps,
                  row.iterations, row.processor_seconds);
    app.out() << line << std::flush;
    app.summary.check_upper_bound(sweep.name + " " + value_text(value) + ": critical load factors", row.error, kLocated,
                                  "closed form: " + sweep.source);
    sweep.rows.push_back(row);
  }
  return sweep;
}

}  // namespace

std::vector<CriticalSweep> run_critical_sweeps(Application& app, int most_values) {
  std::vector<CriticalSweep> sweeps;
  if (most_values == 0) return sweeps;
  sweeps.push_back(compute(app,
                           {"truss_rise", "rise over half the span",
                            "Two bars on hinges, loaded at the apex by twice the load at which they snap through.",
                            "2 EA (1 - cos(slope)^(2/3))^(3/2), and its negative"},
                           {0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 3.0}, most_values, snapping_truss));
  sweeps.push_back(
      compute(app,
              {"rail_stiffness", "EA L^2 / EI",
               "A clamped rail, shear rigid, heated to three times its critical temperature, on its branch.",
               "a third: strain of the heat = 4 pi^2 EI / (EA L^2)"},
              {1e3, 1e4, 1e5, 1e6, 1e7, 1e8}, most_values, heated_rail));
  if (!app.writes_files()) return sweeps;
  CsvTable csv(app.output / "critical.csv", {"sweep", "value", "finished", "expected", "found", "error", "negative",
                                             "steps", "iterations", "processor_seconds", "failure"});
  for (const CriticalSweep& sweep : sweeps)
    for (const CriticalRow& row : sweep.rows)
      csv.add_row({sweep.name, row.value, row.finished ? 1 : 0, row.expected, row.found, row.error, row.negative,
                   row.steps, row.iterations, row.processor_seconds, row.failure.substr(0, row.failure.find('\n'))});
  return sweeps;
}

void write_critical_sweeps(std::ostream& page, const std::vector<CriticalSweep>& sweeps) {
  for (const CriticalSweep& sweep : sweeps) {
    page << "\n## " << sweep.name << "\n\n"
         << sweep.what << " Swept: " << sweep.parameter << ". Closed form: " << sweep.source
         << "; errors of load factors "
         << "are relative.\n\n| value | arrives | critical points | error | negative eigenvalues at the end | load "
            "steps | "
            "iterations | processor s |\n| --- | --- | --- | --- | --- | --- | --- | --- |\n";
    for (const CriticalRow& row : sweep.rows) {
      char line[200];
      std::snprintf(line, sizeof line, "| %s | %s | %d of %d | %.1e | %d | %d | %d | %.3f |\n",
                    value_text(row.value).c_str(), row.finished ? "yes" : "**no**", row.found, row.expected, row.error,
                    row.negative, row.steps, row.iterations, row.processor_seconds);
      page << line;
    }
  }
}

}  // namespace mixbeam
