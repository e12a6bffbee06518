// One quantity of a structure at a time to its limits: what converges, how fast, how exact, and where it ends. Then
// paths of random imperfect structures, held against the same paths in small steps.
#include "apps/common/studies/imperfect_structures.hpp"
#include "apps/common/studies/judged_path.hpp"
#include "apps/common/studies/study.hpp"
#include "apps/extremes/sweeps.hpp"
#include "discretization/text/number_text.hpp"
#include "kernels/math/constants.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace mixbeam {

namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
constexpr double kShootingError = 1e-12;
constexpr double kThrustDigits = 3e-11;  // printed, relative to the smallest of them
/// Of the paths whose end is known, those that may be refused.
constexpr double kMostRefused = 0.02;

/// The closed forms against cases that do not use any.
void check_closed_forms(Application& app) {
  using Numbers = std::array<double, 3>;
  const auto check = [&app](const std::string& load, const std::array<const char*, 3>& names, const Numbers& values,
                            const Numbers& references, double tolerance) {
    for (std::size_t i = 0; i < names.size(); ++i)
      app.summary.check_relative("closed form, " + load + ": tip " + names[i], values[i], references[i], tolerance,
                                 "shooting on the rod ODE with Runge-Kutta 7(8), no finite elements; step doubling "
                                 "changes less than 1e-10");
  };
  const std::vector<std::array<double, 4>> forces = {{1.0, 0.30172077379981, 0.0564332362834, 0.46135194971188},
                                                     {10.0, 0.8106090248803, 0.5549955977538, 1.4302855388039},
                                                     {100.0, 0.94142135086201, 0.8585786445629, 1.57064588466}};
  for (const auto& [load, across, back, angle] : forces) {
    const ElasticaTip tip = elastica_tip(load);
    check("F L^2 / EI = " + shortest(load), {"across", "back", "angle"}, {tip.across, tip.back, tip.angle},
          {across, back, angle}, kShootingError);
  }
  const std::vector<std::array<double, 5>> thrusts = {{1.05, 1e-4, 0.90498259324, 0.38064428348, 0.62274480879},
                                                      {1.2, 1e-6, 0.67391082498, 0.64878450511, 1.18440249350},
                                                      {1.5, 0.1, 0.34171752220, 0.79568923565, 1.74769556929},
                                                      {8.0, 1e-4, -0.54784720364, 0.44971259087, 3.04718635507}};
  for (const auto& [over_euler, eccentricity, x, y, angle] : thrusts) {
    const ElasticaTip tip = thrust_tip(0.25 * kPi * kPi * over_euler, eccentricity);
    check("P / P_cr = " + shortest(over_euler), {"x", "y", "angle"}, {1.0 - tip.back, tip.across, tip.angle},
          {x, y, angle}, kThrustDigits);
  }
}

/// At most `most` values, first and last among them.
std::vector<double> thinned(const std::vector<double>& values, int most) {
  const int count = static_cast<int>(values.size());
  if (most >= count) return values;
  std::vector<double> kept;
  for (int i = 0; i < most; ++i) kept.push_back(values[i * (count - 1) / std::max(1, most - 1)]);
  return kept;
}

/// Largest relative error of the critical load factors; infinity where one is missing.
double critical_error(const std::vector<double>& found, const std::vector<double>& expected) {
  double error = found.size() == expected.size() ? 0.0 : std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < std::min(found.size(), expected.size()); ++i)
    error = std::max(error, std::abs(found[i] / expected[i] - 1.0));
  return error;
}

/// One value: solved, judged, a row of the table.
void compute(Application& app, const Sweep& sweep, double value, StudyTable& table) {
  const Trial trial = sweep.trial(app.scene, app.solver, value);
  const bool is_promised = value >= sweep.from && value <= sweep.to;
  double error = kUnknown, residual = kUnknown, condition = kUnknown;
  int negative = -1;
  std::vector<double> critical;
  std::optional<Simulation> simulation;
  LoadPathResult result;
  const RunWatch watch;
  try {
    simulation = app.try_to_solve(trial.scene, trial.solver, [&](const Simulation&, const StepReport& report) {
      residual = report.residual;
      negative = report.stability ? report.stability->negative : -1;
      for (const CriticalPoint& point : report.critical_points) critical.push_back(point.load_factor);
    });
    result = simulation->result();
  } catch (const InputError& problem) {
    result.failure = problem.what();
  }
  const double seconds = watch.seconds(), processor = watch.processor_seconds();
  if (result.finished) error = trial.error ? trial.error(*simulation) : critical_error(critical, trial.critical);
  if (simulation) condition = simulation->condition_estimate();
  table.add_row({sweep.name, value, result.finished ? 1 : 0, result.steps, result.failed_steps,
                 result.newton_iterations, error, is_promised ? sweep.allowed : kUnknown, residual, condition,
                 trial.critical.size(), critical.size(), negative, seconds, processor, result.failure});
  if (is_promised)
    app.summary.check_upper_bound(
        sweep.name + " " + shortest(value) + (trial.error ? ": error of the tip" : ": critical load factors"), error,
        sweep.allowed, "closed form: " + sweep.source);
}

void run_sweeps(Application& app) {
  const auto chosen = study_list<std::string>(app, "Sweeps");
  StudyTable table(app, "extremes.csv",
                   words("sweep,value,converged,load_steps,failed_steps,iterations,error,allowed,residual,condition,"
                         "expected_points,critical_points,negative,seconds,processor_seconds,failure"),
                   10);
  const auto run = [&](const Sweep& sweep) {
    for (const double value : thinned(sweep.values, app.study().get<int>("Most Values")))
      compute(app, sweep, value, table);
  };
  for (const Sweep& sweep : all_sweeps(app.study().get<int>("Most Elements")))
    if (std::find(chosen.begin(), chosen.end(), sweep.name) != chosen.end()) run(sweep);
  if (app.study().get<bool>("Critical Loads"))
    for (const Sweep& sweep : critical_sweeps()) run(sweep);
}

/// With the solver's parameters of the scene. No end may be wrong, and few refused, of those whose reference is known.
void run_random_paths(Application& app) {
  const int count = app.study().get<int>("Random Structures");
  if (count == 0) return;
  StudyTable table(
      app, "random_paths.csv",
      words("family,number,load,imperfection,estimate,outcome,difference,reference_difference,steps,failed_steps,"
            "iterations,processor_seconds,negative,critical_points,plain_is_right,plain_iterations,"
            "plain_processor_seconds,reference_iterations,reference_processor_seconds,reference_step,failure"),
      12);
  const double step = app.study().get<double>("Reference Step");
  const auto seed = static_cast<std::uint64_t>(app.study().get<int>("Random Seed"));
  std::map<PathOutcome, int> ends;
  for (int number = 0; number < count; ++number) {
    const ImperfectStructure structure = imperfect_structure(seed, number);
    SolverParameters parameters = app.solver;
    parameters.threads = app.threads_for(structure.scene, parameters);
    const JudgedPath judged = judge_path(structure.scene, parameters, step, app.communicator);
    const FollowedPath &followed = judged.followed, plain = follow(structure.scene, parameters, app.communicator, true);
    const bool plain_is_right =
        judged.reference_known && plain.finished && is_same_end(structure.scene, plain, judged.reference);
    ++ends[judged.outcome];
    std::vector<CsvCell> row = {structure.family, number, structure.load, structure.imperfection, structure.estimate};
    const auto add = [&row](std::initializer_list<CsvCell> cells) { row.insert(row.end(), cells); };
    add({kOutcomeNames[static_cast<std::size_t>(judged.outcome)], judged.difference, judged.reference_difference});
    add({followed.steps, followed.failed_steps, followed.iterations, followed.processor_seconds, followed.negative});
    add({followed.critical_points, plain_is_right ? 1 : 0, plain.iterations, plain.processor_seconds});
    add({judged.reference.iterations, judged.reference.processor_seconds, step});
    add({followed.failure.substr(0, followed.failure.find('\n'))});
    table.add_row(row);
  }
  const std::string source = "the same path in small steps, which do not change its end";
  const int known = count - ends[PathOutcome::unknown];
  app.summary.check_upper_bound("random structures: wrong ends", ends[PathOutcome::wrong], 0.0, source);
  app.summary.check_upper_bound("random structures: paths refused", ends[PathOutcome::refused], kMostRefused * known,
                                source);
}

ListSpec extremes_spec() {
  std::vector<std::string> names;
  for (const Sweep& sweep : all_sweeps(1)) names.push_back(sweep.name);
  ListSpec spec("Which sweeps, and how far.");
  spec.add(subset("Sweeps", names)
               .by_default(Teuchos::Array<std::string>(names))
               .means("Those that are computed, in the order of the page."));
  spec.add(count("Most Elements", 100000, 1000000,
                 "End of the sweep over the number of elements; a million takes minutes and gigabytes."));
  spec.add(count("Most Values", 1000, 1000, "Values of each sweep, evenly chosen from first to last."));
  spec.add(boolean("Critical Loads").by_default(true),
           "Also sweep structures whose critical loads have a closed form: a truss, a heated rail.");
  spec.add(count("Random Structures", 500, 100000,
                 "Imperfect structures whose paths are compared with those of small steps; 3 s each.", 0));
  spec.add(count("Random Seed", 15, 1000000, "Begins the series of structures; another seed, other structures.", 0));
  spec.add(real("Reference Step").above(0.0).at_most(0.1).by_default(0.002),
           "Largest load step of a reference; a second one takes half of it.");
  return spec;
}

void run_extremes_study(Application& app) {
  const Cantilever is_one(app.scene);
  check_closed_forms(app);
  run_sweeps(app);
  run_random_paths(app);
  write_machine(app);
}

}  // namespace

}  // namespace mixbeam

int main(int argc, char** argv) {
  return mixbeam::run_study(
      argc, argv, "extremes",
      "a straight cantilever, one of its quantities at a time swept to its limits and held against a closed form.",
      mixbeam::extremes_spec(), mixbeam::run_extremes_study);
}
