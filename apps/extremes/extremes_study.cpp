#include "apps/extremes/extremes_study.hpp"

#include "apps/common/session/machine_facts.hpp"
#include "apps/common/tables/csv_table.hpp"
#include "apps/extremes/critical_sweeps.hpp"
#include "apps/extremes/elastica.hpp"
#include "apps/extremes/extremes_page.hpp"
#include "apps/extremes/random_paths.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <limits>
#include <ostream>

namespace mixbeam {

namespace {

constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();

/// Values of cases that do not use any closed form, digits as printed there.
struct ShootingCase {
  double load;
  const char *across, *back, *angle;
};
const std::vector<ShootingCase> kShooting = {{1.0, "0.30172077379981", "0.0564332362834", "0.46135194971188"},
                                             {10.0, "0.8106090248803", "0.5549955977538", "1.4302855388039"},
                                             {100.0, "0.94142135086201", "0.8585786445629", "1.57064588466"}};
const std::string kShootingSource =
    "shooting on the rod ODE with Runge-Kutta 7(8), no finite elements; step doubling changes less than 1e-10";
constexpr double kShootingError = 1e-12;

void check_closed_form(Application& app) {
  for (const ShootingCase& known : kShooting) {
    const ElasticaTip tip = elastica_tip(known.load);
    const std::string name = "closed form, F L^2 / EI = " + value_text(known.load) + ": tip ";
    const auto check = [&](const char* quantity, double value, const char* reference) {
      app.summary.check_relative(name + quantity, value, std::stod(reference), kShootingError, kShootingSource);
    };
    check("across", tip.across, known.across);
    check("back", tip.back, known.back);
    check("angle", tip.angle, known.angle);
  }
}

struct ThrustCase {
  double over_euler, eccentricity;
  const char *x, *y, *angle;
};
const std::vector<ThrustCase> kThrusts = {{1.05, 1e-4, "0.90498259324", "0.38064428348", "0.62274480879"},
                                          {1.2, 1e-6, "0.67391082498", "0.64878450511", "1.18440249350"},
                                          {1.5, 0.1, "0.34171752220", "0.79568923565", "1.74769556929"},
                                          {8.0, 1e-4, "-0.54784720364", "0.44971259087", "3.04718635507"}};
constexpr double kThrustDigits = 3e-11;  // printed, relative to the smallest of them

void check_thrusts(Application& app) {
  for (const ThrustCase& known : kThrusts) {
    const ElasticaTip tip = thrust_tip(0.25 * M_PI * M_PI * known.over_euler, known.eccentricity);
    const std::string name = "closed form, P / P_cr = " + value_text(known.over_euler) + ": tip ";
    const auto check = [&](const char* quantity, double value, const char* reference) {
      app.summary.check_relative(name + quantity, value, std::stod(reference), kThrustDigits, kShootingSource);
    };
    check("x", 1.0 - tip.back, known.x);
    check("y", tip.across, known.y);
    check("angle", tip.angle, known.angle);
  }
}

/// All names, to be chosen from.
std::vector<std::string> sweep_names() {
  std::vector<std::string> names;
  for (const Sweep& sweep : all_sweeps(1)) names.push_back(sweep.name);
  return names;
}

/// At most `most` values, first and last among them.
std::vector<double> thinned(const std::vector<double>& values, int most) {
  const int count = static_cast<int>(values.size());
  if (most >= count) return values;
  std::vector<double> kept;
  for (int i = 0; i < most; ++i) kept.push_back(values[i * (count - 1) / std::max(1, most - 1)]);
  return kept;
}

class Stopwatch {
 public:
  void stop(SweepRow& row) const {
    row.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    row.processor_seconds = static_cast<double>(std::clock() - processor_start_) / CLOCKS_PER_SEC;
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  std::clock_t processor_start_ = std::clock();
};

SweepRow compute(Application& app, const Trial& trial, double value) {
  SweepRow row;
  row.value = value;
  row.error = row.residual = row.condition = kNotANumber;
  const Stopwatch watch;
  try {
    Simulation simulation =
        app.try_to_solve(trial.rod.scene(), trial.solver,
                         [&row](const Simulation&, const StepReport& report) { row.residual = report.residual; });
    watch.stop(row);
    const LoadPathResult& result = simulation.result();
    row.converged = result.finished;
    row.load_steps = result.steps;
    row.failed_steps = result.failed_steps;
    row.iterations = result.newton_iterations;
    row.failure = result.failure;
    if (row.converged) row.error = trial.rod.error(simulation);
    row.condition = simulation.condition_estimate();
  } catch (const InputError& error) {
    watch.stop(row);
    row.failure = error.what();
  }
  return row;
}

void print_header(std::ostream& out, const Sweep& sweep) {
  out << "\n"
      << sweep.name << ": " << sweep.parameter << "\n  " << sweep.what << "\n"
      << "           value  converged  steps  failed  iterations     error  residual  condition   seconds\n";
}

void print_row(std::ostream& out, const SweepRow& row) {
  char line[200];
  std::snprintf(line, sizeof line, "%16s  %9s %6d %7d %11d %9.1e %9.1e %10.1e %9.4f\n", value_text(row.value).c_str(),
                row.converged ? "yes" : "NO", row.load_steps, row.failed_steps, row.iterations, row.error, row.residual,
                row.condition, row.seconds);
  out << line << std::flush;
}

void check(Application& app, const Sweep& sweep, const SweepRow& row) {
  if (row.value < sweep.from || row.value > sweep.to) return;
  app.summary.check_upper_bound(sweep.name + " " + value_text(row.value) + ": error of the tip", row.error,
                                sweep.allowed, "closed form: " + sweep.source);
}

SweepResult compute(Application& app, const Cantilever& rod, const Sweep& sweep) {
  SweepResult result{sweep, {}};
  print_header(app.out(), sweep);
  for (double value : thinned(sweep.values, app.study().get<int>("Most Values"))) {
    result.rows.push_back(compute(app, sweep.trial(rod, app.solver, value), value));
    print_row(app.out(), result.rows.back());
    check(app, sweep, result.rows.back());
  }
  return result;
}

void write_table(const Application& app, const std::vector<SweepResult>& results) {
  CsvTable csv(app.output / "extremes.csv",
               {"sweep", "value", "converged", "load_steps", "failed_steps", "iterations", "error", "allowed",
                "residual", "condition", "seconds", "processor_seconds", "failure"});
  for (const SweepResult& result : results)
    for (const SweepRow& row : result.rows) {
      const bool promised = row.value >= result.sweep.from && row.value <= result.sweep.to;
      csv.add_row({result.sweep.name, row.value, row.converged ? 1 : 0, row.load_steps, row.failed_steps,
                   row.iterations, row.error, promised ? result.sweep.allowed : kNotANumber, row.residual,
                   row.condition, row.seconds, row.processor_seconds, row.failure});
    }
}

}  // namespace

ListSpec extremes_spec() {
  ListSpec spec("Which sweeps, and how far.");
  spec.add(subset("Sweeps", sweep_names())
               .by_default(Teuchos::Array<std::string>(sweep_names()))
               .means("Those that are computed, in the order of the page."));
  spec.add(integer("Most Elements")
               .at_least(1)
               .at_most(1000000)
               .by_default(100000)
               .means("End of the sweep over the number of elements; a million takes minutes and gigabytes."));
  spec.add(integer("Most Values")
               .at_least(1)
               .at_most(1000)
               .by_default(1000)
               .means("Values of each sweep, evenly chosen from first to last."));
  spec.add(boolean("Critical Loads")
               .by_default(true)
               .means("Also sweep structures whose critical loads have a closed form: a truss, a heated rail."));
  spec.add(integer("Random Structures")
               .at_least(0)
               .at_most(100000)
               .by_default(500)
               .means("Imperfect structures whose paths are compared with those of small steps; 3 s each."));
  spec.add(real("Reference Step")
               .above(0.0)
               .at_most(0.1)
               .by_default(0.002)
               .means("Largest load step of a reference; a second one takes half of it."));
  return spec;
}

void run_extremes_study(Application& app) {
  const Cantilever rod(app.scene);
  check_closed_form(app);
  check_thrusts(app);
  const auto chosen = app.study().get<Teuchos::Array<std::string>>("Sweeps");
  std::vector<SweepResult> results;
  for (const Sweep& sweep : all_sweeps(app.study().get<int>("Most Elements")))
    if (std::find(chosen.begin(), chosen.end(), sweep.name) != chosen.end())
      results.push_back(compute(app, rod, sweep));
  const bool critical = app.study().get<bool>("Critical Loads");
  const std::vector<CriticalSweep> critical_sweeps =
      run_critical_sweeps(app, critical ? app.study().get<int>("Most Values") : 0);
  const std::vector<RandomPath> paths =
      run_random_paths(app, app.study().get<int>("Random Structures"), app.study().get<double>("Reference Step"));
  if (!app.writes_files()) return;
  write_table(app, results);
  CsvTable machine(app.output / "machine.csv", {"name", "value"});
  for (const auto& [name, value] : machine_facts()) machine.add_row({name, value});
  std::ofstream page(app.output / "extremes.md");
  write_page(page, results);
  write_critical_sweeps(page, critical_sweeps);
  write_random_paths(page, paths);
}

}  // namespace mixbeam
