#include "apps/extremes/random_paths.hpp"

#include "apps/common/tables/csv_table.hpp"

#include <algorithm>
#include <cstdio>
#include <ostream>

namespace mixbeam {

namespace {

constexpr std::uint64_t kSeriesSeed = 15;
/// Of the paths whose end is known, those that may be given up.
constexpr double kMostRefused = 0.02;

RandomPath follow_one(Application& app, int number, double reference_step) {
  RandomPath path;
  path.structure = imperfect_structure(kSeriesSeed, number);
  const Scene& scene = path.structure.scene;
  SolverParameters parameters = app.solver;
  parameters.threads = app.threads_for(scene, parameters);
  path.path = judge_path(scene, parameters, reference_step, app.communicator);
  path.plain = follow(scene, parameters, app.communicator, true);
  path.plain_is_right =
      path.path.reference_known && path.plain.finished && is_same_end(scene, path.plain, path.path.reference);
  return path;
}

void print_path(std::ostream& out, const RandomPath& path) {
  const FollowedPath& followed = path.path.followed;
  char line[300];
  std::snprintf(line, sizeof line, "%-13s %-9s %10.1e %8.2f  %-8s %6d %10d %9.1e %9.1e %8.3f %8.2f\n",
                path.structure.scene.name.c_str(), path.structure.load.c_str(), path.structure.imperfection,
                path.structure.estimate, name_of(path.path.outcome), followed.steps, followed.iterations,
                path.path.difference, path.path.reference_difference, followed.processor_seconds,
                path.path.reference.processor_seconds);
  out << line << std::flush;
}

int count_of(const std::vector<RandomPath>& paths, PathOutcome outcome) {
  return static_cast<int>(
      std::count_if(paths.begin(), paths.end(), [=](const RandomPath& path) { return path.path.outcome == outcome; }));
}

/// Iterations with all checks over those of the plain method, of all paths that both find.
double cost(const std::vector<RandomPath>& paths, bool in_seconds) {
  double checked = 0.0, plain = 0.0;
  for (const RandomPath& path : paths) {
    if (!path.plain_is_right || path.path.outcome != PathOutcome::right) continue;
    checked += in_seconds ? path.path.followed.processor_seconds : path.path.followed.iterations;
    plain += in_seconds ? path.plain.processor_seconds : path.plain.iterations;
  }
  return plain > 0.0 ? checked / plain : 0.0;
}

void check(Application& app, const std::vector<RandomPath>& paths) {
  const int wrong = count_of(paths, PathOutcome::wrong), refused = count_of(paths, PathOutcome::refused);
  const int known = static_cast<int>(paths.size()) - count_of(paths, PathOutcome::unknown);
  const std::string source = "the same path in small steps, which do not change its end";
  app.summary.check_upper_bound("random structures: wrong ends", wrong, 0.0, source);
  app.summary.check_upper_bound("random structures: paths given up", refused, kMostRefused * known, source);
}

void write_random_table(const Application& app, const std::vector<RandomPath>& paths) {
  CsvTable csv(app.output / "random_paths.csv", {"number",
                                                 "family",
                                                 "load",
                                                 "imperfection",
                                                 "estimate",
                                                 "outcome",
                                                 "difference",
                                                 "reference_difference",
                                                 "steps",
                                                 "failed_steps",
                                                 "iterations",
                                                 "negative",
                                                 "critical_points",
                                                 "processor_seconds",
                                                 "plain_is_right",
                                                 "plain_iterations",
                                                 "plain_processor_seconds",
                                                 "reference_iterations",
                                                 "reference_processor_seconds",
                                                 "failure"});
  int number = 0;
  for (const RandomPath& path : paths) {
    const FollowedPath& followed = path.path.followed;
    csv.add_row({number++,
                 path.structure.family,
                 path.structure.load,
                 path.structure.imperfection,
                 path.structure.estimate,
                 name_of(path.path.outcome),
                 path.path.difference,
                 path.path.reference_difference,
                 followed.steps,
                 followed.failed_steps,
                 followed.iterations,
                 followed.negative,
                 followed.critical_points,
                 followed.processor_seconds,
                 path.plain_is_right ? 1 : 0,
                 path.plain.iterations,
                 path.plain.processor_seconds,
                 path.path.reference.iterations,
                 path.path.reference.processor_seconds,
                 followed.failure.substr(0, followed.failure.find('\n'))});
  }
}

std::string row_of(const std::string& name, const std::vector<RandomPath>& paths) {
  int passing = 0, plain = 0, iterations = 0;
  double reference = 0.0, seconds = 0.0;
  for (const RandomPath& path : paths) {
    passing += path.structure.estimate > 1.0 ? 1 : 0;
    plain += path.plain_is_right ? 1 : 0;
    iterations += path.path.followed.iterations;
    seconds += path.path.followed.processor_seconds;
    reference += path.path.reference.processor_seconds;
  }
  char line[300];
  std::snprintf(line, sizeof line, "| %s | %d | %d | %d | %d | %d | %d | %d | %.1f | %.2f | %.2f | %.0f |\n",
                name.c_str(), static_cast<int>(paths.size()), passing, count_of(paths, PathOutcome::right),
                count_of(paths, PathOutcome::refused), count_of(paths, PathOutcome::wrong),
                count_of(paths, PathOutcome::unknown), plain, paths.empty() ? 0.0 : 1.0 * iterations / paths.size(),
                cost(paths, false), cost(paths, true), seconds > 0.0 ? reference / seconds : 0.0);
  return line;
}

void write_troubles(std::ostream& page, const std::vector<RandomPath>& paths) {
  for (const RandomPath& path : paths) {
    if (path.path.outcome != PathOutcome::refused && path.path.outcome != PathOutcome::wrong) continue;
    char line[300];
    std::snprintf(line, sizeof line, "- %s, %s, imperfection %.1e, %.2f times critical: %s (%d steps, %d iterations)\n",
                  path.structure.scene.name.c_str(), path.structure.load.c_str(), path.structure.imperfection,
                  path.structure.estimate, name_of(path.path.outcome), path.path.followed.steps,
                  path.path.followed.iterations);
    page << line;
  }
}

}  // namespace

std::vector<RandomPath> run_random_paths(Application& app, int count, double reference_step) {
  std::vector<RandomPath> paths;
  if (count == 0) return paths;
  app.out() << "\nrandom structures, references by steps of " << reference_step << " and half of it\n"
            << "structure     load      imperfection    load  end       steps iterations  distance reference  seconds  "
               "reference's\n";
  for (int number = 0; number < count; ++number) {
    paths.push_back(follow_one(app, number, reference_step));
    print_path(app.out(), paths.back());
  }
  check(app, paths);
  if (app.writes_files()) write_random_table(app, paths);
  return paths;
}

void write_random_paths(std::ostream& page, const std::vector<RandomPath>& paths) {
  if (paths.empty()) return;
  page
      << "\n## Random imperfect structures\n\n"
         "Columns, frames, arches, rings, lattices, domes and strips in random units, with an imperfection of 1e-6 to\n"
         "0.1 of the load or of the length, under forces, moments, heat and motions of supports; all settings are\n"
         "defaults. `passes`: the full load exceeds a hand formula of the critical one. The end is compared with that\n"
         "of the same path in small steps, and in steps half as long; where these differ by more than 1e-10 of the\n"
         "length, or end unstable without a critical point on the way, nothing is known and the structure is left\n"
         "out. `right`: within 1e-7 of the length; `refused`: exit code 3; `wrong`: another end, exit code 0. `plain`\n"
         "counts the ends that Newton's method finds for the whole load at once without any check; `iterations` is\n"
         "the mean, and the costs compare the structures that both find.\n\n"
         "| family | structures | passes | right | refused | wrong | unknown | plain right | iterations | cost in "
         "iterations | in time | reference in time |\n"
         "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n";
  for (const std::string& family : imperfect_families()) {
    std::vector<RandomPath> members;
    std::copy_if(paths.begin(), paths.end(), std::back_inserter(members),
                 [&](const RandomPath& path) { return path.structure.family == family; });
    page << row_of(family, members);
  }
  page << row_of("all", paths) << "\n";
  write_troubles(page, paths);
}

}  // namespace mixbeam
